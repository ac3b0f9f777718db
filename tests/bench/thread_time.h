// Clocks for comparisons on machines that have other load.
#pragma once

#include <time.h>

#include <algorithm>
#include <cmath>
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

// How long a piece of work took, s.
struct Took {
  double time = 0;  // by the clock that counts
  double wall = 0;

  Took& operator+=(const Took& other) {
    time += other.time;
    wall += other.wall;
    return *this;
  }
};

template <class Work>
Took TimeWork(const Work& work, double (*readClock)() = ReadThreadTime) {
  const double wall = ReadWallTime();
  const double began = readClock();
  work();
  return {.time = readClock() - began, .wall = ReadWallTime() - wall};
}

// The fastest of many repetitions of the same work: other load makes them slower.
//
// Other load also disturbs the clock of processor time. A virtual machine learns late of the time that its host took
// from it, and Linux subtracts it from whatever runs then (update_rq_clock_task in kernel/sched/core.c): beside a
// compiler, work of 66 µs took 41 to 60 µs of processor time in 9 of 270,000 repetitions, and in a run of CI none at
// all. Those nine lasted 97 µs or longer by the wall clock, as does whatever is interrupted. So only a repetition that
// was not interrupted counts; where each was, as is usual for work longer than a time slice, the fastest of all counts.
class Fastest {
 public:
  void Note(const Took& took) {
    constexpr double kUndisturbed = 0.9;  // of the wall time, at least
    double& least = took.time > kUndisturbed * took.wall ? m_undisturbed : m_disturbed;
    least = std::min(least, took.time);
  }
  template <class Work>
  void Time(const Work& work, double (*readClock)() = ReadThreadTime) {
    Note(TimeWork(work, readClock));
  }
  // The shortest time, s; infinite before the first.
  [[nodiscard]] double Read() const { return std::isfinite(m_undisturbed) ? m_undisturbed : m_disturbed; }

 private:
  double m_undisturbed = std::numeric_limits<double>::infinity();
  double m_disturbed = std::numeric_limits<double>::infinity();
};

}  // namespace wobble::bench
