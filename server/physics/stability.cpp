#include "server/physics/stability.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

constexpr int kPowerIterations = 200;
// Squeezing a body raises its frequencies by 3-9 %; the power iteration itself comes from below.
constexpr double kFrequencyMargin = 1.05;

// Conservative accelerations of a free body at x: springs without dashpots, and gas.
void ComputeElasticAccelerations(const Coefficients<double>& body, const std::vector<Vector3d>& x,
                                 const std::vector<Vector3d>& zero, std::vector<Vector3d>& accelerations) {
  const Load<double> load;
  ComputeAccelerations<double>(body, load, {}, {}, x, zero, accelerations);
}

// A start that no mode is orthogonal to by symmetry.
std::vector<Vector3d> MakeProbe(std::size_t count) {
  std::vector<Vector3d> probe(count);
  std::uint64_t state = 1;
  for (Vector3d& p : probe) {
    for (int axis = 0; axis < 3; ++axis) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      p[axis] = static_cast<double>(state >> 40) / 16777216.0 - 0.5;
    }
  }
  return probe;
}

double FindNorm(const std::vector<Vector3d>& values) {
  double sum = 0;
  for (const Vector3d& value : values) sum += value.squaredNorm();
  return std::sqrt(sum);
}

// Contact's part of ω² and γ: the largest over all contacts. A vertex in a corner touches several surfaces at once;
// they push along different axes where obstacles are boxes, so one contact's stiffness is taken for each axis.
struct ContactRates {
  double squareFrequency = 0;
  double dampingRate = 0;
};

// The depth that a vertex may reach: as far as it flies in the tick, or until the quadratic spring F = k_q d² has taken
// its energy, ½mv² = k_q d³/3, hence d = (1.5 mv²/k_q)^⅓, whichever is less.
template <class Real>
double PredictDepth(const ContactParameters<Real>& contact, double mass, double depth, double approach,
                    double duration) {
  if (approach <= 0) return depth;
  const double quadratic = double{contact.stiffness} / (2 * double{contact.fadeDepth});
  const double stopped = std::cbrt(1.5 * mass * approach * approach / quadratic);
  return depth + std::min(approach * duration, stopped);
}

template <class Real>
ContactRates FindContactRates(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                              const State<Real>& state, double duration) {
  const ContactParameters<Real>& contact = body.contact;
  ContactRates largest;
  for (const Contact<Real>& candidate : state.contacts) {
    const std::uint32_t i = candidate.vertex;
    const SurfacePoint<Real> point = FindSurfacePoint(surfaces[candidate.surface], state.positions[i]);
    const double mass = double{body.masses[i]};
    const double approach = -double{point.normal.dot(state.velocities[i])};
    const double depth = PredictDepth(contact, mass, -double{point.distance}, approach, duration);
    if (depth <= 0) continue;
    const auto at = static_cast<Real>(depth);
    const double normalDamping = double{contact.damping} * double{ComputeDampingShare(contact, at)};
    const double frequency = (double{ComputePenaltySlope(contact, at)} + double{contact.stickStiffness}) / mass;
    const double damping = (normalDamping + double{contact.stickDamping}) / mass;
    largest.squareFrequency = std::max(largest.squareFrequency, frequency);
    largest.dampingRate = std::max(largest.dampingRate, damping);
  }
  return largest;
}

}  // namespace

int FindRung(double needed) {
  for (const int rung : kSubstepLadder) {
    if (rung >= needed) return rung;
  }
  return kMaxSubsteps;
}

double FindModeRate(double squareFrequency, double dampingRate) {
  const double discriminant = dampingRate * dampingRate / 4 - squareFrequency;
  return discriminant <= 0 ? std::sqrt(squareFrequency) : dampingRate / 2 + std::sqrt(discriminant);
}

void FindBodyStability(Blueprint& blueprint) {
  const std::vector<Vector3d>& rest = blueprint.rest;
  const std::vector<Vector3d> zero(rest.size(), Vector3d::Zero());
  std::vector<Vector3d> mode = MakeProbe(rest.size());
  std::vector<Vector3d> moved(rest.size());
  std::vector<Vector3d> forward(rest.size());
  std::vector<Vector3d> backward(rest.size());
  // The operator −∂a/∂x applied to a mode, by central differences of the forces themselves: whatever terms the body
  // has are all in it.
  const double epsilon = 1e-6 * blueprint.size;
  double eigenvalue = 0;
  for (int iteration = 0; iteration < kPowerIterations; ++iteration) {
    const double norm = FindNorm(mode);
    if (!(norm > 0)) break;
    for (Vector3d& m : mode) m /= norm;
    for (std::size_t i = 0; i < rest.size(); ++i) moved[i] = rest[i] + epsilon * mode[i];
    ComputeElasticAccelerations(blueprint.full, moved, zero, forward);
    for (std::size_t i = 0; i < rest.size(); ++i) moved[i] = rest[i] - epsilon * mode[i];
    ComputeElasticAccelerations(blueprint.full, moved, zero, backward);
    for (std::size_t i = 0; i < rest.size(); ++i) mode[i] = (backward[i] - forward[i]) / (2 * epsilon);
    eigenvalue = FindNorm(mode);
  }
  blueprint.angularFrequency = std::sqrt(eigenvalue) * kFrequencyMargin;

  // Dashpots act along the springs: their matrix is at most max(c/k) times the springs' one.
  double ratio = 0;
  for (const Spring<double>& spring : blueprint.full.springs) {
    if (spring.stiffness > 0) ratio = std::max(ratio, spring.damping / spring.stiffness);
  }
  blueprint.dampingRate = ratio * blueprint.angularFrequency * blueprint.angularFrequency;
}

template <class Real>
double FindLargestRate(const Blueprint& blueprint, const Load<Real>& load, std::span<const Surface<Real>> surfaces,
                       const State<Real>& state, double duration, bool& lightlyDamped) {
  const double factor = std::max({1.0, double{load.stiffnessFactor}, double{load.gasFactor}});
  const double body = blueprint.angularFrequency * blueprint.angularFrequency * factor;
  const double bodyDamping = blueprint.dampingRate * factor;
  const ContactRates contact = FindContactRates(blueprint.Read<Real>(), surfaces, state, duration);
  const double both = bodyDamping + contact.dampingRate;
  const double rate =
      std::max({FindModeRate(body, both), contact.dampingRate, FindModeRate(body + contact.squareFrequency, both),
                FindModeRate(body + contact.squareFrequency, bodyDamping)});
  lightlyDamped = both < rate * 2 / 3;  // g = 2ζω: under a third of critical
  return rate;
}

template <class Real>
int ChooseSubsteps(const Blueprint& blueprint, const Load<Real>& load, std::span<const Surface<Real>> surfaces,
                   const State<Real>& state, double duration) {
  bool lightlyDamped = false;
  const double rate = FindLargestRate(blueprint, load, surfaces, state, duration, lightlyDamped);
  return FindRung(rate * duration / (lightlyDamped ? kStabilityLimitLightlyDamped : kStabilityLimit));
}

#define WOBBLE_INSTANTIATE(Real)                                                                             \
  template double FindLargestRate<Real>(const Blueprint&, const Load<Real>&, std::span<const Surface<Real>>, \
                                        const State<Real>&, double, bool&);                                  \
  template int ChooseSubsteps<Real>(const Blueprint&, const Load<Real>&, std::span<const Surface<Real>>,     \
                                    const State<Real>&, double);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
