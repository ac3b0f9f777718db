// The cost of a whole tick without contact between bodies: everything in World::Step, from the contact search to sleep.
// One thread is timed by its own clock; two against one by wall time.
#include "tests/bench/throughput/experiments.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr std::size_t kBodies = 512;
constexpr std::size_t kBodiesQuick = 128;

void AddTickRow(Bench& bench, const std::string& experiment, std::size_t bodies, int threads, const TickTimes& times,
                const Peak& peak) {
  bench.results.rows.push_back({{"experiment", experiment},
                                {"bodies", bodies},
                                {"threads", threads},
                                {"ms_per_tick", times.FindMean() * 1e3},
                                {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
}

void MeasureOneThread(Bench& bench, std::size_t bodies) {
  const auto world = MakeBallsApart(bodies, FixSubsteps(kTimedSubsteps));
  const Played played = CountPlayed(*world, world->Settings(), kTimedTicks);
  const Replay replay = MakeReplay(*world, world->Settings(), kTimedTicks);
  Peak peak;
  const TickTimes times = TimeReplays(bench, {&replay, 1}, bench.options.quick ? 4 : 40, peak)[0];
  AddTickRow(bench, "tick", bodies, 1, times, peak);
  const double vertices = static_cast<double>(bodies * world->Blueprints()[0].rest.size());
  bench.results.AddFigureAtLeast("vertex_ticks_per_s", vertices / times.FindMean(), HasAvx512() ? 15e6 : 11e6,
                                 !bench.options.quick);
  bench.results.remarks.push_back(FormatLine("vertex_ticks_per_s: %zu balls, %.0f awake, %.2f ms a tick, %.2f substeps",
                                             bodies, played.awake, times.FindMean() * 1e3, played.allSubsteps));
}

// Both replays belong to a world of two threads, because a world with one thread limits all others to one.
void MeasureTwoThreads(Bench& bench, std::size_t bodies) {
  const auto world = MakeBallsApart(bodies, FixSubsteps(kTimedSubsteps, 2));
  const Replay replays[] = {MakeReplay(*world, FixSubsteps(kTimedSubsteps, 1), kTimedTicks),
                            MakeReplay(*world, FixSubsteps(kTimedSubsteps, 2), kTimedTicks)};
  Peak peak;
  const auto times = TimeReplays(bench, replays, bench.options.quick ? 4 : 60, peak, &ReadWallTime);
  for (int i = 0; i < 2; ++i) AddTickRow(bench, "threads", bodies, i + 1, times[static_cast<std::size_t>(i)], peak);
  bench.results.AddFigureAtLeast("thread_scaling_2", times[0].FindMean() / times[1].FindMean(), 1.8,
                                 !bench.options.quick);
}

}  // namespace

void MeasureTicks(Bench& bench) {
  const std::size_t bodies = bench.options.quick ? kBodiesQuick : kBodies;
  MeasureOneThread(bench, bodies);
  if (!bench.progress.IsStopAsked()) MeasureTwoThreads(bench, bodies);
}

}  // namespace wobble::bench
