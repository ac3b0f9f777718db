// Scenes as the server plays them: friction, contact between bodies, sleep, single precision, the scene's own error
// target. At the end of every second each body is compared with a reference that began that second in the same state;
// the row also has the cost of the second, in thread time and substeps.
//
// Friction depends on where a contact began, and bodies in contact remember which face they follow. Such a second has
// no equations in positions and velocities alone that CVODE could solve, and it must begin with that memory. So the
// reference is a twin of the world (World's second constructor) in double precision with an error target that nothing
// meets: it takes 64 substeps per tick, and its tick is a quarter of the server's (--quick: the same). It is kept
// awake. Two columns tell how far it can be trusted: `change` is the difference to the same with half as many substeps,
// and `growth` is the factor by which two motions diverge over the second when one begins 10⁻⁸ m aside. Where growth is
// in the thousands, an error of a micrometre in the first ticks becomes millimetres.
//
// The twin shares the engine's forces. Where no bodies touch, in ball_drop, a second reference that shares only the
// blueprints' numbers (plain_ground.cpp) checks it: `plain` is the distance between the two.
//
// A sheet by position Verlet with relaxed constraints has no equations: each sweep corrects a share of the constraint
// error, however short the step, and finer steps give another sheet. It is left out.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>

#include "server/scenes/loader.h"
#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/accuracy/plain_ground.h"
#include "tests/bench/accuracy/played.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/thread_time.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;
using ScenePlaces = std::vector<std::vector<Vector3d>>;  // of all vertices of all bodies, m

constexpr double kSceneTick = 1.0 / kTicksASecond;
constexpr double kMillimetres = 1000;   // in a metre
constexpr double kUnreachable = 1e-12;  // error target, m/s
constexpr double kAside = 1e-8;         // m
constexpr double kIllPosed = 1000;      // growth: a micrometre becomes a millimetre
constexpr int kSubsteps = 64;           // per tick of the reference
constexpr int kCostRuns = 3;            // the cheapest counts

struct Second {
  std::unique_ptr<World> fine;       // twin at the beginning, later at the end of the second
  std::unique_ptr<World> half;       // the same with half as many substeps; null in a quick run
  std::unique_ptr<World> aside;      // like half, with offset positions; null in a quick run
  double apart = 0;                  // initial distance of these two, m
  std::vector<State<float>> begins;  // states at the beginning, in scenes where no bodies touch
  ScenePlaces played, plain;         // at the end
  double cost = HUGE_VAL;            // thread time, s
  std::uint64_t substeps = 0;
  std::uint64_t awake = 0, touching = 0;  // body-ticks; touching: those in contact with another body
};

struct PlayedScene {
  std::string name;
  int seconds;
  bool hasPlain = false;  // compared with the second reference
  std::unique_ptr<World> world;
  std::vector<Second> all;
};

std::unique_ptr<World> MakeWorld(const std::string& name, std::uint64_t seed) {
  const scenes::LoadResult loaded = scenes::LoadScene(name, scenes::FindShippedScenes());
  if (!loaded.errors.empty()) return nullptr;
  auto world = std::make_unique<World>(scenes::MakeWorldSettings(loaded.scene, kSceneTick, 1));
  (void)scenes::FillWorld(loaded.scene, seed, *world);
  return world;
}

int FindTicksOfReference(bool quick) { return quick ? 1 : 4; }

ScenePlaces ReadPlaces(const World& world) {
  ScenePlaces places;
  for (const Body& body : world.Bodies()) places.push_back(ReadPositions(body));
  return places;
}

std::unique_ptr<World> MakeTwin(const World& world, int ticks, int substeps) {
  WorldSettings settings = world.Settings();
  settings.precision = Precision::kDouble;
  settings.tickDuration /= ticks;
  settings.errorTarget = kUnreachable;
  settings.maxSubsteps = substeps;
  return std::make_unique<World>(world, settings);
}

void PlayTwin(World& twin, int ticks) {
  for (int tick = 0; tick < kTicksASecond; ++tick) {
    for (int part = 0; part < ticks; ++part) (void)twin.Step();
    KeepAwake(twin);
  }
}

