// Replays the same ticks from the same beginning again and again, so that the fastest time of each tick counts.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tests/bench/report.h"
#include "tests/bench/thread_time.h"
#include "tests/bench/throughput/peak.h"

namespace wobble::bench {

struct Replay {
  // Builds the world at its beginning and returns its tick function, which owns the world.
  std::function<std::function<void()>()> begin;
  int lead = 3;  // uncounted ticks, during which memory grows
  int ticks = 12;
};

struct TickTimes {
  std::vector<double> times;  // per tick, s
  [[nodiscard]] double FindLeast() const;
  [[nodiscard]] double FindMean() const;
  [[nodiscard]] double FindMost() const;
};

// Times the replays in turns, over that many rounds, and the peak of the core between them. Only one replay is alive at
// a time, because a world with one thread limits all others in the process to one. readClock: thread time, or wall time
// for several threads.
[[nodiscard]] std::vector<TickTimes> TimeReplays(Bench& bench, std::span<const Replay> replays, int rounds, Peak& peak,
                                                 double (*readClock)() = &ReadThreadTime);

}  // namespace wobble::bench
