// The rate at which two motions that begin side by side diverge, against the bound of theory.
//
// Theory: a step y' = y + h φ(y) with φ Lipschitz of constant Λ lets a distance grow by at most 1 + hΛ, in time T by S
// = e^{ΛT}. If k is the constant of the equations themselves, then for RK4, from its tableau with α = max Σ|aᵢⱼ| = 1, Λ
// = k Σ bᵢ Σ_{p<i} (kh)^p; for explicit Euler Λ = k. The constant depends on the norm. Positions are weighted by ω, the
// body's highest frequency: the matrix of an undamped body then has the norm ω, and no norm makes it smaller. Without
// weights k would be the largest ω², hundreds of times as large.
//
// k is evaluated along the motion: at its states and at the states that its stages reach. The growth is that of the
// worst disturbance, not of a random one: every coordinate and velocity is displaced in turn, which gives the
// derivative of the motion by its initial state; its norm is the growth.
#include <algorithm>
#include <cmath>

#include "server/physics/shapes/ball.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/stability/experiments.h"
#include "tests/bench/stability/free_body.h"
#include "tests/bench/stability/modes.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDuration = 0.25;   // s
constexpr double kStretch = 1.2;     // along z
constexpr double kDisplaced = 1e-7;  // m, and m/s
constexpr int kSamples = 15;         // moments at which the distance is measured
// Of the power method; when the two largest values are close, the norm is still nearly right
constexpr int kIterations = 60;

struct GrowthBall {
  int subdivisions = 2;
  double stiffness = 750;  // N/m
  double dampingRatio = 0;
  Blueprint blueprint = {};
  std::vector<Vector3d> x = {};  // stretched
};

struct GrowthTrial {
  const GrowthBall* subject;
  Integrator integrator;
  int stepsASecond;
  double lipschitz = 0;                            // k, 1/s
  double bound = 0;                                // Λ, 1/s
  std::vector<std::array<double, 2>> growth = {};  // s, ln of the distance over the initial one
};

GrowthBall MakeGrowthBall(int subdivisions, double stiffness, double dampingRatio) {
  BallDefinition ball;
  ball.subdivisions = subdivisions;
  ball.radius = 1;
  ball.material.mass = 0.25 * static_cast<double>(CountVertices(subdivisions));
  ball.material.stiffness = stiffness;
  ball.material.gas = 1000;
  ball.material.dampingRatio = dampingRatio;
  GrowthBall subject{subdivisions, stiffness, dampingRatio, MakeBall(ball)};
  const double across = 1 / std::sqrt(kStretch);
  for (const Vector3d& x : subject.blueprint.rest) {
    subject.x.emplace_back(across * x.x(), across * x.y(), kStretch * x.z());
  }
  return subject;
}

FreeBody Begin(const GrowthTrial& trial) {
  FreeBody body(trial.subject->blueprint, trial.integrator);
  body.x = trial.subject->x;
  return body;
}

double FindStep(const GrowthTrial& trial) { return 1.0 / trial.stepsASecond; }

// The largest singular value of a matrix, given by its product and that of its transpose.
template <class Apply, class ApplyTransposed>
double FindNorm(Eigen::Index size, const Apply& apply, const ApplyTransposed& applyTransposed) {
  VectorXd direction = VectorXd::LinSpaced(size, 1, 2).array().sin();
  double norm = 0;
  for (int i = 0; i < kIterations; ++i) {
    direction.normalize();
    const VectorXd image = apply(direction);
    norm = image.norm();
    direction = applyTransposed(image);
  }
  return norm;
}

// The norm of [0 ω; −K/ω −C].
double FindLipschitz(const LinearMotion& motion, double weight) {
  const Eigen::Index count = motion.stiffness.rows();
  const auto apply = [&](const VectorXd& y) {
    VectorXd image(2 * count);
    image << weight * y.tail(count), -motion.stiffness * y.head(count) / weight - motion.damping * y.tail(count);
    return image;
  };
  const auto applyTransposed = [&](const VectorXd& y) {
    VectorXd image(2 * count);
    image << -motion.stiffness.transpose() * y.tail(count) / weight,
        weight * y.head(count) - motion.damping.transpose() * y.tail(count);
    return image;
  };
  return FindNorm(2 * count, apply, applyTransposed);
}

