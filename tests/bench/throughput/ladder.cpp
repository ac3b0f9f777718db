// The cost of packs that are not full. Bodies share a pack only when they take equal substeps, which each chooses from
// a ladder: the more the motions differ and the fewer bodies there are, the more lanes stay empty, and a pack takes as
// long with empty lanes as with full ones.
//
// Measured first for one pack with increasing numbers of bodies, then for balls in the air that vibrate by 0.1 to 20 %
// of their radius: each with the substeps that the default error target chooses, against the same balls all with the
// same number.
#include <cmath>
#include <map>

#include "server/physics/methods/stability.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/throughput/balls.h"
#include "tests/bench/throughput/experiments.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kTicksToChoose = 30;
constexpr double kLeastStretch = 0.001;
constexpr double kMostStretch = 0.2;

void MeasurePacks(Bench& bench) {
  Plot plot{.name = "throughput_lanes",
            .title = "A step of a pack with ever more balls of 162 vertices, on the ground",
            .xLabel = "balls in the pack",
            .yLabel = "ns a vertex and step"};
  Series measured{"measured", Stroke::kLineAndPoints, {}};
  const int widest = FindSweepKernels<float>(kWidestPack).back().width;
  const auto world = MakeBallsAtRest<float>();
  const int rounds = bench.options.quick ? 4 : 100;
  for (int bodies = 1; bodies <= widest; ++bodies) {
    Balls<float> balls(world, {.bodies = static_cast<std::size_t>(bodies), .steps = kTimedSubsteps});
    Fastest fastest;
    Peak peak;
    for (int round = 0; round < rounds; ++round) {
      balls.Reset();
      fastest.Time([&] { balls.StepInLanes(widest); });
      peak.Measure();
    }
    const double share = balls.FindShare(fastest.Read()) * 1e9;
    measured.points.push_back({static_cast<double>(bodies), share});
    bench.results.rows.push_back({{"experiment", "pack"},
                                  {"bodies", bodies},
                                  {"ns_per_vertex_step", share},
                                  {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
  }
  Series ideal{"if a step took the same, however many they are", Stroke::kDashed, {}};
  for (const auto& [bodies, share] : measured.points) {
    ideal.points.push_back({bodies, measured.points.back()[1] * widest / bodies});
  }
  plot.series = {measured, ideal};
  bench.results.plots.push_back(std::move(plot));
}

// Balls in the air without gravity, so that vibration alone decides.
std::unique_ptr<World> MakeVibratingBalls(std::size_t count) {
  WorldSettings settings;
  settings.gravity.setZero();
  auto world = std::make_unique<World>(settings);
  world->AddBlueprint(MakeTimedBall());
  for (std::size_t i = 0; i < count; ++i) {
    const BodyId id = world->AddBody(0, Vector3d(4 * static_cast<double>(i), 0, 0));
    std::vector<Vector3d> x = ReadPositions(world->ReadBody(id));
    const double along = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double stretch = 1 + kLeastStretch * std::pow(kMostStretch / kLeastStretch, along);
    for (Vector3d& each : x) each.z() *= stretch;
    world->SetMotion(id, x, ReadVelocities(world->ReadBody(id)));
  }
  for (int tick = 0; tick < kTicksToChoose; ++tick) world->Step();
  return world;
}

// Share of the lanes that are filled when each body takes its next choice of substeps, 0 to 1.
double FindFilledShare(const World& world) {
  const Blueprint& blueprint = world.Blueprints()[0];
  std::map<int, std::size_t> rungs;
  for (const Body& body : world.Bodies()) {
    const auto& state = std::get<State<float>>(body.state);
    Load<float> load;
    load.stiffening = FindStiffening<float>(blueprint, state.positions);
    const int stable =
        ChooseSubsteps<float>(blueprint.integrator, blueprint, load, state, {}, {}, world.Settings().tickDuration);
    ++rungs[std::max(stable, body.steps.Substeps())];
  }
  const auto width = static_cast<std::size_t>(FindSweepKernels<float>(kWidestPack).back().width);
  std::size_t lanes = 0;
  for (const auto& [substeps, bodies] : rungs) lanes += (bodies + width - 1) / width * width;
  return static_cast<double>(world.Bodies().size()) / static_cast<double>(lanes);
}

struct Population {
  double filled = 0;  // share of lanes
  double spread = 0;  // ns per vertex and substep, each body with its own number
  double alike = 0;   // the same, all with one number
};

Population MeasurePopulation(Bench& bench, std::size_t count) {
  const auto world = MakeVibratingBalls(count);
  const Played own = CountPlayed(*world, world->Settings(), kTimedTicks);
  // The rung nearest to the mean of the chosen numbers, so that the fixed cost of a tick is spread over as many
  // substeps.
  WorldSettings alike = FixSubsteps(FindRung(own.substeps - 0.5));
  alike.gravity.setZero();
  const Replay replays[] = {MakeReplay(*world, world->Settings(), kTimedTicks), MakeReplay(*world, alike, kTimedTicks)};
  Peak peak;
  const auto times = TimeReplays(bench, replays, bench.options.quick ? 3 : 20, peak);
  const double vertices = static_cast<double>(count * world->Blueprints()[0].rest.size());
  const Played same = CountPlayed(*world, alike, kTimedTicks);
  const Population population{FindFilledShare(*world), times[0].FindMean() / vertices / own.allSubsteps * 1e9,
                              times[1].FindMean() / vertices / same.allSubsteps * 1e9};
  bench.results.rows.push_back({{"experiment", "ladder"},
                                {"bodies", count},
                                {"substeps", own.substeps},
                                {"substeps_alike", same.substeps},
                                {"lanes_filled", population.filled},
                                {"ns_per_vertex_substep", population.spread},
                                {"ns_per_vertex_substep_alike", population.alike},
                                {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
  return population;
}

}  // namespace

void MeasureLadder(Bench& bench) {
  MeasurePacks(bench);
  Plot plot{.name = "throughput_ladder",
            .title = "Balls that vibrate by 0.1 to 20 %, each in its own number of substeps",
            .xLabel = "balls in the world",
            .yLabel = "ns a vertex and substep, whole tick"};
  plot.series = {{"each as many as it needs", Stroke::kLineAndPoints, {}},
                 {"all the same number", Stroke::kLineAndPoints, {}},
                 {"all the same, over the share of lanes that are filled", Stroke::kDashed, {}}};
  Population largest;
  for (const std::size_t count : {16U, 32U, 64U, 128U, 256U, 512U}) {
    if (bench.progress.IsStopAsked() || (bench.options.quick && count > 64)) break;
    largest = MeasurePopulation(bench, count);
    const auto x = static_cast<double>(count);
    plot.series[0].points.push_back({x, largest.spread});
    plot.series[1].points.push_back({x, largest.alike});
    plot.series[2].points.push_back({x, largest.alike / largest.filled});
  }
  bench.results.plots.push_back(std::move(plot));
  bench.results.AddFigure("ladder_lanes_filled", largest.filled);
  bench.results.AddFigure("ladder_cost", largest.spread / largest.alike);
}

}  // namespace wobble::bench
