// Thousands of random worlds, ten seconds each, in the server's own stepping: single precision, its error target,
// sleep, contact, several bodies. No body may become non-finite, be inside out for two seconds, put back or
// stepped again. Any finding is a fault of the engine and is fixed there; the number of a trial reproduces it.
//
// Penetration is measured independently of the engine (insides.h): the greatest depth of a vertex of a body under a
// static surface or inside a closed body, relative to the body's size, for every body every third of a second. Deeper
// penetration between these moments is missed; one measurement takes as long as several ticks.
#include <algorithm>
#include <cmath>

#include "server/physics/methods/health.h"
#include "server/physics/methods/stability.h"
#include "tests/bench/contact/insides.h"
#include "tests/bench/stability/experiments.h"
#include "tests/bench/stability/random_world.h"
#include "tests/bench/stability/trial_recording.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kTicksBetweenLooks = 20;
constexpr std::size_t kTrials = 10000;
constexpr std::size_t kQuickTrials = 60;
constexpr std::size_t kMostRecorded = 20;  // of the trials that fail
constexpr int kTicksBehind = 120;          // that a recording goes on behind the failure

struct RandomTrial {
  std::string place;
  std::string stiffestBody;
  std::size_t bodies = 0;
  double stiffness = 0;  // substeps that the stiffest body needs by itself
  int refused = 0;
  std::uint64_t substeps = 0;
  std::uint64_t awake = 0;  // body-ticks
  std::uint32_t nonFinite = 0;
  std::uint32_t inverted = 0;  // bodies that were inside out for two seconds
  std::uint32_t reset = 0;
  std::uint32_t quarantined = 0;
  int failedTick = 0;  // the first, from 1; 0: none
  std::string failedBody;
  const char* failure = "";
  std::vector<float> depths;  // per body and measurement, relative to its size
  TrialRecording recording;
};

void DescribeWorld(const RandomWorld& random, RandomTrial& trial) {
  trial.place = random.Place();
  trial.bodies = random.Engine().Bodies().size();
  trial.refused = random.Refused();
  std::uint8_t place = 0;
  for (const Blueprint& blueprint : random.Engine().Blueprints()) {
    const double rate = std::max(blueprint.angularFrequency, blueprint.dampingRate);
    const double needed = rate * random.Engine().Settings().tickDuration / kStabilityLimit;
    if (needed > trial.stiffness) {
      trial.stiffness = needed;
      trial.stiffestBody = random.Describe(place);
    }
    ++place;
  }
}

void Note(const StepReport& report, const RandomWorld& random, RandomTrial& trial) {
  trial.substeps += report.substeps;
  trial.awake += report.awake;
  trial.nonFinite += report.nonFinite;
  const auto invertedTicks = std::lround(kInvertedTime / random.Engine().Settings().tickDuration);
  for (const Body& body : random.Engine().Bodies()) trial.inverted += body.invertedTicks == invertedTicks ? 1 : 0;
  trial.quarantined += report.quarantined;
  trial.reset += report.reset;
  if (report.quarantined == 0 || trial.failedTick > 0) return;
  trial.failedTick = static_cast<int>(random.Engine().Tick());
  trial.failedBody = random.Describe(random.Engine().ReadBody(report.firstQuarantined).blueprint);
  trial.failure = report.nonFinite > 0 ? "not finite" : report.reset > 0 ? "reset" : "energy from nowhere";
}

RandomTrial PlayTrial(const Options& options, std::uint32_t number) {
  RandomWorld random(options.seed, number);
  RandomTrial trial;
  DescribeWorld(random, trial);
  bool moved = true;
  for (int tick = 1; tick <= kRandomTicks; ++tick) {
    random.Act();
    const StepReport report = random.Engine().Step();
    Note(report, random, trial);
    moved = moved || report.awake > 0;
    // A sleeping world is measured once.
    if (tick % kTicksBetweenLooks != 0 || !moved) continue;
    const std::vector<float> depths = ListDepths(random.Engine());
    trial.depths.insert(trial.depths.end(), depths.begin(), depths.end());
    moved = false;
    const auto isTooDeep = [&](float depth) { return options.depth && double{depth} > *options.depth; };
    const auto deep = std::ranges::find_if(depths, isTooDeep);
    if (trial.failedTick > 0 || deep == depths.end()) continue;
    trial.failedTick = tick;
    const auto place = static_cast<std::size_t>(deep - depths.begin());
    trial.failedBody = random.Describe(random.Engine().Bodies()[place].blueprint);
    trial.failure = "too deep";
  }
  return trial;
}