// The largest value along the motion, at kSamples of its steps: at the state and where the last stage reaches.
double FindLipschitz(const GrowthTrial& trial) {
  Equations equations;
  equations.blueprint = &trial.subject->blueprint;
  FreeBody body = Begin(trial);
  const double h = FindStep(trial);
  const int steps = static_cast<int>(std::lround(kDuration / h));
  const int every = std::max(1, steps / kSamples);
  double largest = 0;
  for (int step = 0; step <= steps; ++step) {
    if (step % every == 0) {
      std::vector<Vector3d> ahead = body.x;
      for (std::size_t i = 0; i < ahead.size(); ++i) ahead[i] += h * body.v[i];
      for (const auto& x : {body.x, ahead}) {
        largest = std::max(largest,
                           FindLipschitz(Linearise(equations, x, body.v), trial.subject->blueprint.angularFrequency));
      }
    }
    body.Step(h);
  }
  return largest;
}

double FindBound(Integrator integrator, double k, double h) {
  if (integrator == Integrator::kExplicitEuler) return k;
  double bound = 0;
  double powers = 0;
  for (std::size_t stage = 0; stage < kClassicRungeKutta.b.size(); ++stage) {
    powers += std::pow(k * h, static_cast<double>(stage));
    bound += k * kClassicRungeKutta.b[stage] * powers;
  }
  return bound;
}

// The states of a motion at kSamples moments, each as one vector with weighted positions.
std::vector<VectorXd> Follow(const GrowthTrial& trial, FreeBody body) {
  const double weight = trial.subject->blueprint.angularFrequency;
  const auto count = static_cast<Eigen::Index>(3 * body.x.size());
  const double h = FindStep(trial);
  const int every = static_cast<int>(std::lround(kDuration / h)) / kSamples;
  std::vector<VectorXd> samples;
  for (int sample = 0; sample < kSamples; ++sample) {
    for (int step = 0; step < every; ++step) body.Step(h);
    VectorXd state(2 * count);
    state << weight * Eigen::Map<const VectorXd>(body.x[0].data(), count),
        Eigen::Map<const VectorXd>(body.v[0].data(), count);
    samples.push_back(std::move(state));
  }
  return samples;
}

void MeasureGrowthOf(GrowthTrial& trial) {
  const double weight = trial.subject->blueprint.angularFrequency;
  trial.lipschitz = FindLipschitz(trial);
  trial.bound = FindBound(trial.integrator, trial.lipschitz, FindStep(trial));
  const FreeBody begin = Begin(trial);
  const std::vector<VectorXd> beside = Follow(trial, begin);
  const Eigen::Index size = beside[0].size();
  std::vector<MatrixXd> derivatives(kSamples, MatrixXd(size, size));
  for (Eigen::Index column = 0; column < size; ++column) {
    FreeBody displaced = begin;
    const bool isVelocity = column >= size / 2;
    const auto coordinate = static_cast<std::size_t>(isVelocity ? column - size / 2 : column);
    (isVelocity ? displaced.v : displaced.x)[coordinate / 3][static_cast<Eigen::Index>(coordinate % 3)] += kDisplaced;
    const std::vector<VectorXd> samples = Follow(trial, std::move(displaced));
    for (std::size_t i = 0; i < kSamples; ++i) {
      derivatives[i].col(column) = (samples[i] - beside[i]) / (isVelocity ? kDisplaced : weight * kDisplaced);
    }
  }
  trial.growth.push_back({0, 0});
  for (std::size_t i = 0; i < kSamples; ++i) {
    const MatrixXd& d = derivatives[i];
    const double norm = FindNorm(
        size, [&](const VectorXd& y) -> VectorXd { return d * y; },
        [&](const VectorXd& y) -> VectorXd { return d.transpose() * y; });
    trial.growth.push_back({kDuration * static_cast<double>(i + 1) / kSamples, std::log(norm)});
  }
}

