#include "tests/bench/throughput/replays.h"

#include <algorithm>
#include <numeric>

namespace wobble::bench {
namespace {

void PlayOnce(const Replay& replay, double (*readClock)(), std::vector<Fastest>& fastest) {
  const std::function<void()> tick = replay.begin();
  for (int i = 0; i < replay.lead; ++i) tick();
  for (Fastest& each : fastest) each.Time(tick, readClock);
}

}  // namespace

double TickTimes::FindLeast() const { return *std::min_element(times.begin(), times.end()); }

double TickTimes::FindMean() const {
  return std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
}

double TickTimes::FindMost() const { return *std::max_element(times.begin(), times.end()); }

std::vector<TickTimes> TimeReplays(Bench& bench, std::span<const Replay> replays, int rounds, Peak& peak,
                                   double (*readClock)()) {
  std::vector<std::vector<Fastest>> fastest;
  for (const Replay& replay : replays) fastest.emplace_back(static_cast<std::size_t>(replay.ticks));
  for (int round = 0; round < rounds && !bench.progress.IsStopAsked(); ++round) {
    for (std::size_t i = 0; i < replays.size(); ++i) {
      PlayOnce(replays[i], readClock, fastest[i]);
      peak.Measure();
    }
  }
  std::vector<TickTimes> all;
  for (const std::vector<Fastest>& each : fastest) {
    all.emplace_back();
    for (const Fastest& tick : each) all.back().times.push_back(tick.Read());
  }
  return all;
}

}  // namespace wobble::bench