void PlaySecond(World& world, Second& second) {
  second.substeps = second.awake = second.touching = 0;
  const double began = ReadThreadTime();
  for (int tick = 0; tick < kTicksASecond; ++tick) {
    const StepReport report = world.Step();
    second.substeps += report.allSubsteps;
    second.awake += report.awake;
    for (const Body& body : world.Bodies()) second.touching += body.touchesBody ? 1 : 0;
  }
  second.cost = std::min(second.cost, ReadThreadTime() - began);
}

// Displaces every free vertex slightly; returns the RMS displacement, m.
double MoveAside(World& world) {
  double sum = 0;
  std::size_t count = 0;
  for (const Body& body : world.Bodies()) {
    const std::vector<double>& inverseMasses = world.BlueprintOf(body).full.inverseMasses;
    std::vector<Vector3d> x = ReadPositions(body);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double way = inverseMasses[i] > 0 ? kAside * std::sin(1.3 * static_cast<double>(i)) : 0;
      x[i].z() += way;
      sum += way * way;
    }
    count += x.size();
    world.SetMotion(body.id, x, ReadVelocities(body));
  }
  return std::sqrt(sum / static_cast<double>(count));
}

void PlayScene(PlayedScene& scene, bool quick, std::uint64_t seed) {
  scene.world = MakeWorld(scene.name, seed);
  if (scene.world == nullptr) return;
  scene.all.resize(static_cast<std::size_t>(scene.seconds));
  for (Second& second : scene.all) {
    second.fine = MakeTwin(*scene.world, FindTicksOfReference(quick), kSubsteps);
    if (!quick) {
      second.half = MakeTwin(*scene.world, FindTicksOfReference(quick), kSubsteps / 2);
      second.aside = MakeTwin(*scene.world, FindTicksOfReference(quick), kSubsteps / 2);
      second.apart = MoveAside(*second.aside);
    }
    for (const Body& body : scene.world->Bodies()) second.begins.push_back(std::get<State<float>>(body.state));
    PlaySecond(*scene.world, second);
    second.played = ReadPlaces(*scene.world);
  }
  for (int run = 1; run < kCostRuns; ++run) {
    const std::unique_ptr<World> again = MakeWorld(scene.name, seed);
    for (Second& second : scene.all) PlaySecond(*again, second);
  }
}

void SolvePlainly(const PlayedScene& scene, int steps, Second& second) {
  Equations equations;
  equations.gravity = scene.world->Settings().gravity;
  equations.obstacles.assign(scene.world->Obstacles().begin(), scene.world->Obstacles().end());
  for (std::size_t i = 0; i < second.begins.size(); ++i) {
    equations.blueprint = &scene.world->BlueprintOf(scene.world->Bodies()[i]);
    second.plain.push_back(SolveOnGround(equations, second.begins[i], 1, steps).x);
  }
}

// For each body that has equations, its distance from the same body in `others`, m.
std::vector<double> FindDistances(const PlayedScene& scene, const ScenePlaces& places, const ScenePlaces& others) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Blueprint& blueprint = scene.world->BlueprintOf(scene.world->Bodies()[i]);
    if (blueprint.integrator == Integrator::kRungeKutta4) distances.push_back(FindDistance(places[i], others[i]));
  }
  return distances;
}

