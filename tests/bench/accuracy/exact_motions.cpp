// Motions in closed form. Two masses on a spring that move along it are a linear oscillator of reduced mass μ = m/2.
// Two masses that spin about each other keep the length at which the spring balances the centrifugal force,
// k (L − r) = μ Ω² L, which tests the equations where they are not linear.
//
// A particle that loses no energy leaves the ground as fast as it arrived. How deep and how long it is in the ground
// follows from the energy left at depth d,
//   v²(d) = v₀² + 2 g d − 2 U(d)/m   with   U = k d³/6δ up to δ, then k (d²/2 − dδ/2 + δ²/6).
// Its root solves a quadratic equation; the time is an integral of 1/v, whose integrand is smooth in s = √(1 − d/d_max)
// except at the law's joint δ, where the interval is split.
#include <array>
#include <cmath>
#include <numeric>

#include "server/physics/shapes/pair.h"
#include "tests/bench/accuracy/exact.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/accuracy/problem.h"
#include "tests/bench/contact/bodies.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kGravitySize = 9.81;
// Short enough that RK4's error, (hω)⁴ωt/120, stays below 1e-10 in all problems except the bounce.
constexpr double kStep = 1.0 / 8000;
// The kink in the contact force's slope reduces the order of convergence by one or two.
constexpr double kBounceStep = 2e-6;

struct Ends {
  Motion engine;
  Motion reference;
};

Ends SolveBoth(const Problem& problem, double step) {
  const auto steps = static_cast<std::int64_t>(std::ceil(problem.duration / step));
  return {SolveInSteps(problem, {.steps = steps}).end, SolveReference(problem)};
}

PairDefinition DescribePair(double dampingRatio) {
  PairDefinition pair;  // two masses of 1 kg, 1 m apart
  pair.material.stiffness = 100;
  pair.material.dampingRatio = dampingRatio;
  return pair;
}
constexpr double kReducedMass = 0.5;  // kg

// Displacement over its initial value after a release at rest; damping ratio ζ, angular frequency ω.
double FindRinging(double ratio, double omega, double time) {
  const double decay = std::exp(-ratio * omega * time);
  if (ratio < 1) {
    const double ringing = omega * std::sqrt(1 - ratio * ratio);
    return decay * (std::cos(ringing * time) + ratio * omega / ringing * std::sin(ringing * time));
  }
  const double creeping = omega * std::sqrt(ratio * ratio - 1);
  return decay * (std::cosh(creeping * time) + ratio * omega / creeping * std::sinh(creeping * time));
}

ExactValue SolveOscillator(const std::string& name, double ratio, double duration) {
  constexpr double kStretch = 0.1;
  const PairDefinition pair = DescribePair(ratio);
  Problem problem = MakeProblem(MakePair(pair), duration);
  problem.x[0].x() -= kStretch / 2;
  problem.x[1].x() += kStretch / 2;
  const double omega = std::sqrt(pair.material.stiffness / kReducedMass);
  const Ends ends = SolveBoth(problem, kStep);
  const auto findStretch = [](const Motion& motion) { return (motion.x[1] - motion.x[0]).x() - 1; };
  return {.problem = name,
          .quantity = "stretch, m",
          .exact = kStretch * FindRinging(ratio, omega, duration),
          .engine = findStretch(ends.engine),
          .reference = findStretch(ends.reference),
          .scale = kStretch};
}

std::vector<ExactValue> SolveSpinningPair() {
  constexpr double kSpin = 3;  // rad/s, about y
  constexpr double kTime = 2;
  constexpr double kUp = 7;  // initial speed, m/s
  const PairDefinition pair = DescribePair(0);
  const double k = pair.material.stiffness;
  const double half = k * pair.length / (k - kReducedMass * kSpin * kSpin) / 2;
  Problem problem = MakeProblem(MakePair(pair), kTime);
  problem.equations.gravity = Vector3d(0, 0, -kGravitySize);
  for (const int i : {0, 1}) {
    const double side = i == 0 ? -half : half;
    problem.x[i] = Vector3d(side, 0, 0);
    problem.v[i] = Vector3d(0, 0, kUp + kSpin * side);
  }
  const Ends ends = SolveBoth(problem, kStep);
  const auto findHeight = [](const Motion& motion) { return (motion.x[0] + motion.x[1]).z() / 2; };
  const double height = kUp * kTime - kGravitySize * kTime * kTime / 2;
  return {{"free fall", "height of the centre, m", height, findHeight(ends.engine), findHeight(ends.reference), kUp},
          {"spinning pair", "place of a mass along x, m", half * std::cos(kSpin * kTime), ends.engine.x[1].x(),
           ends.reference.x[1].x(), half}};
}

