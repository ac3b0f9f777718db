// Run time against error in contact: the engine's methods at fixed and chosen substeps, XPBD and vertex block descent
// (solvers.h), and Bullet, on five scenes of half a second (contact_scenes.h).
//
// The error is the RMS distance of all vertices at the end from the engine's RK4 in double precision in 1,024 substeps
// a tick. Two columns tell how far that can be trusted: `change` is its distance from the same in 512, and `growth` how
// many times farther two motions are apart at the end that began 10⁻⁸ m apart. All methods are compared with this
// solution, whatever they converge to themselves. XPBD and block descent solve the same equations but for one small
// force of friction between bodies (soft_system.h); Bullet has other springs, contacts and friction, and its line says
// how far that is from these equations, not how well it solves its own.
//
// Time is that of the thread, for a second of motion, the shortest of some runs; searching for contacts is part of it.
// The engine's lanes are made for RK4 alone, so RK4 is shown in lanes, as the server runs it, and in plain code, like
// all other methods. Chosen substeps vary the error target, in double and, as played, in single precision. The number
// of substeps doubles until a run takes too long.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/precision_in_contact/contact_scenes.h"
#include "tests/bench/precision_in_contact/experiments.h"
#include "tests/bench/precision_in_contact/solvers.h"
#include "tests/bench/thread_time.h"
#include "tests/bench/throughput/bullet.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kAnyTarget = 1e9;      // m/s
constexpr double kAside = 1e-8;         // m
constexpr double kMeaningless = 1;      // m
constexpr double kMillimetres = 1000;   // in a metre
constexpr double kBulletMargin = 0.01;  // m

struct WorkPoint {
  double setting = 0;  // substeps a tick, or error target, m/s
  double error = 0;    // m; not finite where the run blew up
  double time = 0;     // s, for a second of motion
};

struct WorkRun {
  std::vector<Vector3d> end;
  double time = 0;  // s
};

// A method: its settings and how a scene is run with one of them.
struct WorkMethod {
  const char* name;   // in rows
  const char* title;  // in plots; empty: in none
  int colour = 0;     // of plots
  Stroke stroke = Stroke::kLineAndPoints;
  bool byTarget = false;  // settings are error targets, from loose to tight, otherwise substeps
  std::function<WorkRun(const ContactScene& scene, double setting)> run;
};

struct WorkLine {
  const ContactScene* scene = nullptr;
  const WorkMethod* method = nullptr;
  std::vector<WorkPoint> points{};
};

struct SceneReference {
  std::vector<Vector3d> end;
  double change = 0;  // m
  double growth = 0;
};

WorkRun RunWorld(const ContactScene& scene, World& world) {
  const double began = ReadThreadTime();
  for (int tick = 0; tick < scene.ticks; ++tick) (void)world.Step();
  const double time = ReadThreadTime() - began;
  return {ReadAllPositions(world), time};
}

WorldSettings MakeFixedSettings(int substeps) {
  WorldSettings settings;
  settings.precision = Precision::kDouble;
  settings.errorTarget = kAnyTarget;
  settings.leastSubsteps = substeps;
  return settings;
}

WorkRun RunFixed(const ContactScene& scene, int substeps, Integrator integrator, bool isPlain) {
  return RunWorld(scene, *MakeSceneWorld(scene, MakeFixedSettings(substeps), integrator, isPlain));
}

WorkRun RunChosen(const ContactScene& scene, double target, Precision precision) {
  WorldSettings settings;
  settings.precision = precision;
  settings.errorTarget = target;
  return RunWorld(scene, *MakeSceneWorld(scene, settings));
}

// Steps the laboratory's own system; step(h): one substep.
template <class Solver, class Step>
WorkRun RunSoftly(const ContactScene& scene, int substeps, const Step& step) {
  const std::unique_ptr<World> world = MakeSceneWorld(scene, MakeFixedSettings(1));
  SoftSystem system(*world);
  Solver solver(system);
  const double began = ReadThreadTime();
  for (int tick = 0; tick < scene.ticks; ++tick) {
    system.BeginTick(kContactTick);
    for (int substep = 0; substep < substeps; ++substep) step(solver, kContactTick / substeps);
  }
  const double time = ReadThreadTime() - began;
  return {system.x, time};
}

