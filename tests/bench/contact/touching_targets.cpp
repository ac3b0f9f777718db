// Checks that bodies that touch obstacles and one another keep to the error target, as accuracy/error_targets.cpp does
// for bodies whose equations CVODE can solve. Bodies are played as the server plays them: single precision, the
// engine's own choice of substeps, sleep. At the end of every second each is compared with a reference that began that
// second in the same state, contacts and what they remember included. A body-second counts when the body touched
// anything in it, as played or in the reference; none is left out.
//
// The reference is a twin of the world in double precision with 256 substeps a tick, kept awake. It has the server's
// tick, and so it does once a tick what the server does once a tick: the search for contacts, losses in gas and in
// rolling, a step of the control. Two columns tell how far it can be trusted (not with --quick): `change` is the
// largest distance to the same with half as many substeps, `growth` the largest factor by which two motions diverge
// over a second when one begins 10⁻⁸ m aside.
//
// A cloth that falls over a ball misses the target half of the time, the ball under it never. It has a figure of its
// own, error_target_met_cloth_over_ball, without a limit, and no part in error_target_met_in_contact.
//
// `ratio` is the true error of a body-second over the sum of the errors that were estimated for its ticks.
#include <algorithm>
#include <cmath>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/contact/touching.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kTicksInASecond = 60;
constexpr int kReferenceSubsteps = 256;
constexpr double kShippedTarget = 1e-3;  // of all shipped scenes, m/s
constexpr double kAnyError = 1e9;        // m/s
constexpr double kShift = 1e-8;          // m

struct TouchingTrial {
  const TouchingCase* touching = nullptr;
  double target = 0;             // m/s
  std::vector<double> errors{};  // of body-seconds in contact, m
  std::vector<double> ratios{};  // of the same
  double substeps = 0;           // per body and tick, mean
  double change = 0;             // m
  double growth = 0;
};

// A second of play of all bodies of a world.
struct TouchingSecond {
  std::vector<std::vector<Vector3d>> ends;  // m
  std::vector<double> estimates;            // m
  std::vector<char> touches;
  double substeps = 0;
};

// Root of the mean square distance between the vertices of a and b, m.
double FindRmsDistance(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

std::unique_ptr<World> MakeFineTwin(const World& world, int substeps) {
  WorldSettings settings = world.Settings();
  settings.precision = Precision::kDouble;
  settings.errorTarget = kAnyError;
  settings.leastSubsteps = substeps;
  return std::make_unique<World>(world, settings);
}

TouchingSecond PlayTouching(World& world, bool keepAwake) {
  const std::span<const Body> bodies = world.Bodies();
  TouchingSecond second;
  second.estimates.assign(bodies.size(), 0);
  second.touches.assign(bodies.size(), 0);
  for (int tick = 0; tick < kTicksInASecond; ++tick) {
    const std::uint64_t substeps = world.Step().allSubsteps;
    second.substeps += static_cast<double>(substeps) / static_cast<double>(kTicksInASecond * bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!bodies[i].asleep) second.estimates[i] += bodies[i].steps.Error();
      if (TouchesAnything(bodies[i])) second.touches[i] = 1;
    }
    if (keepAwake) KeepAwake(world);
  }
  for (const Body& body : bodies) second.ends.push_back(ReadPositions(body));
  return second;
}

// Shifts the free vertices of all bodies a little.
void ShiftABit(World& world) {
  for (const Body& body : world.Bodies()) {
    std::vector<Vector3d> x = ReadPositions(body);
    for (std::size_t i = 0; i < x.size(); ++i) x[i].z() += kShift * std::sin(1.3 * static_cast<double>(i));
    world.SetMotion(body.id, x, ReadVelocities(body));
  }
}

void NoteTrust(const World& world, const TouchingSecond& reference, TouchingTrial& trial) {
  const std::unique_ptr<World> half = MakeFineTwin(world, kReferenceSubsteps / 2);
  const std::unique_ptr<World> shifted = MakeFineTwin(world, kReferenceSubsteps / 2);
  ShiftABit(*shifted);
  const TouchingSecond ofHalf = PlayTouching(*half, true);
  const TouchingSecond ofShifted = PlayTouching(*shifted, true);
  for (std::size_t i = 0; i < reference.ends.size(); ++i) {
    trial.change = std::max(trial.change, FindRmsDistance(reference.ends[i], ofHalf.ends[i]));
    // The shift is kShift/√2, RMS.
    trial.growth =
        std::max(trial.growth, FindRmsDistance(ofHalf.ends[i], ofShifted.ends[i]) / (kShift * std::sqrt(0.5)));
  }
}

