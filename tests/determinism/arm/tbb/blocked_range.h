// As much of oneTBB as the engine names, for one thread: no library for ARM is needed to link it.
#pragma once

#include <cstddef>

namespace tbb {

template <class Number>
class blocked_range {
 public:
  blocked_range(Number begin, Number end) : m_begin(begin), m_end(end) {}
  [[nodiscard]] Number begin() const { return m_begin; }
  [[nodiscard]] Number end() const { return m_end; }

 private:
  Number m_begin;
  Number m_end;
};

template <class Range, class Visit>
void parallel_for(const Range& range, const Visit& visit) {
  visit(range);
}

struct global_control {
  enum parameter { max_allowed_parallelism };
  global_control(parameter, std::size_t) {}
};

struct task_arena {
  explicit task_arena(int) {}
  template <class Call>
  void execute(const Call& call) {
    call();
  }
};

template <class Value>
class enumerable_thread_specific {
 public:
  [[nodiscard]] Value& local() { return m_value; }

 private:
  Value m_value;
};

}  // namespace tbb