// One at a time: Bullet keeps accounts of its own that threads share.
WorkRun RunBullet(const ContactScene& scene, int substeps) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const std::unique_ptr<World> world = MakeSceneWorld(scene, MakeFixedSettings(1));
  BulletWorld bullet(
      *world, {.contacts = BulletSettings::Contacts::kVertexFace, .margin = kBulletMargin, .stepsATick = substeps});
  const double began = ReadThreadTime();
  for (int tick = 0; tick < scene.ticks; ++tick) bullet.Step();
  const double time = ReadThreadTime() - began;
  return {bullet.ListPositions(), time};
}

std::vector<WorkMethod> MakeMethods() {
  const auto fixed = [](Integrator integrator, bool isPlain) {
    return [=](const ContactScene& scene, double substeps) {
      return RunFixed(scene, static_cast<int>(substeps), integrator, isPlain);
    };
  };
  const auto chosen = [](Precision precision) {
    return [=](const ContactScene& scene, double target) { return RunChosen(scene, target, precision); };
  };
  const auto descend = [](int rounds) {
    return [=](const ContactScene& scene, double substeps) {
      return RunSoftly<BlockDescent>(scene, static_cast<int>(substeps),
                                     [=](BlockDescent& solver, double h) { solver.Step(h, rounds); });
    };
  };
  const auto xpbd = [](const ContactScene& scene, double substeps) {
    return RunSoftly<Xpbd>(scene, static_cast<int>(substeps), [](Xpbd& solver, double h) { solver.Step(h); });
  };
  const auto bullet = [](const ContactScene& scene, double substeps) {
    return RunBullet(scene, static_cast<int>(substeps));
  };
  constexpr auto kRk4 = Integrator::kRungeKutta4;
  constexpr auto kLine = Stroke::kLineAndPoints;
  return {
      {"rk4", "RK4, plain", 1, Stroke::kRings, false, fixed(kRk4, true)},
      {"rk4_in_lanes", "RK4, lanes", 1, kLine, false, fixed(kRk4, false)},
      {"rk4_chosen", "RK4, lanes, chosen substeps", 1, Stroke::kDashed, true, chosen(Precision::kDouble)},
      {"rk4_as_played", "", 0, kLine, true, chosen(Precision::kSingle)},
      {"semi_implicit_euler", "semi-implicit Euler", 4, kLine, false, fixed(Integrator::kSemiImplicitEuler, false)},
      {"implicit_euler", "implicit Euler", 6, kLine, false, fixed(Integrator::kImplicitEuler, false)},
      {"xpbd", "XPBD, small steps", 7, kLine, false, xpbd},
      {"block_descent_1", "block descent, 1 round", 2, kLine, false, descend(1)},
      {"block_descent_4", "block descent, 4 rounds", 2, Stroke::kRings, false, descend(4)},
      {"block_descent_16", "", 0, kLine, false, descend(16)},
      {"bullet", "Bullet", 8, Stroke::kDashed, false, bullet},
  };
}

SceneReference SolveScene(const ContactScene& scene, int substeps, bool withTrust) {
  SceneReference reference;
  reference.end = RunFixed(scene, substeps, Integrator::kRungeKutta4, false).end;
  const std::vector<Vector3d> half = RunFixed(scene, substeps / 2, Integrator::kRungeKutta4, false).end;
  reference.change = FindRms(reference.end, half);
  if (!withTrust) return reference;
  const std::unique_ptr<World> aside = MakeSceneWorld(scene, MakeFixedSettings(substeps / 2));
  for (const Body& body : aside->Bodies()) {
    std::vector<Vector3d> x = ReadPositions(body);
    for (std::size_t i = 0; i < x.size(); ++i) x[i].z() += kAside * std::sin(1.3 * static_cast<double>(i));
    aside->SetMotion(body.id, x, ReadVelocities(body));
  }
  reference.growth = FindRms(RunWorld(scene, *aside).end, half) / (kAside * std::sqrt(0.5));
  return reference;
}

// Limits on the time of a run and of its repetitions, s.
struct WorkLimits {
  double longest = 0;
  double repeated = 0;
  int mostSubsteps = 0;  // a tick
};

void SolveLine(const Bench& bench, const WorkLimits& limits, const SceneReference& reference, WorkLine& line) {
  constexpr double kLoosest = 0.1;  // m/s
  for (int i = 0; i < 11 && !bench.progress.IsStopAsked(); ++i) {
    WorkPoint point{.setting = line.method->byTarget ? kLoosest * std::pow(0.1, 0.5 * i) : std::ldexp(1, i)};
    if (!line.method->byTarget && point.setting > limits.mostSubsteps) return;
    WorkRun run = line.method->run(*line.scene, point.setting);
    double least = run.time;
    for (double spent = run.time; spent < limits.repeated; spent += run.time) {
      run = line.method->run(*line.scene, point.setting);
      least = std::min(least, run.time);
    }
    point.error = FindRms(run.end, reference.end);
    point.time = least / (line.scene->ticks * kContactTick);
    line.points.push_back(point);
    if (least > limits.longest) return;
  }
}

