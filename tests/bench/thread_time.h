// The clocks for what is compared on machines that have other things to do.
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

// That this thread has worked, s: what others take from it is not its own.
inline double ReadThreadTime() { return ReadClock(CLOCK_THREAD_CPUTIME_ID); }

// For what several threads do together, s.
inline double ReadWallTime() { return ReadClock(CLOCK_MONOTONIC); }

// Of many repetitions of the same work the one that counts: what else a machine does can only make them longer.
class Fastest {
 public:
  void Note(double time) { m_least = std::min(m_least, time); }
  template <class Work>
  void Time(const Work& work) {
    const double began = ReadThreadTime();
    work();
    Note(ReadThreadTime() - began);
  }
  // Infinite before the first, s.
  [[nodiscard]] double Read() const { return m_least; }

 private:
  double m_least = std::numeric_limits<double>::infinity();
};

}  // namespace wobble::bench
