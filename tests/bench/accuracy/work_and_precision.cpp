// The cost of accuracy. Every method solves every problem with increasing numbers of steps, in float and double, with
// Boost.odeint's RK4 and Dormand–Prince for comparison. A row is one method on one problem: for each number of steps,
// the final position error against the reference over the body's size, the thread time, the number of force evaluations
// and the change of energy.
//
// Step counts double from 60 a second until a solution would take too long, by the cost of the method's step. Short
// runs are repeated and the fastest counts. odeint takes the engine's forces, the faster of the two implementations
// (opponents.cpp); they are not available with surfaces. Where a solution blew up, its error is NaN, null in the rows.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/accuracy/odeint.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<int, 12> kRates = {60,   120,  240,   480,   960,   1920,
                                        3840, 7680, 15360, 30720, 61440, 122880};  // steps a second
constexpr double kLoosest = 0.1;     // largest tolerance of Dormand–Prince; each next one is a tenth
constexpr int kTightest = 12;        // number of these tolerances
constexpr double kDrawnError = 0.3;  // beyond it a solution is meaningless

struct Point {
  double tolerance = 0;    // for adaptive methods
  std::int64_t steps = 0;  // for fixed steps
  double error = kNone;
  double energyChange = kNone;
  double time = 0;  // s
  std::int64_t evaluations = 0;
};

struct Line {
  const Problem* problem = nullptr;
  const Motion* exact = nullptr;
  std::optional<Integrator> integrator{};  // none: odeint
  OdeintSteps::Method opponent = OdeintSteps::Method::kRungeKutta4;
  bool isSingle = false;
  std::vector<Point> points{};

  [[nodiscard]] const char* Name() const { return integrator ? FindName(*integrator) : FindName(opponent); }
  [[nodiscard]] const char* Title() const { return integrator ? FindTitle(*integrator) : FindTitle(opponent); }
};

// Limits on a run, and on repeating it.
struct Limits {
  double evaluations = 0;  // that a run may cost, its steps weighed by FindStepCost
  double repeated = 0;     // total time after which it is not repeated, s
};

// Cost of a step in force evaluations, measured on the ball of 162 vertices.
double FindStepCost(const Line& line) {
  if (!line.integrator) return 4;
  switch (*line.integrator) {
    case Integrator::kRungeKutta4:
      return 4;
    case Integrator::kVelocityVerlet:
      return 2;
    case Integrator::kPositionVerlet:
      return 9;
    case Integrator::kImplicitEuler:
      return 90;
    default:
      return 1;
  }
}

SolvedMotion SolveOnce(const Line& line, const Point& point) {
  if (line.integrator) {
    return SolveInSteps(
        *line.problem,
        {.integrator = *line.integrator, .steps = point.steps, .isSingle = line.isSingle, .isTimed = true});
  }
  return SolveByOdeint(
      *line.problem, {.method = line.opponent, .steps = point.steps, .tolerance = point.tolerance, .asksEngine = true});
}

// Reference scale of the energy: the energy above that of rest plus the work of the weight over the body's size.
double FindEnergyScale(const Problem& problem) {
  const std::vector<Vector3d> still(problem.x.size(), Vector3d::Zero());
  const double above = FindEnergy(problem.equations, problem.x, problem.v) -
                       FindEnergy(problem.equations, problem.blueprint->rest, still);
  return above + problem.blueprint->totalMass * problem.equations.gravity.norm() * problem.blueprint->size;
}

void SolvePoint(const Line& line, const Limits& limits, Point& point) {
  const Problem& problem = *line.problem;
  SolvedMotion solved = SolveOnce(line, point);
  point.time = solved.time;
  point.evaluations = solved.evaluations;
  if (solved.blewUp) return;
  point.error = FindDistance(solved.end.x, line.exact->x) / problem.blueprint->size;
  if (problem.isConservative) {
    point.energyChange = (FindEnergy(problem.equations, solved.end.x, solved.end.v) -
                          FindEnergy(problem.equations, problem.x, problem.v)) /
                         FindEnergyScale(problem);
  }
  for (double spent = solved.time; spent < limits.repeated; spent += solved.time) {
    solved = SolveOnce(line, point);
    point.time = std::min(point.time, solved.time);
  }
}

// Returns early when a stop is asked for.
void SolveAll(const Bench& bench, const Limits& limits, Line& line) {
  if (!line.integrator && line.opponent == OdeintSteps::Method::kDormandPrince) {
    for (int i = 0; i < kTightest && !bench.progress.IsStopAsked(); ++i) {
      Point& point = line.points.emplace_back(Point{.tolerance = kLoosest * std::pow(10, -i)});
      SolvePoint(line, limits, point);
      if (static_cast<double>(point.evaluations) > limits.evaluations) return;
    }
    return;
  }
  for (const int rate : kRates) {
    Point point{.steps = std::lround(rate * line.problem->duration)};
    const bool tooLong = static_cast<double>(point.steps) * FindStepCost(line) > limits.evaluations;
    if (tooLong || bench.progress.IsStopAsked()) return;
    SolvePoint(line, limits, point);
    line.points.push_back(point);
  }
}

