// The cost of a tick: the whole step of a world at the default error target, on one thread, over the number of balls,
// apart on a floor, pressed together in a funnel as in the scene `scrum`, and as players of `pitch` who chase one
// another.
#include "tests/bench/throughput/experiments.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kTickMs = 1000.0 / 60;

using MakeWorld = std::unique_ptr<World> (*)(std::size_t, const WorldSettings&, int);

struct Crowd {
  const char* name;
  MakeWorld make;
  int ticks;
  std::size_t most;  // that there is room for
};
constexpr std::size_t kAny = 512;
constexpr Crowd kCrowds[] = {{"apart", &MakeBallsApart, kTicksToFall, kAny},
                             {"pressed", &MakeBallsInFunnel, kTicksToPress, kAny},
                             {"chasing", &MakePlayersChasing, kTicksToChase, 128}};

// Mean time of a tick, ms.
double MeasureCrowd(Bench& bench, const Crowd& crowd, std::size_t bodies) {
  const auto world = crowd.make(bodies, WorldSettings{}, crowd.ticks);
  const Replay replay = MakeReplay(*world, world->Settings(), kTimedTicks);
  Peak peak;
  const TickTimes times = TimeReplays(bench, {&replay, 1}, bench.options.quick ? 2 : 5, peak)[0];
  const Played played = CountPlayed(*world, world->Settings(), kTimedTicks);
  bench.results.rows.push_back({{"experiment", "crowd"},
                                {"where", crowd.name},
                                {"bodies", bodies},
                                {"awake", played.awake},
                                {"substeps", played.substeps},
                                {"all_substeps", played.allSubsteps},
                                {"ms_per_tick", times.FindMean() * 1e3},
                                {"most_ms_per_tick", times.FindMost() * 1e3},
                                {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
  return times.FindMean() * 1e3;
}

}  // namespace

void MeasureCrowds(Bench& bench) {
  std::vector<std::size_t> counts{64, 128, 256, 512};
  if (bench.options.quick) counts = {16, 32};
  Plot plot{.name = "throughput_crowds",
            .title = "A tick of the whole world, balls of 162 vertices, error target 1 mm/s, one thread",
            .xLabel = "balls",
            .yLabel = "ms a tick"};
  for (const Crowd& crowd : kCrowds) {
    plot.series.push_back({crowd.name, Stroke::kLineAndPoints, {}});
    for (const std::size_t bodies : counts) {
      if (bodies > crowd.most) break;
      if (bench.progress.IsStopAsked()) return;
      plot.series.back().points.push_back({static_cast<double>(bodies), MeasureCrowd(bench, crowd, bodies)});
    }
  }
  plot.series.push_back(
      {"a tick at 60 Hz",
       Stroke::kLine,
       {{static_cast<double>(counts.front()), kTickMs}, {static_cast<double>(counts.back()), kTickMs}}});
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace wobble::bench
