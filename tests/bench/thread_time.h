// Clocks for comparisons on machines that have other load.
#pragma once

#include <time.h>

#include <algorithm>
#include <limits>

namespace wobble::bench {

inline double ReadClock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Processor time of this thread, s: other load does not count.
inline double ReadThreadTime() { return ReadClock(CLOCK_THREAD_CPUTIME_ID); }

// Wall time, s, for the work of several threads.
inline double ReadWallTime() { return ReadClock(CLOCK_MONOTONIC); }

// The fastest of many repetitions of the same work: other load can only make them slower.
class Fastest {
 public:
  void Note(double time) { m_least = std::min(m_least, time); }
  template <class Work>
  void Time(const Work& work) {
    const double began = ReadThreadTime();
    work();
    Note(ReadThreadTime() - began);
  }
  // The shortest time, s; infinite before the first.
  [[nodiscard]] double Read() const { return m_least; }

 private:
  double m_least = std::numeric_limits<double>::infinity();
};

}  // namespace wobble::bench
