// The share of a tick that the search takes for a thousand balls apart. Timed is what the tick does for it: a bounding
// box per body from its vertices, and the search among the boxes.
#include "server/physics/contact/broad_phase.h"
#include "server/physics/model/survey.h"
#include "tests/bench/skip/experiments.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr std::size_t kBodies = 1000;
constexpr int kTicks = 6;
constexpr double kFat = 0.1;  // m, about the margin that a tick adds to a box

void FindBoxes(const World& world, std::vector<Box>& boxes) {
  boxes.clear();
  for (const Body& body : world.Bodies()) {
    const auto& state = std::get<State<float>>(body.state);
    const std::vector<float>& masses = world.BlueprintOf(body).Read<float>().masses;
    const Bounds<float> bounds = MakeSurvey<float>(masses, state.positions, state.velocities).bounds;
    boxes.push_back({state.origin + bounds.low.cast<double>() - Vector3d::Constant(kFat),
                     state.origin + bounds.high.cast<double>() + Vector3d::Constant(kFat)});
  }
}

}  // namespace

void MeasureSearch(Bench& bench) {
  const auto world = MakeBallsApart(kBodies, WorldSettings{});
  const Replay replay = MakeReplay(*world, world->Settings(), kTicks);
  const int rounds = bench.options.quick ? 3 : 30;
  Peak peak;
  const TickTimes times = TimeReplays(bench, {&replay, 1}, rounds, peak)[0];
  std::vector<Box> boxes;
  BroadPhase broadPhase;
  Fastest finding;
  Fastest searching;
  std::size_t pairs = 0;
  for (int round = 0; round < 10 * rounds; ++round) {
    finding.Time([&] { FindBoxes(*world, boxes); });
    searching.Time([&] { pairs += broadPhase.FindOverlaps(boxes).size(); });
  }
  bench.results.rows.push_back({{"experiment", "search"},
                                {"bodies", kBodies},
                                {"pairs", pairs},
                                {"substeps", CountPlayed(*world, world->Settings(), kTicks).substeps},
                                {"boxes_us", finding.Read() * 1e6},
                                {"search_us", searching.Read() * 1e6},
                                {"us_per_tick", times.FindMean() * 1e6},
                                {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
  bench.results.AddFigureAtMost("apart_ratio", (finding.Read() + searching.Read()) / times.FindMean(), 0.05);
}

}  // namespace wobble::bench
