// The largest stable step of each method, measured in the engine and compared with theory (modes.h).
//
// A body at rest is disturbed by a ten-millionth of its size and stepped; the step is bisected between one at which the
// disturbance decays, or at least does not grow, and one at which it grows. Balls are fixed at three vertices and
// lattices at one side, so that they cannot drift. Theory only brackets the search: half of its limit must be stable
// and twice the limit must not, or the figure is missed.
//
// Two methods have no limit to compare; they are given huge steps, none of which may let anything grow. Implicit Euler
// is stable at any step by theory. Position Verlet restores the lengths of springs instead of stepping them, and with
// nothing but springs in the body its step does not contain h: x'' = P (2 x' − x), with P a chain of projections of
// norm at most 1. With gas inside it has its own rest shape, larger for larger steps, to which linear theory does not
// apply; perturbations.cpp shows the effect.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/methods/stability.h"
#include "server/physics/methods/step_limits.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/pair.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/stability/experiments.h"
#include "tests/bench/stability/growing.h"
#include "tests/bench/stability/modes.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr int kSteps = 2048;
constexpr int kEulerSteps = 1 << 16;       // explicit Euler lets slow modes grow by a millionth per step
constexpr double kBracket = 2;             // initial bracket: theory's limit times and over this
constexpr int kBisections = 9;             // of the logarithm: to 0.3 %
constexpr double kWeakestDamping = 0.004;  // damping ratio for which steps are counted
constexpr double kEulerMargin = 0.02;
constexpr double kHugeSteps[] = {1, 30, 1000};  // in units of one over the fastest frequency
constexpr double kSmallStep = 0.02;             // in the same unit: explicit Euler grows by e in 5000 such steps
constexpr Integrator kLimited[] = {Integrator::kRungeKutta4, Integrator::kVelocityVerlet, Integrator::kLeapFrog,
                                   Integrator::kSemiImplicitEuler, Integrator::kExplicitEuler};

struct LimitedBody {
  std::string kind;
  double stiffness = 0;  // of a spring, N/m; of a lattice: Young's modulus, Pa
  double dampingRatio = 0;
  double gas = 0;  // J
  Blueprint blueprint;
  LinearMotion motion;

  [[nodiscard]] bool IsPair() const { return blueprint.rest.size() == 2; }
};

struct LimitTrial {
  const LimitedBody* subject;
  Integrator integrator;
  StepLimit theory;
  double measured = 0;  // s; 0: unstable at the smallest step tried, infinity: stable at the largest
};

LimitedBody MakeLimitedBody(const std::string& kind, double stiffness, double dampingRatio, double gas,
                            Blueprint blueprint) {
  return {kind, stiffness, dampingRatio, gas, std::move(blueprint), {}};
}

LimitedBody MakeBallSubject(int subdivisions, double stiffness, double dampingRatio, double gas) {
  BallDefinition ball;
  ball.subdivisions = subdivisions;
  ball.material.stiffness = stiffness;
  ball.material.dampingRatio = dampingRatio;
  ball.material.gas = gas;
  Blueprint blueprint = MakeBall(ball);
  blueprint.full.fixed = {0, 1, 2};
  FinishBlueprint(blueprint);
  return MakeLimitedBody("ball of " + std::to_string(CountVertices(subdivisions)), stiffness, dampingRatio, gas,
                         std::move(blueprint));
}

LimitedBody MakeLatticeSubject(double youngModulus, double dampingRatio) {
  LatticeDefinition lattice;
  lattice.cells = {2, 2, 2};
  lattice.youngModulus = youngModulus;
  lattice.dampingRatio = dampingRatio;
  lattice.fixed = Side::kLowZ;
  return MakeLimitedBody("lattice of 27", youngModulus, dampingRatio, 0, MakeLattice(lattice));
}

LimitedBody MakePairSubject(double dampingRatio) {
  PairDefinition pair;
  pair.firstIsFixed = true;
  pair.material.dampingRatio = dampingRatio;
  return MakeLimitedBody("pair", pair.material.stiffness, dampingRatio, 0, MakePair(pair));
}

