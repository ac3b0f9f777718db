// The energy drift of each method on a system without dissipation. A ball stretched by 20 % vibrates for ten seconds
// without damping, each method at 120 steps a second. The vertex positions are then unpredictable (problem.h), but the
// energy must be conserved. The plot shows the energy above that of rest over its initial value.
//
// RK4 is stable but not exact: rows give the energy that it keeps at 60 to 480 steps a second, on that ball and on one
// stretched by 2 %. The prototype of this engine lost 92, 69, 11 and 0.4 % on a ball of the same stiffness that
// vibrated in faster modes; a mode's loss is proportional to the sixth power of its frequency and the fifth of the
// step, so these numbers differ, but fall alike.
#include <algorithm>
#include <cmath>

#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kDuration = 10;  // s
constexpr int kRate = 120;        // steps a second
constexpr double kMost = 1.5;     // upper limit of the plot

constexpr std::array kLossRates = {60, 120, 240, 480};

struct EnergyCase {
  const Problem* ball = nullptr;
  Integrator integrator = Integrator::kRungeKutta4;
  int rate = kRate;
  bool isDrawn = false;
  bool blewUp = false;
  std::vector<std::array<double, 2>> energies{};  // s, over the initial energy
};

std::vector<EnergyCase> MakeEnergyCases(const Problem& slight, const Problem& wide) {
  std::vector<EnergyCase> cases;
  for (const Integrator integrator : kIntegrators) {
    cases.push_back({.ball = &wide, .integrator = integrator, .isDrawn = true});
  }
  for (const Problem* ball : {&slight, &wide}) {
    for (const int rate : kLossRates) {
      if (ball != &wide || rate != kRate) cases.push_back({.ball = ball, .rate = rate});
    }
  }
  return cases;
}

void PlayEnergyCase(EnergyCase& each) {
  const Problem& ball = *each.ball;
  SolvedMotion solved = SolveInSteps(
      ball, {.integrator = each.integrator, .steps = std::lround(each.rate * ball.duration), .isSampled = true});
  const std::vector<Vector3d> still(ball.x.size(), Vector3d::Zero());
  const double rest = FindEnergy(ball.equations, ball.blueprint->rest, still);
  const double before = solved.energies.front()[1] - rest;
  for (const auto& [time, energy] : solved.energies) each.energies.push_back({time, (energy - rest) / before});
  each.blewUp = solved.blewUp;
}

void AddEnergyRow(Bench& bench, const EnergyCase& each) {
  double least = each.energies.front()[1];
  double most = least;
  for (const auto& [time, energy] : each.energies) {
    least = std::min(least, energy);
    most = std::max(most, energy);
  }
  bench.results.rows.push_back({{"experiment", "energy"},
                                {"problem", each.ball->name},
                                {"integrator", FindName(each.integrator)},
                                {"steps_per_s", each.rate},
                                {"blew_up", each.blewUp},
                                {"least", least},
                                {"most", most},
                                {"end", each.energies.back()[1]}});
}

}  // namespace

void MeasureEnergies(Bench& bench) {
  const std::vector<Problem> problems = MakeProblems();
  const Problem& slight = *std::find_if(problems.begin(), problems.end(), [](const Problem& problem) {
    return problem.isConservative && problem.duration == kDuration && problem.blueprint->full.gas > 0;
  });
  Problem wide = MakeStretchedBall();
  wide.name = "ball, 20 % stretch, 10 s";
  wide.duration = kDuration;
  std::vector<EnergyCase> cases = MakeEnergyCases(slight, wide);
  if (!RunTrials(bench, cases.size(), [&](std::size_t i) { PlayEnergyCase(cases[i]); })) return;
  Plot plot{.name = "accuracy_energy",
            .title = "Energy of a ball that nothing damps, in 120 steps a second",
            .xLabel = "time, s",
            .yLabel = "energy over that of the beginning"};
  for (const EnergyCase& each : cases) {
    AddEnergyRow(bench, each);
    if (!each.isDrawn) continue;
    Series& series = plot.series.emplace_back();
    series.name = FindTitle(each.integrator);
    for (const auto& point : each.energies) {
      if (point[1] < kMost) series.points.push_back(point);
    }
  }
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace wobble::bench