// The time at which the line comes below `error` for good, by straight lines in the logarithms; NaN if it does not.
double FindTimeAt(const WorkLine& line, double error) {
  double time = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = line.points.size(); i-- > 0;) {
    const WorkPoint& point = line.points[i];
    if (!(point.error <= error)) {
      if (i + 1 == line.points.size()) return time;
      const WorkPoint& next = line.points[i + 1];
      if (!std::isfinite(point.error)) return next.time;
      const double share = std::log(point.error / error) / std::log(point.error / next.error);
      return point.time * std::pow(next.time / point.time, share);
    }
    time = point.time;
  }
  return time;
}

void AddWorkRow(const WorkLine& line, const SceneReference& reference, Results& results) {
  nlohmann::ordered_json row{{"experiment", "work_in_contact"},
                             {"scene", line.scene->name},
                             {"method", line.method->name},
                             {"reference_change", reference.change},
                             {"reference_growth", reference.growth},
                             {"ms_at_1_mm", 1e3 * FindTimeAt(line, 1e-3)},
                             {"ms_at_0.1_mm", 1e3 * FindTimeAt(line, 1e-4)}};
  for (const WorkPoint& point : line.points) {
    row[line.method->byTarget ? "target" : "substeps"].push_back(point.setting);
    row["error"].push_back(point.error);
    row["cpu_s"].push_back(point.time);
  }
  results.rows.push_back(std::move(row));
}

Plot DrawScene(const ContactScene& scene, const std::vector<WorkLine>& lines, const SceneReference& reference) {
  std::string file = scene.name;
  std::replace(file.begin(), file.end(), ' ', '_');
  Plot plot{.name = "accuracy_contact_" + file,
            .title = "Contact, " + scene.name + ": time against error, in double",
            .xLabel = "time of one thread for a second of motion, ms",
            .yLabel = "error after half a second, RMS, mm",
            .logX = true,
            .logY = true};
  double fastest = HUGE_VAL, slowest = 0;
  for (const WorkLine& line : lines) {
    if (line.scene != &scene || *line.method->title == '\0') continue;
    Series& series = plot.series.emplace_back(Series{line.method->title, line.method->stroke, {}});
    series.colour = line.method->colour;
    for (const WorkPoint& point : line.points) {
      if (!(point.error > 0 && point.error < kMeaningless)) continue;
      series.points.push_back({1e3 * point.time, kMillimetres * point.error});
      fastest = std::min(fastest, 1e3 * point.time);
      slowest = std::max(slowest, 1e3 * point.time);
    }
    if (series.points.empty()) plot.series.pop_back();
  }
  const double floor = kMillimetres * reference.change;
  if (floor > 0 && slowest > 0) {
    plot.series.push_back({"change of the reference", Stroke::kDashed, {{fastest, floor}, {slowest, floor}}, 3});
  }
  return plot;
}

}  // namespace

void MeasureWorkInContact(Bench& bench) {
  const bool quick = bench.options.quick;
  std::vector<ContactScene> scenes = MakeContactScenes();
  if (quick) scenes.erase(scenes.begin() + 2, scenes.end());
  std::vector<SceneReference> references(scenes.size());
  const int substeps = quick ? 256 : 1024;
  const bool solved =
      RunTrials(bench, scenes.size(), [&](std::size_t i) { references[i] = SolveScene(scenes[i], substeps, !quick); });
  if (!solved) return;
  const std::vector<WorkMethod> methods = MakeMethods();
  std::vector<WorkLine> lines;
  for (const ContactScene& scene : scenes) {
    for (const WorkMethod& method : methods) lines.push_back({.scene = &scene, .method = &method});
  }
  const WorkLimits limits = quick ? WorkLimits{0.02, 0.0, substeps / 4} : WorkLimits{1, 0.1, substeps / 2};
  const bool done = RunTrials(
      bench, lines.size(), [&](std::size_t i) { SolveLine(bench, limits, references[i / methods.size()], lines[i]); });
  if (!done) return;
  for (std::size_t i = 0; i < lines.size(); ++i) AddWorkRow(lines[i], references[i / methods.size()], bench.results);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    bench.results.plots.push_back(DrawScene(scenes[i], lines, references[i]));
  }
}

}  // namespace wobble::bench
