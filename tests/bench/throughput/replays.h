// The same ticks played again and again from the same beginning, so that of each of them the fastest can count.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tests/bench/report.h"
#include "tests/bench/thread_time.h"
#include "tests/bench/throughput/peak.h"

namespace wobble::bench {

struct Replay {
  // Makes what is played, as it is at the beginning, and returns its tick, which keeps it alive.
  std::function<std::function<void()>()> begin;
  int lead = 3;  // ticks that do not count: memory grows in them
  int ticks = 12;
};

struct TickTimes {
  std::vector<double> times;  // of each tick, s
  [[nodiscard]] double FindLeast() const;
  [[nodiscard]] double FindMean() const;
  [[nodiscard]] double FindMost() const;
};

// Of each replay, by turns, in so many rounds, the peak of the core between them. Only one is alive at a time: a world
// with one thread holds those beside it down to one. readClock: that of the thread, or of the wall for several threads.
[[nodiscard]] std::vector<TickTimes> TimeReplays(Bench& bench, std::span<const Replay> replays, int rounds, Peak& peak,
                                                 double (*readClock)() = &ReadThreadTime);

}  // namespace wobble::bench