std::vector<LimitedBody> MakeSubjects(bool quick) {
  std::vector<LimitedBody> subjects;
  const std::vector<double> dampings =
      quick ? std::vector<double>{0, 0.2, 1} : std::vector<double>{0, 0.05, 0.2, 0.5, 1};
  for (const double stiffness : {150.0, 1500.0, 15000.0}) {
    if (quick && stiffness == 1500) continue;
    for (const double dampingRatio : dampings) {
      for (const double gas : {0.0, 30.0, 300.0}) {
        if (quick && gas == 30) continue;
        subjects.push_back(MakeBallSubject(1, stiffness, dampingRatio, gas));
      }
      if (quick && stiffness > 150) continue;
      subjects.push_back(MakeLatticeSubject(20 * stiffness, dampingRatio));
    }
  }
  for (const double dampingRatio : {0.0, 0.2}) {
    if (!quick) subjects.push_back(MakeBallSubject(2, 1500, dampingRatio, 300));
  }
  for (int i = 0; i <= 10; ++i) subjects.push_back(MakePairSubject(0.28 * i));
  return subjects;
}

double FindSmallStep(const LimitTrial& trial) { return kSmallStep / trial.theory.frequency; }

// At a step too large by a share s, explicit Euler lets a motion of damping ratio ζ grow by 2ζ² s per step, and at
// smaller steps others decay no faster: the weaker the damping, the more steps are needed to decide.
int CountSteps(const LimitTrial& trial) {
  if (trial.integrator != Integrator::kExplicitEuler) return kSteps;
  const double ratio = std::max(trial.theory.dampingRatio, kWeakestDamping);
  int steps = kEulerSteps;
  while (trial.theory.step > 0 && steps < 64 / (ratio * ratio)) steps *= 2;
  return steps;
}

double MeasureStep(const LimitTrial& trial) {
  Disturbed body(trial.subject->blueprint, trial.integrator, trial.subject->IsPair());
  const bool isEuler = trial.integrator == Integrator::kExplicitEuler;
  const int steps = CountSteps(trial);
  const auto grows = [&](double h) { return body.Grows(h, steps, isEuler ? kEulerMargin : 1); };
  if (trial.theory.step == 0) return grows(FindSmallStep(trial)) ? 0 : FindSmallStep(trial);
  double begin = trial.theory.step / kBracket;
  double end = trial.theory.step * kBracket;
  if (grows(begin)) return 0;
  if (!grows(end)) return kForever;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = std::sqrt(begin * end);
    (grows(middle) ? end : begin) = middle;
  }
  return std::sqrt(begin * end);
}

double FindDeviation(double found, double theory) {
  if (theory == 0) return found == 0 ? 0 : kForever;
  return std::fabs(found / theory - 1);
}

// The limit by integrator.h for the single oscillator of the first growing motion.
double FindClosedForm(const LimitTrial& trial) {
  const double w = trial.theory.frequency;
  return FindLargestStep(trial.integrator, w * w, 2 * trial.theory.dampingRatio * w);
}

// The step that a server takes for this body alone.
double FindServerStep(const LimitTrial& trial) {
  const Blueprint& blueprint = trial.subject->blueprint;
  Modes modes;
  modes.body = {blueprint.angularFrequency * blueprint.angularFrequency, blueprint.dampingRate};
  return 1 / FindStableRate(trial.integrator, blueprint, modes);
}

void AddLimitRow(Bench& bench, const LimitTrial& trial) {
  const LimitedBody& subject = *trial.subject;
  bench.results.rows.push_back({{"experiment", "limit"},
                                {"method", FindName(trial.integrator)},
                                {"body", subject.kind},
                                {"stiffness", subject.stiffness},
                                {"damping_ratio", subject.dampingRatio},
                                {"gas", subject.gas},
                                {"mode_frequency", trial.theory.frequency},
                                {"mode_damping_ratio", trial.theory.dampingRatio},
                                {"theory", trial.theory.step},
                                {"closed_form", FindClosedForm(trial)},
                                {"measured", trial.measured},
                                {"deviation", FindDeviation(trial.measured, trial.theory.step)},
                                {"server_step", FindServerStep(trial)}});
}