// The impact of a particle of `mass` that meets the ground at `speed`.
class Impact {
 public:
  Impact(const ContactParameters<double>& law, double mass, double speed) : m_law(law), m_mass(mass), m_speed(speed) {
    const double weightDepth = mass * kGravitySize / law.stiffness;
    const double delta = law.fadeDepth;
    const double middle = delta / 2 + weightDepth;
    m_depth = middle + std::sqrt(middle * middle - delta * delta / 3 + mass * speed * speed / law.stiffness);
    const double joint = std::sqrt(1 - delta / m_depth);
    m_duration = 2 * (FindTime(0, joint) + FindTime(joint, 1));
  }
  [[nodiscard]] double Depth() const { return m_depth; }
  [[nodiscard]] double Duration() const { return m_duration; }

 private:
  [[nodiscard]] double FindSquaredSpeed(double d) const {
    const double k = m_law.stiffness;
    const double delta = m_law.fadeDepth;
    const double stored = d < delta ? k * d * d * d / (6 * delta) : k * (d * (d - delta) / 2 + delta * delta / 6);
    return m_speed * m_speed + 2 * kGravitySize * d - 2 * stored / m_mass;
  }
  // ∫ 2 d_max s/v ds by three-point Gauss quadrature on many subintervals.
  [[nodiscard]] double FindTime(double from, double to) const {
    constexpr int kParts = 1000;
    const double part = (to - from) / kParts;
    const double side = std::sqrt(0.6);
    double sum = 0;
    for (int i = 0; i < kParts; ++i) {
      for (const auto& [place, weight] : {std::array{-side, 5.0}, {0.0, 8.0}, {side, 5.0}}) {
        const double s = from + part * (i + (1 + place) / 2);
        sum += weight / 18 * part * 2 * m_depth * s / std::sqrt(FindSquaredSpeed(m_depth * (1 - s * s)));
      }
    }
    return sum;
  }

  ContactParameters<double> m_law;
  double m_mass;
  double m_speed;
  double m_depth = 0;
  double m_duration = 0;
};

std::vector<ExactValue> SolveBounce() {
  constexpr double kFall = 0.2;    // m
  constexpr double kAfter = 0.15;  // s of flight after the bounce
  const double speed = std::sqrt(2 * kGravitySize * kFall);
  const double falling = speed / kGravitySize;
  Problem problem = MakeProblem(MakeParticles(1), 0);
  const Coefficients<double>& body = problem.blueprint->full;
  const Impact impact(body.contact, body.masses[0], speed);
  problem.equations.gravity = Vector3d(0, 0, -kGravitySize);
  problem.equations.obstacles = {Obstacle{}};
  for (Vector3d& x : problem.x) x.z() = kFall;

  const auto solve = [&](double duration) {
    problem.duration = duration;
    return SolveBoth(problem, kBounceStep);
  };
  const auto findEnergy = [&](const Motion& motion) { return FindEnergy(problem.equations, motion.x, motion.v); };
  const double energy = problem.blueprint->totalMass * kGravitySize * kFall;
  const double height = speed * kAfter - kGravitySize * kAfter * kAfter / 2;
  const Ends deep = solve(falling + impact.Duration() / 2);
  const Ends after = solve(falling + impact.Duration() + kAfter);
  const std::string name = "bounce of a particle";
  return {{name, "height when it is deepest, m", -impact.Depth(), deep.engine.x[0].z(), deep.reference.x[0].z(),
           impact.Depth()},
          {name, "energy when it is deepest, J", energy, findEnergy(deep.engine), findEnergy(deep.reference), energy},
          {name, "height after 0.15 s of flight, m", height, after.engine.x[0].z(), after.reference.x[0].z(), kFall}};
}

}  // namespace

std::vector<ExactValue> SolveExactMotions() {
  std::vector<ExactValue> values{SolveOscillator("oscillator", 0, 1.9),
                                 SolveOscillator("oscillator, damped by 0.1", 0.1, 1.9),
                                 SolveOscillator("oscillator, damped by 1.5", 1.5, 0.5)};
  for (const auto& more : {SolveSpinningPair(), SolveBounce()}) values.insert(values.end(), more.begin(), more.end());
  return values;
}

}  // namespace wobble::bench
