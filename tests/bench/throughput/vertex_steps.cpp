// The cost of an RK4 step per vertex: sixteen balls of 162 vertices that lie on the ground, in lanes as the server
// steps them, and by the plain reference, body by body with the same compiler flags. A tick is played in 32 steps, so
// that the per-tick cost of filling and reading back a pack hardly counts; other rows play it in 4, as the server may,
// and in the air. One ball alone is compared in a tick of 4 steps with all its costs.
//
// The work of a step is fixed at 684 flop per vertex, whatever an implementation really executes: the share of the peak
// then measures time only.
#include <limits>

#include "tests/bench/throughput/balls.h"
#include "tests/bench/throughput/experiments.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr std::size_t kPackedBodies = 16;
constexpr int kManySteps = 32;
constexpr int kFewSteps = 4;
constexpr double kUsefulFlops = 684;  // per vertex and step of a ball

// An implementation of the steps.
struct Way {
  int lanes = 0;  // at most; 0: the plain reference
  bool isSingle = true;
  BallsSetting setting;
  std::function<void()> take{};         // takes the steps and records their time
  std::function<double()> findShare{};  // per vertex and step, s
  double contacts = 0;                  // listed per body
};

template <class Real>
Way MakeWay(const std::shared_ptr<const World>& world, int lanes, const BallsSetting& setting) {
  const auto balls = std::make_shared<Balls<Real>>(world, setting);
  const auto fastest = std::make_shared<Fastest>();
  Way way{.lanes = lanes > 0 ? FindSweepKernels<Real>(lanes).back().width : 0,
          .isSingle = std::is_same_v<Real, float>,
          .setting = setting};
  // Shorter work is repeated more often, so that each way has the same chance of an undisturbed run.
  const auto again = static_cast<int>(kPackedBodies / setting.bodies) * kManySteps / setting.steps;
  way.take = [balls, fastest, lanes, again] {
    for (int i = 0; i < again; ++i) {
      balls->Reset();
      fastest->Time([&] { lanes > 0 ? balls->StepInLanes(lanes) : balls->StepPlainly(); });
    }
  };
  way.findShare = [balls, fastest] { return balls->FindShare(fastest->Read()); };
  way.contacts = balls->CountContacts();
  return way;
}

template <class Real>
void AddWays(std::vector<Way>& ways) {
  const auto world = MakeBallsAtRest<Real>();
  ways.push_back(MakeWay<Real>(world, 0, {}));
  for (const SweepKernel<Real>& kernel : FindSweepKernels<Real>(kWidestPack)) {
    ways.push_back(MakeWay<Real>(world, kernel.width, {}));
  }
  for (const int lanes : {0, kWidestPack}) {
    ways.push_back(MakeWay<Real>(world, lanes, {.steps = kFewSteps}));
    ways.push_back(MakeWay<Real>(world, lanes, {.isOnGround = false}));
    ways.push_back(MakeWay<Real>(world, lanes, {.bodies = 1, .steps = kFewSteps}));
  }
}

// In float, with the widest lanes.
double FindShare(const std::vector<Way>& ways, bool isInLanes, std::size_t bodies, int steps, bool isOnGround = true) {
  double least = std::numeric_limits<double>::infinity();
  for (const Way& way : ways) {
    const bool isIt = way.isSingle && (way.lanes > 0) == isInLanes && way.setting.isOnGround == isOnGround &&
                      way.setting.bodies == bodies && way.setting.steps == steps;
    if (isIt) least = std::min(least, way.findShare());
  }
  return least;
}

void AddRows(Bench& bench, const std::vector<Way>& ways, double peak) {
  for (const Way& way : ways) {
    const double share = way.findShare();
    bench.results.rows.push_back({{"experiment", "vertex_steps"},
                                  {"method", way.lanes > 0 ? "lanes" : "plain"},
                                  {"lanes", std::clamp(way.lanes, 1, static_cast<int>(way.setting.bodies))},
                                  {"precision", way.isSingle ? "float" : "double"},
                                  {"bodies", way.setting.bodies},
                                  {"steps_per_tick", way.setting.steps},
                                  {"contacts_per_body", way.contacts},
                                  {"ns_per_vertex_step", share * 1e9},
                                  {"peak_gflops", peak / 1e9}});
  }
}

}  // namespace

void MeasureVertexSteps(Bench& bench) {
  std::vector<Way> ways;
  AddWays<float>(ways);
  AddWays<double>(ways);
  Peak peak;
  const int rounds = bench.options.quick ? 4 : 150;
  for (int round = 0; round < rounds && !bench.progress.IsStopAsked(); ++round) {
    for (const Way& way : ways) way.take();
    peak.Measure();
    bench.progress.Show(round + 1, rounds);
  }
  AddRows(bench, ways, peak.FlopsPerSecond());
  const double inLanes = FindShare(ways, true, kPackedBodies, kManySteps);
  const double plainly = FindShare(ways, false, kPackedBodies, kManySteps);
  const double share = kUsefulFlops / inLanes / peak.FlopsPerSecond();
  Results& results = bench.results;
  results.remarks.push_back(
      FormatLine("ns_per_vertex_step: with %.0f of 162 vertices near the ground; %.1f in the air, "
                 "plain code %.1f; %.1f where a tick has 4 steps",
                 ways[0].contacts, FindShare(ways, true, kPackedBodies, kManySteps, false) * 1e9,
                 FindShare(ways, false, kPackedBodies, kManySteps, false) * 1e9,
                 FindShare(ways, true, kPackedBodies, kFewSteps) * 1e9));
  results.AddFigure("peak_gflops", peak.FlopsPerSecond() / 1e9);
  results.AddFigureAtMost("ns_per_vertex_step", inLanes * 1e9, HasAvx512() ? 13 : 17, !bench.options.quick);
  results.AddFigureAtMost("plain_ns_per_vertex_step", plainly * 1e9, 160, !bench.options.quick);
  results.AddFigureAtLeast("speedup_vs_plain", plainly / inLanes, 10, HasAvx512() && !bench.options.quick);
  results.AddFigureAtLeast("peak_share", share, 0.35, HasAvx512() && !bench.options.quick);
  results.AddFigureAtMost("lone_ratio", FindShare(ways, true, 1, kFewSteps) / FindShare(ways, false, 1, kFewSteps), 1);
}

}  // namespace wobble::bench