std::vector<Line> MakeLines(const std::vector<Problem>& problems, const std::vector<Motion>& exact) {
  std::vector<Line> lines;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    for (const Integrator integrator : kIntegrators) {
      for (const bool isSingle : {false, true}) {
        lines.push_back({.problem = &problems[i], .exact = &exact[i], .integrator = integrator, .isSingle = isSingle});
      }
    }
    if (problems[i].touches) continue;
    for (const auto method : {OdeintSteps::Method::kRungeKutta4, OdeintSteps::Method::kDormandPrince}) {
      lines.push_back({.problem = &problems[i], .exact = &exact[i], .opponent = method});
    }
  }
  return lines;
}

void AddLineRow(Bench& bench, const Line& line) {
  if (line.points.empty()) return;
  nlohmann::ordered_json row{{"experiment", "work_and_precision"},
                             {"problem", line.problem->name},
                             {"method", line.Name()},
                             {"precision", line.isSingle ? "float" : "double"}};
  const bool isAdaptive = !line.integrator && line.opponent == OdeintSteps::Method::kDormandPrince;
  for (const Point& point : line.points) {
    if (isAdaptive) row["tolerance"].push_back(point.tolerance);
    if (!isAdaptive) row["steps"].push_back(point.steps);
    row["error"].push_back(point.error);
    row["cpu_s"].push_back(point.time);
    row["evaluations"].push_back(point.evaluations);
    if (line.problem->isConservative) row["energy_change"].push_back(point.energyChange);
  }
  bench.results.rows.push_back(std::move(row));
}

// Time over error, without position Verlet, which solves other equations.
Plot DrawWork(const std::vector<Line>& lines, const Problem& problem, const std::string& name) {
  Plot plot{.name = name,
            .title = problem.name + ": time against error, in double",
            .xLabel = "time of one thread for a second of motion, ms",
            .yLabel = "error at the end, over the body's size",
            .logX = true,
            .logY = true};
  for (const Line& line : lines) {
    if (line.problem != &problem || line.isSingle || line.integrator == Integrator::kPositionVerlet) continue;
    Series& series = plot.series.emplace_back();
    series.name = line.Title();
    series.stroke = line.integrator ? Stroke::kLineAndPoints : Stroke::kDashed;
    for (const Point& point : line.points) {
      if (!(point.error < kDrawnError)) continue;
      series.points.push_back({1e3 * point.time / problem.duration, point.error});
    }
    if (series.points.empty()) plot.series.pop_back();
  }
  return plot;
}

// Shows where more steps no longer reduce the error.
Plot DrawFloor(const std::vector<Line>& lines, const Problem& problem) {
  Plot plot{.name = "accuracy_float_floor",
            .title = problem.name + ": RK4 in float and in double",
            .xLabel = "steps",
            .yLabel = "error at the end, over the body's size",
            .logX = true,
            .logY = true};
  for (const Line& line : lines) {
    if (line.problem != &problem || line.integrator != Integrator::kRungeKutta4) continue;
    Series& series = plot.series.emplace_back();
    series.name = line.isSingle ? "float" : "double";
    series.stroke = Stroke::kLineAndPoints;
    for (const Point& point : line.points) {
      if (point.error < kDrawnError) series.points.push_back({static_cast<double>(point.steps), point.error});
    }
  }
  Series theory{"a fourth power of the step", Stroke::kDashed, {}};
  const auto& exact = plot.series[0].points;
  for (const auto& [steps, error] : exact) {
    theory.points.push_back({steps, exact[exact.size() / 2][1] * std::pow(exact[exact.size() / 2][0] / steps, 4)});
  }
  plot.series.push_back(std::move(theory));
  return plot;
}

// The problem that shows the effect of dashpots on methods of order 2.
bool IsDampedBall(const Problem& problem) {
  return !problem.isConservative && !problem.touches && problem.blueprint->full.gas > 0;
}

}  // namespace

void MeasureWorkAndPrecision(Bench& bench) {
  const bool quick = bench.options.quick;
  std::vector<Problem> problems = MakeProblems();
  const std::string first = problems[0].name;
  // The references of the other problems would take as long as the rest of a quick run.
  if (quick) std::erase_if(problems, [&](const Problem& each) { return each.name != first && !IsDampedBall(each); });
  std::vector<Motion> exact(problems.size());
  if (!RunTrials(bench, problems.size(), [&](std::size_t i) { exact[i] = SolveReference(problems[i]); })) return;
  std::vector<Line> lines = MakeLines(problems, exact);
  const Limits limits = quick ? Limits{12000, 0.003} : Limits{200000, 0.02};
  if (!RunTrials(bench, lines.size(), [&](std::size_t i) { SolveAll(bench, limits, lines[i]); })) return;
  for (const Line& line : lines) AddLineRow(bench, line);
  const Problem& damped = *std::find_if(problems.begin(), problems.end(), &IsDampedBall);
  bench.results.plots.push_back(DrawWork(lines, problems[0], "accuracy_work_precision"));
  bench.results.plots.push_back(DrawWork(lines, damped, "accuracy_work_precision_damped"));
  bench.results.plots.push_back(DrawFloor(lines, problems[0]));
}

}  // namespace wobble::bench
