// Checks that bodies keep to the scene's error target. Bodies are played as the server plays them: single precision,
// the engine's own choice of substeps, sleep. At the end of every second each is compared with a reference that began
// that second in the same state. The RMS distance over the vertices is the error of that body-second; the target is met
// when the error is at most the target times one second.
//
// error_target_met is the share of all body-seconds at 0.1, 1 and 10 mm/s that met the target. error_target_overhead is
// the mean over all cases at these targets of (force evaluations as played, repeated ticks included) / (those of the
// cheapest fixed number of substeps per tick that meets the target in as many seconds). That number is found in
// hindsight for each case, among all integers and not only the ladder's rungs; the largest ratio is in the results too.
// Fixed steps also restart each second from the same states.
//
// The reference is CVODE on the laboratory's own equations. Worlds in double precision, run beside the played ones,
// tell which part of the error is due to single precision.
#include <algorithm>
#include <cmath>

#include "server/physics/methods/stability.h"
#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/accuracy/played.h"
#include "tests/bench/accuracy/problem.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

// Tolerance of the reference: it ends within 10⁻⁸ m of the solution at 10⁻¹², in a third of the time.
constexpr double kTolerance = 1e-9;
// Initial offset of a second motion, m, for measuring divergence.
constexpr double kTwinOffset = 1e-8;

struct Trial {
  const PlayedCase* played = nullptr;
  double target = 0;             // m/s
  bool isCompared = false;       // with fixed steps
  std::vector<double> errors;    // per second, m
  std::vector<double> rounding;  // distance of single from double precision, m
  int asleep = 0;                // seconds that ended asleep
  double substeps = 0;           // per tick, mean
  bool isGrowthMeasured = false;
  double growth = 0;      // largest growth of a small difference over a second
  int fixedSubsteps = 0;  // per tick; 0: none up to kMaxSubsteps suffices
};

Problem MakeProblemOfSecond(const PlayedCase& played, const State<float>& begin) {
  Problem problem;
  problem.name = played.name;
  problem.blueprint = played.blueprint;
  problem.equations = played.equations;
  problem.x = ReadPositions(begin);
  problem.v = ReadVelocities(begin);
  problem.duration = 1;
  problem.touches = !played.equations.obstacles.empty();
  return problem;
}

std::size_t CountMet(const std::vector<double>& errors, double target) {
  return static_cast<std::size_t>(std::count_if(errors.begin(), errors.end(), [&](double e) { return e <= target; }));
}

// The least fixed number of substeps that meets the target in as many seconds as the play did. Bisects, because the
// error decreases with the number apart from chance.
int FindCheapestFixed(const Trial& trial, const std::vector<Problem>& problems,
                      const std::vector<std::vector<Vector3d>>& ends) {
  const std::size_t met = CountMet(trial.errors, trial.target);
  const auto suffices = [&](int substeps) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < problems.size(); ++i) {
      const SolvedMotion solved = SolveInSteps(problems[i], {.steps = kTicksASecond * substeps, .isSingle = true});
      errors.push_back(solved.blewUp ? HUGE_VAL : FindDistance(solved.end.x, ends[i]));
    }
    return CountMet(errors, trial.target) >= met;
  };
  int most = 1;
  while (most < kMaxSubsteps && !suffices(most)) most *= 2;
  if (most == kMaxSubsteps && !suffices(most)) return 0;
  int least = most / 2;  // insufficient
  while (most - least > 1) {
    const int middle = (least + most) / 2;
    (suffices(middle) ? most : least) = middle;
  }
  return most;
}

// Ratio of the final to the initial distance of two motions.
double FindGrowth(Problem problem, const std::vector<Vector3d>& end) {
  const std::vector<Vector3d> begin = problem.x;
  for (std::size_t i = 0; i < begin.size(); ++i) {
    const auto phase = static_cast<double>(i);
    if (problem.blueprint->full.inverseMasses[i] == 0) continue;
    problem.x[i].x() += kTwinOffset * std::sin(1.3 * phase);
    problem.x[i].z() += kTwinOffset * std::cos(2.1 * phase);
  }
  return FindDistance(SolveByCvode(problem, kTolerance).motion.x, end) / FindDistance(begin, problem.x);
}

void Run(Trial& trial, int seconds) {
  std::vector<Problem> problems;
  std::vector<std::vector<Vector3d>> ends;
  for (const PlayedSecond& second : PlayAsServer(*trial.played, trial.target, seconds)) {
    problems.push_back(MakeProblemOfSecond(*trial.played, second.begin));
    ends.push_back(SolveByCvode(problems.back(), kTolerance).motion.x);
    trial.errors.push_back(FindDistance(ReadPositions(second.end), ends.back()));
    trial.rounding.push_back(FindDistance(ReadPositions(second.end), ReadPositions(second.endInDouble)));
    trial.asleep += second.asleep ? 1 : 0;
    trial.substeps += static_cast<double>(second.substeps) / (kTicksASecond * seconds);
    if (trial.isGrowthMeasured) trial.growth = std::max(trial.growth, FindGrowth(problems.back(), ends.back()));
  }
  if (trial.isCompared) trial.fixedSubsteps = FindCheapestFixed(trial, problems, ends);
}

double FindNearestQuantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

// Where no fixed number suffices, relative to the largest number: an upper bound.
double FindOverhead(const Trial& trial) {
  return trial.substeps / (trial.fixedSubsteps > 0 ? trial.fixedSubsteps : kMaxSubsteps);
}

void AddTargetRows(const std::vector<Trial>& trials, Results& results) {
  for (const Trial& trial : trials) {
    nlohmann::ordered_json row = {
        {"experiment", "error_target"},
        {"case", trial.played->name},
        {"target", trial.target},
        {"met", CountMet(trial.errors, trial.target)},
        {"seconds", trial.errors.size()},
        {"error_median", FindNearestQuantile(trial.errors, 0.5)},
        {"error_most", FindNearestQuantile(trial.errors, 1)},
        {"rounding_median", FindNearestQuantile(trial.rounding, 0.5)},
        {"seconds_asleep", trial.asleep},
        {"evaluations_a_second", trial.substeps * kTicksASecond * kEvaluationsAStep},
    };
    if (trial.isGrowthMeasured) row["growth_most"] = trial.growth;
    if (trial.isCompared) {
      row["fixed_substeps"] = trial.fixedSubsteps;
      row["overhead"] = FindOverhead(trial);
    }
    results.rows.push_back(std::move(row));
  }
}

void AddFigures(const std::vector<Trial>& trials, Results& results) {
  std::size_t met = 0, seconds = 0;
  double overheads = 0, worst = 0;
  int compared = 0;
  for (const Trial& trial : trials) {
    if (!trial.isCompared) continue;
    met += CountMet(trial.errors, trial.target);
    seconds += trial.errors.size();
    overheads += FindOverhead(trial);
    worst = std::max(worst, FindOverhead(trial));
    ++compared;
  }
  results.AddFigureAtLeast("error_target_met", static_cast<double>(met) / static_cast<double>(seconds), 0.95);
  results.AddFigureAtMost("error_target_overhead", overheads / compared, 1.3);
  results.AddFigure("error_target_overhead_worst", worst);
}

void AddPlot(const std::vector<double>& targets, const std::vector<Trial>& trials, Results& results) {
  Plot plot{.name = "accuracy_error_target",
            .title = "Bodies as the server plays them keep to the error that is allowed",
            .xLabel = "error target, mm a second",
            .yLabel = "error after a second, mm",
            .series = {{"error = target", Stroke::kDashed, {}},
                       {"95 % of body-seconds are below", Stroke::kLineAndPoints, {}},
                       {"half of body-seconds are below", Stroke::kLineAndPoints, {}}},
            .logX = true,
            .logY = true};
  for (const double target : targets) {
    std::vector<double> errors;
    for (const Trial& trial : trials) {
      if (trial.target != target || !trial.played->isWellPosed) continue;
      errors.insert(errors.end(), trial.errors.begin(), trial.errors.end());
    }
    plot.series[0].points.push_back({1000 * target, 1000 * target});
    plot.series[1].points.push_back({1000 * target, 1000 * FindNearestQuantile(errors, 0.95)});
    plot.series[2].points.push_back({1000 * target, 1000 * FindNearestQuantile(errors, 0.5)});
  }
  results.plots.push_back(std::move(plot));
}

void AddRemarks(const std::vector<Trial>& trials, Results& results) {
  for (const Trial& trial : trials) {
    if (trial.played->isWellPosed || !trial.isGrowthMeasured) continue;
    char text[200];
    std::snprintf(
        text, sizeof text,
        "%s: counts in no figure, since motions that begin 10 nm apart are up to %.0f times as far apart after"
        " a second",
        trial.played->name.c_str(), trial.growth);
    results.remarks.push_back(text);
  }
}

}  // namespace

void MeasureErrorTargets(Bench& bench) {
  const bool quick = bench.options.quick;
  const std::vector<PlayedCase> cases = MakePlayedCases(quick);
  std::vector<double> targets{1e-4, 1e-3, 1e-2};
  if (!quick) targets = {3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2};
  std::vector<Trial> trials;
  for (const double target : targets) {
    for (const PlayedCase& played : cases) {
      if (!played.isWellPosed && target != 1e-3) continue;
      trials.emplace_back();
      trials.back().played = &played;
      trials.back().target = target;
      trials.back().isCompared = played.isWellPosed && (target == 1e-4 || target == 1e-3 || target == 1e-2);
      trials.back().isGrowthMeasured = !quick && target == 1e-3;
    }
  }
  const int seconds = quick ? 3 : 5;
  if (!RunTrials(bench, trials.size(), [&](std::size_t i) { Run(trials[i], seconds); })) return;
  AddTargetRows(trials, bench.results);
  AddFigures(trials, bench.results);
  AddPlot(targets, trials, bench.results);
  AddRemarks(trials, bench.results);
}

}  // namespace wobble::bench