void PlayTrial(TouchingTrial& trial, int seconds, bool quick) {
  const std::unique_ptr<World> world = trial.touching->make(trial.target);
  for (int second = 0; second < seconds; ++second) {
    if (trial.touching->steer) trial.touching->steer(*world, second);
    const std::unique_ptr<World> fine = MakeFineTwin(*world, kReferenceSubsteps);
    const TouchingSecond reference = PlayTouching(*fine, true);
    if (!quick && trial.target == kShippedTarget) NoteTrust(*world, reference, trial);
    const TouchingSecond played = PlayTouching(*world, false);
    trial.substeps += played.substeps / seconds;
    for (std::size_t i = 0; i < played.ends.size(); ++i) {
      if (played.touches[i] == 0 && reference.touches[i] == 0) continue;
      trial.errors.push_back(FindRmsDistance(played.ends[i], reference.ends[i]));
      if (played.estimates[i] > 0) trial.ratios.push_back(trial.errors.back() / played.estimates[i]);
    }
  }
}

double FindShare(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

std::size_t CountWithin(const TouchingTrial& trial) {
  const auto isWithin = [&](double error) { return error <= trial.target; };
  return static_cast<std::size_t>(std::count_if(trial.errors.begin(), trial.errors.end(), isWithin));
}

nlohmann::ordered_json MakeTouchingRow(const TouchingTrial& trial, bool quick) {
  nlohmann::ordered_json row = {{"experiment", "error_target_in_contact"},
                                {"case", trial.touching->name},
                                {"target", trial.target},
                                {"met", CountWithin(trial)},
                                {"body_seconds", trial.errors.size()},
                                {"error_median", FindShare(trial.errors, 0.5)},
                                {"error_most", FindShare(trial.errors, 1)},
                                {"ratio_median", FindShare(trial.ratios, 0.5)},
                                {"substeps_per_body_tick", trial.substeps}};
  if (quick || trial.target != kShippedTarget) return row;
  row["change"] = trial.change;
  row["growth"] = trial.growth;
  return row;
}

void AddTouchingFigures(std::span<const TouchingTrial> trials, double target, Results& results) {
  std::size_t within = 0, all = 0;
  std::vector<double> ratios;
  for (const TouchingTrial& trial : trials) {
    if (trial.target != target || !trial.touching->isLimited) continue;
    within += CountWithin(trial);
    all += trial.errors.size();
    ratios.insert(ratios.end(), trial.ratios.begin(), trial.ratios.end());
  }
  const double met = static_cast<double>(within) / static_cast<double>(all);
  if (target == kShippedTarget) {
    results.AddFigureAtLeast("error_target_met_in_contact", met, 0.95);
    results.AddFigure("error_over_estimate_in_contact", FindShare(ratios, 0.5));
    results.AddFigure("error_over_estimate_in_contact_p90", FindShare(ratios, 0.9));
  } else {
    results.AddFigure(
        target < kShippedTarget ? "error_target_met_in_contact_at_a_tenth" : "error_target_met_in_contact_at_ten_times",
        met);
  }
}

}  // namespace

void MeasureTouchingTargets(Bench& bench) {
  const bool quick = bench.options.quick;
  const std::vector<TouchingCase> cases = MakeTouchingCases(quick);
  std::vector<double> targets{kShippedTarget};
  if (!quick) targets = {kShippedTarget, kShippedTarget / 10, kShippedTarget * 10};
  std::vector<TouchingTrial> trials;
  for (const double target : targets) {
    for (const TouchingCase& touching : cases) trials.push_back({.touching = &touching, .target = target});
  }
  const int seconds = quick ? 2 : 4;
  if (!RunTrials(bench, trials.size(), [&](std::size_t i) { PlayTrial(trials[i], seconds, quick); })) return;
  for (const TouchingTrial& trial : trials) bench.results.rows.push_back(MakeTouchingRow(trial, quick));
  for (const double target : targets) AddTouchingFigures(trials, target, bench.results);
  for (const TouchingTrial& trial : trials) {
    if (trial.touching->key == nullptr || trial.target != kShippedTarget) continue;
    const double met = static_cast<double>(CountWithin(trial)) / static_cast<double>(trial.errors.size());
    bench.results.AddFigure(std::string("error_target_met_") + trial.touching->key, met);
  }
}

}  // namespace wobble::bench