void AddFigures(Bench& bench, const std::vector<LimitTrial>& trials) {
  double worst = 0;
  double worstOfForms = 0;
  double worstOfServer = 0;
  for (const LimitTrial& trial : trials) {
    const bool isOneOscillator = trial.integrator != Integrator::kVelocityVerlet || trial.subject->gas == 0;
    const double ofForm = FindDeviation(FindClosedForm(trial), trial.theory.step);
    worst = std::max(worst, FindDeviation(trial.measured, trial.theory.step));
    if (isOneOscillator) worstOfForms = std::max(worstOfForms, ofForm);
    // A server does not choose steps for which explicit Euler is stable.
    if (trial.integrator == Integrator::kExplicitEuler) continue;
    worstOfServer = std::max(worstOfServer, FindServerStep(trial) / trial.measured);
  }
  bench.results.AddFigureAtMost("theory_deviation_max", worst, 0.03);
  bench.results.AddFigureAtMost("closed_form_deviation_max", worstOfForms, 1e-3);
  bench.results.AddFigureAtMost("server_step_over_limit_max", worstOfServer, 1);
}

// Step and limit in units of the limiting oscillator, so that all bodies share one line.
void AddPlotOfLimits(Bench& bench, const std::vector<LimitTrial>& trials) {
  struct Line {
    const char* name;
    Integrator integrator;
  };
  constexpr Line kLines[] = {{"RK4", Integrator::kRungeKutta4},
                             {"velocity Verlet", Integrator::kVelocityVerlet},
                             {"semi-implicit Euler, leap-frog", Integrator::kSemiImplicitEuler},
                             {"explicit Euler", Integrator::kExplicitEuler}};
  Plot plot{.name = "stability_limits",
            .title = "Largest stable step: theory (lines), measured on balls, lattices and pairs (points)",
            .xLabel = "damping of the motion that grows first, 1 = critical",
            .yLabel = "step times its angular frequency, hω"};
  int colour = 0;
  for (const Line& line : kLines) {
    Series theory{line.name, Stroke::kLine, {}, ++colour};
    Series measured{colour == 1 ? "measured" : "", Stroke::kRings, {}, colour};
    for (int i = 0; i <= 260; ++i) {
      theory.points.push_back({0.01 * i, FindLargestStep(line.integrator, 1, 0.02 * i)});
    }
    for (const LimitTrial& trial : trials) {
      const bool isLeapFrog =
          trial.integrator == Integrator::kLeapFrog && line.integrator == Integrator::kSemiImplicitEuler;
      if (trial.integrator != line.integrator && !isLeapFrog) continue;
      measured.points.push_back({std::fabs(trial.theory.dampingRatio), trial.measured * trial.theory.frequency});
    }
    plot.series.push_back(std::move(theory));
    plot.series.push_back(std::move(measured));
  }
  bench.results.plots.push_back(std::move(plot));
}