float FindDeepest(const RandomTrial& trial) {
  return trial.depths.empty() ? 0 : *std::max_element(trial.depths.begin(), trial.depths.end());
}

// The 99.9th percentile; 0 without values.
double FindP999(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

nlohmann::ordered_json MakeRow(std::size_t number, const RandomTrial& trial) {
  return {{"experiment", "random_trial"},
          {"trial", number},
          {"place", trial.place},
          {"bodies", trial.bodies},
          {"stiffest_body", trial.stiffestBody},
          {"substeps_by_itself", trial.stiffness},
          {"body_ticks", trial.awake},
          {"substeps", trial.substeps},
          {"depth", FindDeepest(trial)},
          {"non_finite", trial.nonFinite},
          {"inverted_after_2s", trial.inverted},
          {"quarantined", trial.quarantined},
          {"reset", trial.reset},
          {"failed_tick", trial.failedTick},
          {"failed_body", trial.failedBody},
          {"recording", trial.recording.file.string()}};
}

void Record(const Options& options, std::uint32_t number, RandomTrial& trial) {
  const int ticks = trial.failedTick > 0 ? std::min(kRandomTicks, trial.failedTick + kTicksBehind) : kRandomTicks;
  trial.recording =
      RecordTrial(options.seed, number, ticks, options.recordings.empty() ? kRecordings : options.recordings);
}

std::string DescribeRecording(const TrialRecording& recording) {
  if (recording.file.empty()) return recording.fault.empty() ? "" : "; not recorded: " + recording.fault;
  const std::string line = "; wobble watch " + recording.file.string();
  return recording.fault.empty() ? line : line + " (" + recording.fault + ")";
}

std::string DescribeTrial(std::uint64_t seed, std::size_t number, const RandomTrial& trial) {
  char line[512];
  std::snprintf(line, sizeof line, "stability --trial %zu --seed %llu: ", number,
                static_cast<unsigned long long>(seed));
  const std::string start(line);
  if (trial.failedTick == 0) {
    std::snprintf(line, sizeof line, "%zu bodies, %s, all well; the stiffest a %s; deepest %.3f of its size",
                  trial.bodies, trial.place.c_str(), trial.stiffestBody.c_str(),
                  static_cast<double>(FindDeepest(trial)));
  } else {
    std::snprintf(line, sizeof line, "%zu bodies, %s, %s at tick %d: %s", trial.bodies, trial.place.c_str(),
                  trial.failure, trial.failedTick, trial.failedBody.c_str());
  }
  return start + line + DescribeRecording(trial.recording);
}

// Adds the findings by the stiffness of the stiffest body: one row per decade.
void AddRows(const std::vector<RandomTrial>& trials, Results& results) {
  constexpr double kDecade = 3.1622776601683795;  // of the stiffness: √10 in the frequency, and so in the substeps
  for (double low = 1e-3; low < kMaxSubsteps; low *= kDecade) {
    std::size_t count = 0;
    std::size_t failed = 0;
    double substeps = 0;
    double awake = 0;
    std::vector<float> depths;
    for (const RandomTrial& trial : trials) {
      if (trial.stiffness < low || trial.stiffness >= low * kDecade) continue;
      ++count;
      failed += trial.failedTick > 0 ? 1 : 0;
      substeps += static_cast<double>(trial.substeps);
      awake += static_cast<double>(trial.awake);
      depths.insert(depths.end(), trial.depths.begin(), trial.depths.end());
    }
    if (count == 0) continue;
    results.rows.push_back({{"experiment", "random_trials"},
                            {"substeps_by_itself_from", low},
                            {"to", low * kDecade},
                            {"trials", count},
                            {"failed", failed},
                            {"mean_substeps", awake > 0 ? substeps / awake : 0},
                            {"penetration_p999", FindP999(std::move(depths))}});
  }
}

Plot MakePlot(const std::vector<RandomTrial>& trials) {
  constexpr std::size_t kMostPoints = 1500;
  constexpr double kLeastDepth = 1e-5;  // the logarithmic axis cannot show 0
  Plot plot{.name = "stability_trials",
            .title = "Random trials: the deepest vertex of each",
            .xLabel = "substeps that the stiffest body needs by itself",
            .yLabel = "deepest penetration, share of the body's size"};
  plot.logX = true;
  plot.logY = true;
  Series good{"well", Stroke::kPoints, {}};
  Series failed{"failed", Stroke::kPoints, {}};
  const std::size_t stride = trials.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const bool bad = trials[i].failedTick > 0;
    if (!bad && i % stride != 0) continue;
    (bad ? failed : good)
        .points.push_back({trials[i].stiffness, std::max(kLeastDepth, static_cast<double>(FindDeepest(trials[i])))});
  }
  plot.series.push_back(std::move(good));
  if (!failed.points.empty()) plot.series.push_back(std::move(failed));
  return plot;
}