double FindLargestShare(const GrowthTrial& trial) {
  double share = 0;
  for (const auto& [time, growth] : trial.growth) {
    if (!std::isfinite(growth)) return NAN;
    if (time > 0) share = std::max(share, growth / (trial.bound * time));
  }
  return share;
}

std::vector<GrowthTrial> MakeTrials(const std::vector<GrowthBall>& subjects, bool quick) {
  std::vector<GrowthTrial> trials;
  for (const GrowthBall& subject : subjects) {
    const int slowest = subject.stiffness > 750 ? 180 : 60;  // hω = 2.2: RK4 is near its limit
    for (const int factor : {1, 2, 4, 8}) {
      if (quick && factor == 4) continue;
      trials.push_back({&subject, Integrator::kRungeKutta4, factor * slowest});
    }
    // Finer, because coarse steps would leave the neighbourhood in which the motions are compared.
    trials.push_back({&subject, Integrator::kExplicitEuler, (subject.stiffness > 750 ? 32 : 8) * slowest});
  }
  return trials;
}

void AddGrowthRow(Bench& bench, const GrowthTrial& trial) {
  bench.results.rows.push_back({{"experiment", "growth"},
                                {"method", FindName(trial.integrator)},
                                {"body", "ball of " + std::to_string(CountVertices(trial.subject->subdivisions))},
                                {"stiffness", trial.subject->stiffness},
                                {"damping_ratio", trial.subject->dampingRatio},
                                {"step", FindStep(trial)},
                                {"lipschitz", trial.lipschitz},
                                {"log_growth", trial.growth.back()[1]},
                                {"bound", trial.bound * kDuration},
                                {"largest_share_of_bound", FindLargestShare(trial)}});
}

// Plots the first ball.
void AddGrowthPlot(Bench& bench, const std::vector<GrowthTrial>& trials) {
  Plot plot{.name = "stability_growth",
            .title = "Two motions of a stretched ball that begin beside one another",
            .xLabel = "time, s",
            .yLabel = "distance over that at the beginning"};
  plot.logY = true;
  int colour = 0;
  for (const GrowthTrial& trial : trials) {
    if (trial.subject != trials[0].subject) continue;
    const std::string method = trial.integrator == Integrator::kExplicitEuler ? "explicit Euler" : "RK4";
    const std::string name = method + ", h = 1/" + std::to_string(trial.stepsASecond) + " s";
    Series measured{name, Stroke::kLine, {}, ++colour};
    for (const auto& [time, growth] : trial.growth) measured.points.push_back({time, std::exp(growth)});
    Series bound{"its bound", Stroke::kDashed, {}, colour};
    for (const auto& [time, growth] : trial.growth) bound.points.push_back({time, std::exp(trial.bound * time)});
    plot.series.push_back(std::move(measured));
    plot.series.push_back(std::move(bound));
  }
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace

void MeasureGrowth(Bench& bench) {
  const bool quick = bench.options.quick;
  std::vector<GrowthBall> subjects;
  subjects.push_back(MakeGrowthBall(quick ? 1 : 2, 750, 0));
  for (const double stiffness : {750.0, 7500.0}) {
    for (const double dampingRatio : {0.0, 0.2}) {
      if (quick && stiffness > 750 && dampingRatio > 0) continue;
      if (stiffness > 750 || dampingRatio > 0) subjects.push_back(MakeGrowthBall(1, stiffness, dampingRatio));
    }
  }
  std::vector<GrowthTrial> trials = MakeTrials(subjects, quick);
  if (!RunTrials(bench, trials.size(), [&](std::size_t i) { MeasureGrowthOf(trials[i]); })) return;
  double largest = 0;
  for (const GrowthTrial& trial : trials) {
    AddGrowthRow(bench, trial);
    const double share = FindLargestShare(trial);
    largest = std::isfinite(share) ? std::max(largest, share) : share;
  }
  bench.results.AddFigureAtMost("growth_over_bound_max", largest, 1);
  AddGrowthPlot(bench, trials);
}

}  // namespace wobble::bench
