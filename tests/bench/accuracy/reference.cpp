// Checks that the engine and the reference solve the same equations. They share only the numbers of a blueprint: the
// forces are implemented twice, and the solver is RK4 on one side and CVODE on the other. Once both have converged they
// must agree; the uncertainty is the difference between two tolerances of CVODE.
//
// It also shows why the problems are chosen as they are: solutions at two tolerances are followed side by side. In a
// well-posed problem they stay together; on a ball many of whose springs go slack they diverge.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>

#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/accuracy/problem.h"
#include "tests/bench/thread_time.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

constexpr double kLooserTolerance = 10 * kReferenceTolerance;

// Lengths are shares of the body's size.
struct Comparison {
  std::int64_t steps = 0;  // of the engine
  double distance = 0;     // between the ends of engine and reference
  double uncertainty = 0;  // between two tolerances of the reference; NaN: not measured
  double energyGain = 0;   // of the reference, J
  double time = 0;         // of the reference, s
  long referenceSteps = 0;
  long evaluations = 0;
};

double FindShare(const Problem& problem, const Motion& a, const Motion& b) {
  return FindDistance(a.x, b.x) / problem.blueprint->size;
}

// The number of steps that ends within 1e-10 by RK4's order, extrapolated from a solution with 40 steps per period of
// the fastest mode. A contact that begins in the middle of a step breaks that order, because the contact force has a
// kink in its slope; hence the factor.
std::int64_t FindFineSteps(const Problem& problem, const Motion& reference) {
  constexpr double kWithin = 1e-10;
  const double more = problem.touches ? 8 : 1;
  const double turns = problem.duration * problem.blueprint->angularFrequency / (2 * std::numbers::pi);
  const double steps = std::ceil(40 * turns);
  const Motion coarse = SolveInSteps(problem, {.steps = static_cast<std::int64_t>(steps)}).end;
  const double ratio = FindShare(problem, coarse, reference) / kWithin;
  return static_cast<std::int64_t>(more * steps * std::ceil(std::pow(std::max(ratio, 1.0), 0.25)));
}

Comparison Compare(const Problem& problem, bool quick) {
  const double began = ReadThreadTime();
  const Solution reference = SolveByCvode(problem, kReferenceTolerance);
  Comparison compared;
  compared.time = ReadThreadTime() - began;
  compared.energyGain = FindEnergy(problem.equations, reference.motion.x, reference.motion.v) -
                        FindEnergy(problem.equations, problem.x, problem.v);
  compared.referenceSteps = reference.steps;
  compared.evaluations = reference.evaluations;
  compared.steps = FindFineSteps(problem, reference.motion);
  compared.distance = FindShare(problem, SolveInSteps(problem, {.steps = compared.steps}).end, reference.motion);
  compared.uncertainty =
      quick ? NAN : FindShare(problem, SolveByCvode(problem, kLooserTolerance).motion, reference.motion);
  return compared;
}

// The divergence of two solutions, one at each tolerance.
struct Parting {
  std::vector<std::array<double, 2>> distances;  // s, share of the body's size
  std::size_t mostSlack = 0;  // greatest number of springs shorter than their rest length at one time
};

void GoOn(Problem& problem, double tolerance) {
  Motion motion = SolveByCvode(problem, tolerance).motion;
  problem.x = std::move(motion.x);
  problem.v = std::move(motion.v);
}

std::size_t CountSlackSprings(const Problem& problem) {
  const auto& springs = problem.blueprint->full.springs;
  return static_cast<std::size_t>(std::ranges::count_if(springs, [&](const physics::Spring<double>& spring) {
    return (problem.x[spring.a] - problem.x[spring.b]).norm() < spring.restLength;
  }));
}