// Growth per step over damping and step, for a pair: the one body that is a single oscillator.
void AddMap(Bench& bench, Integrator integrator, const std::string& name, const std::string& title) {
  const int across = bench.options.quick ? 30 : 60;
  constexpr double kLargestRatio = 2;
  constexpr double kLargestProduct = 3.5;
  std::vector<std::array<double, 3>> cells(static_cast<std::size_t>(across) * static_cast<std::size_t>(across));
  const bool done = RunTrials(bench, static_cast<std::size_t>(across), [&](std::size_t column) {
    const double ratio = kLargestRatio * (static_cast<double>(column) + 0.5) / across;
    // √2: the definition's ratio is that of two swinging masses, of which one is fixed here.
    const LimitedBody pair = MakePairSubject(std::sqrt(2) * ratio);
    Disturbed body(pair.blueprint, integrator, true);
    const double frequency = std::sqrt(pair.stiffness / pair.blueprint.full.masses[1]);
    for (int row = 0; row < across; ++row) {
      const double product = kLargestProduct * (row + 0.5) / across;
      cells[static_cast<std::size_t>(row * across) + column] = {ratio, product,
                                                                body.FindGrowth(product / frequency, 64)};
    }
  });
  if (!done) return;
  Series limit{"the limit by theory", Stroke::kLine, {}, 8};
  for (int i = 0; i <= 200; ++i) {
    limit.points.push_back({0.01 * i, FindLargestStep(integrator, 1, 0.02 * i)});
  }
  bench.results.plots.push_back({name,
                                 title,
                                 "damping, 1 = critical",
                                 "step times angular frequency, hω",
                                 {limit},
                                 false,
                                 false,
                                 {"growth in a step, natural logarithm, measured", 0.5, cells}});
}

// Tests implicit Euler on all bodies except the largest, position Verlet on those without gas.
void MeasureHugeSteps(Bench& bench, const std::vector<LimitedBody>& subjects) {
  struct HugeStep {
    const LimitedBody* subject;
    Integrator integrator;
    double product;  // hω
    bool grows = false;
  };
  std::vector<HugeStep> steps;
  for (const LimitedBody& subject : subjects) {
    if (subject.blueprint.rest.size() > 100) continue;
    for (const double product : kHugeSteps) {
      steps.push_back({&subject, Integrator::kImplicitEuler, product});
      if (subject.gas == 0) steps.push_back({&subject, Integrator::kPositionVerlet, product});
    }
  }
  if (!RunTrials(bench, steps.size(), [&](std::size_t i) {
        HugeStep& each = steps[i];
        Disturbed body(each.subject->blueprint, each.integrator, each.subject->IsPair());
        each.grows = body.Grows(each.product / each.subject->blueprint.angularFrequency, kSteps, 1);
      })) {
    return;
  }
  int grown = 0;
  for (const HugeStep& each : steps) {
    grown += each.grows ? 1 : 0;
    bench.results.rows.push_back({{"experiment", "huge_step"},
                                  {"method", FindName(each.integrator)},
                                  {"body", each.subject->kind},
                                  {"stiffness", each.subject->stiffness},
                                  {"damping_ratio", each.subject->dampingRatio},
                                  {"gas", each.subject->gas},
                                  {"step", each.product / each.subject->blueprint.angularFrequency},
                                  {"step_times_frequency", each.product},
                                  {"grows", each.grows}});
  }
  bench.results.AddFigureAtMost("huge_steps_that_grow", grown, 0);
}

}  // namespace

void MeasureLimits(Bench& bench) {
  std::vector<LimitedBody> subjects = MakeSubjects(bench.options.quick);
  if (!RunTrials(bench, subjects.size(),
                 [&](std::size_t i) { subjects[i].motion = LineariseAtRest(subjects[i].blueprint); })) {
    return;
  }
  std::vector<LimitTrial> trials;
  for (const LimitedBody& subject : subjects) {
    for (const Integrator integrator : kLimited) trials.push_back({&subject, integrator, {}});
  }
  if (!RunTrials(bench, trials.size(), [&](std::size_t i) {
        trials[i].theory = FindStepLimit(trials[i].integrator, trials[i].subject->motion);
        trials[i].measured = MeasureStep(trials[i]);
      })) {
    return;
  }
  for (const LimitTrial& trial : trials) AddLimitRow(bench, trial);
  AddFigures(bench, trials);
  AddPlotOfLimits(bench, trials);
  AddMap(bench, Integrator::kRungeKutta4, "stability_map", "RK4: one oscillator, what a step does to it");
  AddMap(bench, Integrator::kExplicitEuler, "stability_map_euler",
         "Explicit Euler: one oscillator, what a step does to it");
  MeasureHugeSteps(bench, subjects);
}

}  // namespace wobble::bench
