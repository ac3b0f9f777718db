// The one parallel loop of the engine.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>

#if defined(__SANITIZE_THREAD__)  // g++
#define WOBBLE_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)  // clang
#define WOBBLE_THREAD_SANITIZER
#endif
#endif
#ifdef WOBBLE_THREAD_SANITIZER
extern "C" {  // from the sanitizer's runtime
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace wobble::physics {

// Tells ThreadSanitizer what a parallel loop guarantees: the loop's body runs after the fork and before the join. The
// sanitizer cannot see that itself, since Debian's oneTBB is not built with it. Races between bodies are still found.
struct ForkJoin {
#ifdef WOBBLE_THREAD_SANITIZER
  void Fork() { __tsan_release(&m_fork); }
  void Begin() { __tsan_acquire(&m_fork); }
  void End() { __tsan_release(&m_join); }
  void Join() { __tsan_acquire(&m_join); }
  char m_fork = 0;
  char m_join = 0;
#else
  void Fork() {}
  void Begin() {}
  void End() {}
  void Join() {}
#endif
};

// The engine's threads. count: at least 1; with 1 everything runs on the caller's thread.
class Threads {
 public:
  explicit Threads(int count)
      : m_count(count),
        m_limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)),
        m_arena(count) {}

  [[nodiscard]] int Count() const { return m_count; }

  // Calls visit(i) for all i below count, in any order and on any thread, and waits for all. Loops must not be nested:
  // a thread that waits in an inner loop could begin another round of the outer loop over the same scratch.
  template <class Visit>
  void ForEach(std::size_t count, const Visit& visit) {
    ForkJoin forkJoin;
    const auto visitRange = [&](const tbb::blocked_range<std::size_t>& range) {
      forkJoin.Begin();
      for (std::size_t i = range.begin(); i != range.end(); ++i) visit(i);
      forkJoin.End();
    };
    forkJoin.Fork();
    const tbb::blocked_range<std::size_t> all(0, count);
    if (m_count == 1) {
      visitRange(all);
    } else {
      m_arena.execute([&] { tbb::parallel_for(all, visitRange); });
    }
    forkJoin.Join();
  }

  // The same, for few visits of very different length: each thread takes the next one when it is done with one. Lists
  // that begin with the longest visits end together.
  template <class Visit>
  void ForEachInTurn(std::size_t count, const Visit& visit) {
    if (m_count == 1) return ForEach(count, visit);
    std::atomic<std::size_t> next = 0;
    ForEach(static_cast<std::size_t>(m_count), [&](std::size_t) {
      for (std::size_t i = next++; i < count; i = next++) visit(i);
    });
  }

 private:
  int m_count;
  tbb::global_control m_limit;  // also allows more threads than cores, for tests
  tbb::task_arena m_arena;
};

}  // namespace wobble::physics
