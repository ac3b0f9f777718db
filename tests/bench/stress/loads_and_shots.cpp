// What players do to bodies and no bound forbids: crush, spin, stretch, bag, cut, let the heavy fall on the light, and
// throw at 100 m/s; stacks are in stacks.cpp. Counted is what no player should see: bodies that are not finite, put
// back, inside out two seconds after the load has gone, or behind what they were thrown at.
#include <algorithm>
#include <vector>

#include "tests/bench/stress/experiments.h"
#include "tests/bench/stress/loads.h"
#include "tests/bench/stress/rows.h"
#include "tests/bench/stress/shots.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

constexpr std::size_t kStressShots = 1000;
constexpr std::size_t kStressShotsQuick = 30;

struct LoadTrial {
  StressLoad load = StressLoad::kCrush;
  StressBody body = StressBody::kBall162;
  std::uint64_t seed = 0;
  StressOutcome outcome;
};

// Bags are large: a tenth of the seeds.
std::vector<LoadTrial> ListLoadTrials(const Options& options) {
  std::vector<LoadTrial> trials;
  for (const StressLoad load : kAllStressLoads) {
    const std::uint64_t seeds = options.quick ? 1 : load == StressLoad::kBag ? 2 : 20;
    for (const StressBody body : kAllStressBodies) {
      if (!IsLoadFor(load, body) || (options.quick && !IsQuick(load, body))) continue;
      for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        trials.push_back({load, body, options.seed * 1000003 + seed, {}});
      }
    }
  }
  return trials;
}

struct Sum {
  StressOutcome outcome;
  double count = 0;
};

// Of those trials, or shots, for which isOfIt(trial) holds.
template <class Trial, class IsOfIt>
Sum AddUp(const std::vector<Trial>& trials, const IsOfIt& isOfIt) {
  Sum sum;
  for (const Trial& trial : trials) {
    if (!isOfIt(trial)) continue;
    Add(trial.outcome, sum.outcome);
    ++sum.count;
  }
  return sum;
}

// A row for each load and kind of body; the sum of all.
StressOutcome AddLoadRows(const std::vector<LoadTrial>& trials, Results& results) {
  StressOutcome whole;
  for (const StressLoad load : kAllStressLoads) {
    for (const StressBody body : kAllStressBodies) {
      const auto [sum, count] =
          AddUp(trials, [&](const LoadTrial& trial) { return trial.load == load && trial.body == body; });
      if (count == 0) continue;
      Add(sum, whole);
      results.rows.push_back(MakeStressRow("stress", NameStressLoad(load), NameStressBody(body), count, sum));
    }
  }
  return whole;
}

StressOutcome AddShotRows(const std::vector<StressShot>& shots, Results& results) {
  StressOutcome whole;
  for (const StressTarget target : kAllStressTargets) {
    for (const StressBody body : kAllStressBodies) {
      const auto isOfIt = [&](const StressShot& shot) { return shot.target == target && shot.body == body; };
      const auto [sum, count] = AddUp(shots, isOfIt);
      if (count == 0) continue;
      Add(sum, whole);
      results.rows.push_back(MakeStressRow("stress_shots", NameStressTarget(target), NameStressBody(body), count, sum));
      results.rows.back()["hangs"] = static_cast<double>(
          std::ranges::count_if(shots, [&](const StressShot& shot) { return isOfIt(shot) && shot.hangs; }));
    }
  }
  return whole;
}

void DescribeShots(const std::vector<StressShot>& shots, Results& results) {
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const StressShot& shot = shots[i];
    if (!shot.through && shot.outcome.nonFinite + shot.outcome.reset == 0) continue;
    results.rows.push_back({{"experiment", "stress_shot"},
                            {"number", i},
                            {"target", NameStressTarget(shot.target)},
                            {"body", NameStressBody(shot.body)},
                            {"other", shot.target == StressTarget::kBody ? NameStressBody(shot.other) : ""},
                            {"speed", shot.speed},
                            {"behind", shot.behind},
                            {"through", shot.through},
                            {"reset", shot.outcome.reset}});
  }
}

// Held in quick runs is what holds today; the full run has the limits that are asked for.
void AddStressFigures(const std::vector<StressShot>& shots, const StressOutcome& ofLoads, const StressOutcome& ofShots,
                      bool quick, Results& results) {
  const auto countThrough = [&](StressTarget target) {
    return static_cast<double>(
        std::ranges::count_if(shots, [&](const StressShot& shot) { return shot.through && shot.target == target; }));
  };
  const auto hang = std::ranges::count_if(shots, [](const StressShot& shot) { return shot.hangs; });
  StressOutcome sum = ofLoads;
  Add(ofShots, sum);
  results.AddFigure("shots", static_cast<double>(shots.size()));
  results.AddFigureAtMost("shots_through", ofShots.through, 0, !quick);
  results.AddFigureAtMost("shots_through_ground",
                          countThrough(StressTarget::kFloor) + countThrough(StressTarget::kTerrain), 0);
  results.AddFigure("shots_through_walls", countThrough(StressTarget::kWall));
  results.AddFigureAtMost("shots_through_bodies", countThrough(StressTarget::kBody), 0);
  results.AddFigure("shots_through_sheets", countThrough(StressTarget::kSheet));
  results.AddFigure("shots_hanging", static_cast<double>(hang));
  results.AddFigureAtMost("fallen_through", ofLoads.through, 0, !quick);
  results.AddFigureAtMost("stress_non_finite", sum.nonFinite, 0);
  results.AddFigureAtMost("stress_reset", sum.reset, 0);
  results.AddFigureAtMost("stress_inverted_after_2s", sum.inverted, 0);
  results.AddFigureAtMost("stress_folded_lattices", sum.folded, 0, !quick);
  results.AddFigureAtMost("stress_quarantined", sum.quarantined, 0, !quick);
}

}  // namespace

void MeasureStress(Bench& bench) {
  std::vector<LoadTrial> trials = ListLoadTrials(bench.options);
  std::vector<StressShot> shots(bench.options.quick ? kStressShotsQuick : kStressShots);
  const bool quick = bench.options.quick;
  const std::uint64_t seed = bench.options.seed;
  // The large ones first, so that no core ends with one.
  const bool done = RunTrials(bench, trials.size() + shots.size(), [&](std::size_t i) {
    if (i < trials.size()) {
      LoadTrial& trial = trials[trials.size() - 1 - i];
      trial.outcome = PlayLoad(trial.load, trial.body, trial.seed, quick);
    } else {
      shots[i - trials.size()] = PlayStressShot(seed, i - trials.size());
    }
  });
  if (!done) return;
  Results& results = bench.results;
  results.AddFigure("stress_trials", static_cast<double>(trials.size()));
  const StressOutcome ofLoads = AddLoadRows(trials, results);
  const StressOutcome ofShots = AddShotRows(shots, results);
  DescribeShots(shots, results);
  AddStressFigures(shots, ofLoads, ofShots, quick, results);
}

}  // namespace wobble::bench