double FindRms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double FindMost(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

nlohmann::ordered_json MakeRow(const PlayedScene& scene, std::size_t index) {
  const Second& second = scene.all[index];
  const ScenePlaces reference = ReadPlaces(*second.fine);
  const std::vector<double> errors = FindDistances(scene, second.played, reference);
  const double target = scene.world->Settings().errorTarget;
  nlohmann::ordered_json row = {
      {"experiment", "scene"},
      {"scene", scene.name},
      {"second", index + 1},
      {"target", target},
      {"error", FindRms(errors)},
      {"error_most", FindMost(errors)},
      {"bodies", errors.size()},
      {"met", std::count_if(errors.begin(), errors.end(), [&](double error) { return error <= target; })},
      {"cost", second.cost},
      {"substeps_per_body_tick",
       static_cast<double>(second.substeps) / static_cast<double>(std::max<std::uint64_t>(1, second.awake))},
      {"body_ticks", second.awake},
      {"body_ticks_touching_bodies", second.touching}};
  if (second.half) {
    const ScenePlaces half = ReadPlaces(*second.half);
    row["change"] = FindMost(FindDistances(scene, reference, half));
    row["growth"] = FindMost(FindDistances(scene, half, ReadPlaces(*second.aside))) / second.apart;
  }
  if (scene.hasPlain) row["plain"] = FindMost(FindDistances(scene, reference, second.plain));
  return row;
}

void AddFindings(const PlayedScene& scene, Plot& plot, Results& results) {
  plot.series.push_back({scene.name, Stroke::kLine, {}});
  double worst = 0, cost = 0, growth = 0;
  std::size_t met = 0, bodies = 0, illPosed = 0;
  for (std::size_t i = 0; i < scene.all.size(); ++i) {
    const nlohmann::ordered_json row = MakeRow(scene, i);
    worst = std::max(worst, row["error"].get<double>());
    cost += scene.all[i].cost / scene.seconds;
    met += row["met"].get<std::size_t>();
    bodies += row["bodies"].get<std::size_t>();
    growth = std::max(growth, row.value("growth", 0.0));
    illPosed += row.value("growth", 0.0) > kIllPosed ? 1 : 0;
    // A horizontal line as long as the second.
    const double shown = kMillimetres * row["error_most"].get<double>();
    plot.series.back().points.push_back({static_cast<double>(i), shown});
    plot.series.back().points.push_back({static_cast<double>(i + 1), shown});
    results.rows.push_back(row);
  }
  results.AddFigure("scene_error_" + scene.name, kMillimetres * worst);
  results.AddFigure("scene_met_" + scene.name, static_cast<double>(met) / static_cast<double>(bodies));
  results.AddFigure("scene_cost_" + scene.name, cost);
  if (illPosed == 0) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "%s: in %zu of its seconds motions that begin 10 nm apart part up to %.0f times as far,"
                " and so does every error of their first ticks",
                scene.name.c_str(), illPosed, growth);
  results.remarks.push_back(text);
}

Plot MakePlot(int seconds) {
  Plot plot{.name = "accuracy_scenes",
            .title = "Scenes as the server plays them, second by second, against fine steps",
            .xLabel = "time, s",
            .yLabel = "error after a second, of the worst body, mm"};
  plot.logY = true;
  plot.series.push_back({"error target", Stroke::kDashed, {{0, 1}, {static_cast<double>(seconds), 1}}});
  return plot;
}

}  // namespace

void MeasureScenes(Bench& bench) {
  const bool quick = bench.options.quick;
  const int seconds = quick ? 2 : 6;
  std::vector<PlayedScene> all;
  for (const char* name : {"ball_drop", "cloth", "scrum", "jelly_stack"}) {
    all.emplace_back();
    all.back().name = name;
    all.back().hasPlain = all.back().name == "ball_drop";
    all.back().seconds = all.back().hasPlain || all.back().name == "cloth" ? seconds : 1;
  }
  for (PlayedScene& scene : all) {
    PlayScene(scene, quick, bench.options.seed);
    if (scene.world == nullptr) return bench.results.AddFigureAtMost("scene_error_" + scene.name, NAN, 0);
  }

  std::vector<std::function<void()>> tasks;
  const int ticks = FindTicksOfReference(quick);
  for (PlayedScene& scene : all) {
    for (Second& second : scene.all) {
      for (World* twin : {second.fine.get(), second.half.get(), second.aside.get()}) {
        if (twin != nullptr) tasks.emplace_back([twin, ticks] { PlayTwin(*twin, ticks); });
      }
      if (scene.hasPlain) tasks.emplace_back([&] { SolvePlainly(scene, kTicksASecond * ticks * kSubsteps, second); });
    }
  }
  if (!RunTrials(bench, tasks.size(), [&](std::size_t i) { tasks[i](); })) return;
  Plot plot = MakePlot(seconds);
  for (const PlayedScene& scene : all) AddFindings(scene, plot, bench.results);
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace wobble::bench