Parting FollowApart(Problem one) {
  constexpr int kParts = 100;
  one.duration /= kParts;
  Problem other = one;
  Parting parting;
  for (int i = 1; i <= kParts; ++i) {
    GoOn(one, kReferenceTolerance);
    GoOn(other, kLooserTolerance);
    parting.distances.push_back({i * one.duration, FindDistance(one.x, other.x) / one.blueprint->size});
    parting.mostSlack = std::max(parting.mostSlack, CountSlackSprings(one));
  }
  return parting;
}

// The longest first, so that no thread starts it when the others have finished.
std::vector<std::size_t> SortByWork(const std::vector<Problem>& problems) {
  const auto findWork = [](const Problem& problem) {
    return problem.duration * problem.blueprint->angularFrequency * static_cast<double>(problem.x.size());
  };
  std::vector<std::size_t> order(problems.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater<>{}, [&](std::size_t i) { return findWork(problems[i]); });
  return order;
}

void CompareAll(Bench& bench) {
  const std::vector<Problem> problems = MakeProblems();
  const std::vector<std::size_t> order = SortByWork(problems);
  std::vector<Comparison> found(problems.size());
  const bool done = RunTrials(bench, problems.size(), [&](std::size_t i) {
    found[order[i]] = Compare(problems[order[i]], bench.options.quick);
  });
  if (!done) return;
  double worst = 0;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Comparison& each = found[i];
    worst = std::isfinite(each.distance) ? std::max(worst, each.distance) : each.distance;
    nlohmann::ordered_json row{{"experiment", "reference"},
                               {"problem", problems[i].name},
                               {"vertices", problems[i].x.size()},
                               {"steps", each.steps},
                               {"distance", each.distance},
                               {"cvode_steps", each.referenceSteps},
                               {"cvode_evaluations", each.evaluations},
                               {"cvode_time", each.time}};
    if (problems[i].isConservative) row["cvode_energy_gain"] = each.energyGain;
    if (!bench.options.quick) row["cvode_uncertainty"] = each.uncertainty;
    bench.results.rows.push_back(row);
  }
  bench.results.AddFigureAtMost("reference_agreement", worst, 1e-9);
}

void ShowWhatIsWellPosed(Bench& bench) {
  const std::vector<Problem> problems = MakeProblems();
  const std::vector<Problem> balls{MakeIllPosedBall(), MakeUndampedBall(), problems[1], problems[2]};
  std::vector<Parting> partings(balls.size());
  if (!RunTrials(bench, balls.size(), [&](std::size_t i) { partings[i] = FollowApart(balls[i]); })) return;
  Plot plot{.name = "accuracy_well_posed",
            .title = "How far two references part, of tolerance 1e-11 and 1e-12",
            .xLabel = "time, s",
            .yLabel = "RMS distance over the body's size"};
  plot.logY = true;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    bench.results.rows.push_back({{"experiment", "two references"},
                                  {"problem", balls[i].name},
                                  {"distance", partings[i].distances.back()[1]},
                                  {"springs", balls[i].blueprint->full.springs.size()},
                                  {"most_slack_springs", partings[i].mostSlack}});
    plot.series.push_back({balls[i].name, Stroke::kLine, partings[i].distances});
  }
  bench.results.plots.push_back(plot);
  char remark[400];
  std::snprintf(
      remark, sizeof remark,
      "A ball stretched by 20 %% for 10 s without damping is no problem to measure errors by: with 250 J of gas, "
      "which leaves up to %zu of its springs slack at once, two references end %.0f %% of its size apart; with "
      "1000 J and %zu slack, %.1g %%.",
      partings[0].mostSlack, 100 * partings[0].distances.back()[1], partings[1].mostSlack,
      100 * partings[1].distances.back()[1]);
  bench.results.remarks.emplace_back(remark);
}

}  // namespace

void MeasureReference(Bench& bench) {
  CompareAll(bench);
  if (!bench.options.quick && !bench.progress.IsStopAsked()) ShowWhatIsWellPosed(bench);
}

}  // namespace wobble::bench