struct Sums {
  double trials = 0;
  double failed = 0;
  double nonFinite = 0;
  double inverted = 0;
  double quarantined = 0;
  double reset = 0;
  double bodies = 0;
  double refused = 0;
  std::vector<float> depths;
};

Sums AddUp(const std::vector<RandomTrial>& trials) {
  Sums sums;
  for (const RandomTrial& trial : trials) {
    ++sums.trials;
    sums.failed += trial.failedTick > 0 ? 1 : 0;
    sums.nonFinite += trial.nonFinite;
    sums.inverted += trial.inverted;
    sums.quarantined += trial.quarantined;
    sums.reset += trial.reset;
    sums.bodies += static_cast<double>(trial.bodies);
    sums.refused += trial.refused;
    sums.depths.insert(sums.depths.end(), trial.depths.begin(), trial.depths.end());
  }
  return sums;
}

void ReplayOne(Bench& bench) {
  const std::uint32_t number = *bench.options.trial;
  RandomTrial trial = PlayTrial(bench.options, number);
  if (trial.failedTick > 0 || !bench.options.recordings.empty()) Record(bench.options, number, trial);
  bench.results.rows.push_back(MakeRow(number, trial));
  bench.results.remarks.push_back(DescribeTrial(bench.options.seed, number, trial));
  bench.results.AddFigureAtMost("reset", trial.reset, 0);
  bench.results.AddFigureAtMost("quarantined", trial.quarantined, 0);
}

}  // namespace

void MeasureRandomTrials(Bench& bench) {
  if (bench.options.trial) return ReplayOne(bench);
  std::vector<RandomTrial> trials(bench.options.quick ? kQuickTrials : kTrials);
  const bool done = RunTrials(bench, trials.size(), [&](std::size_t i) {
    trials[i] = PlayTrial(bench.options, static_cast<std::uint32_t>(i));
  });
  if (!done) return;
  Results& results = bench.results;
  std::size_t recorded = 0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (trials[i].failedTick == 0) continue;
    if (recorded++ < kMostRecorded) Record(bench.options, static_cast<std::uint32_t>(i), trials[i]);
    results.rows.push_back(MakeRow(i, trials[i]));
    results.remarks.push_back(DescribeTrial(bench.options.seed, i, trials[i]));
  }
  AddRows(trials, results);
  Sums sums = AddUp(trials);
  results.rows.push_back(
      {{"experiment", "random_trial_materials"}, {"bodies", sums.bodies}, {"refused", sums.refused}});
  results.AddFigure("random_trials", sums.trials);
  results.AddFigureAtMost("non_finite", sums.nonFinite, 0);
  results.AddFigureAtMost("inverted_after_2s", sums.inverted, 0);
  results.AddFigureAtMost("reset", sums.reset, 0);
  results.AddFigureAtMost("quarantined", sums.quarantined, 0);
  results.AddFigure("failed_trials", sums.failed);
  results.AddFigure("penetration_p999", FindP999(std::move(sums.depths)));
  results.plots.push_back(MakePlot(trials));
}

}  // namespace wobble::bench
