// The frequency at rest is found once, by a power iteration on the forces themselves. What contacts add is bounded from
// above each tick; bounds of squares of frequencies, and damping rates, add up.
#include "server/physics/methods/stability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/methods/elasticity.h"
#include "server/physics/methods/step_limits.h"

namespace wobble::physics {
namespace {

constexpr int kPowerIterations = 200;
// Squeezing a body raises its frequencies by 3-9 %, and the power iteration approaches the largest one from below.
constexpr double kFrequencyMargin = 1.05;

// Accelerations of a free body at x by its conservative forces: springs without dashpots, tetrahedra, hinges
// and gas.
void ComputeElasticAccelerations(const Coefficients<double>& body, const std::vector<Vector3d>& x,
                                 const std::vector<Vector3d>& zero, std::vector<Vector3d>& accelerations) {
  const Load<double> load;
  ComputeAccelerations<double>(body, load, {}, {}, x, zero, accelerations);
}

// A first vector for the power iteration that no mode is orthogonal to by symmetry.
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

// The largest eigenvalue of the operator that `apply` replaces a mode by.
template <class Apply>
double FindLargestEigenvalue(std::size_t count, const Apply& apply) {
  std::vector<Vector3d> mode = MakeProbe(count);
  double eigenvalue = 0;
  for (int iteration = 0; iteration < kPowerIterations; ++iteration) {
    const double norm = FindNorm(mode);
    if (!(norm > 0)) break;
    for (Vector3d& m : mode) m /= norm;
    apply(mode);
    eigenvalue = FindNorm(mode);
  }
  return eigenvalue;
}

// Applies the operator −∂a/∂x to a mode by central differences of the forces, so that it holds all terms of `body`.
double FindFrequencyAtRest(const Blueprint& blueprint, const Coefficients<double>& body) {
  const std::vector<Vector3d>& rest = blueprint.rest;
  const std::vector<Vector3d> zero(rest.size(), Vector3d::Zero());
  std::vector<Vector3d> moved(rest.size());
  std::vector<Vector3d> forward(rest.size());
  std::vector<Vector3d> backward(rest.size());
  const double epsilon = 1e-6 * blueprint.size;
  const double eigenvalue = FindLargestEigenvalue(rest.size(), [&](std::vector<Vector3d>& mode) {
    for (std::size_t i = 0; i < rest.size(); ++i) moved[i] = rest[i] + epsilon * mode[i];
    ComputeElasticAccelerations(body, moved, zero, forward);
    for (std::size_t i = 0; i < rest.size(); ++i) moved[i] = rest[i] - epsilon * mode[i];
    ComputeElasticAccelerations(body, moved, zero, backward);
    for (std::size_t i = 0; i < rest.size(); ++i) mode[i] = (backward[i] - forward[i]) / (2 * epsilon);
  });
  return std::sqrt(eigenvalue) * kFrequencyMargin;
}

// The largest damping rate that the dashpots of springs give a mode. They act along the springs: their matrix is at
// most max(c/k) times the springs' one. A body has springs or tetrahedra; hinges, which may be far stiffer than its
// springs, are left out.
double FindDashpotRate(const Blueprint& blueprint) {
  double ratio = 0;
  for (const Spring<double>& spring : blueprint.full.springs) {
    if (spring.stiffness > 0) ratio = std::max(ratio, spring.damping / spring.stiffness);
  }
  double frequency = blueprint.angularFrequency;
  if (!blueprint.full.hinges.empty()) {
    Coefficients<double> alone = blueprint.full;
    alone.hinges.clear();
    frequency = FindFrequencyAtRest(blueprint, alone);
  }
  return ratio * frequency * frequency;
}

// The largest damping rate that the viscosity of tetrahedra gives a mode at rest, where forces are linear in v.
double FindViscousRate(const Blueprint& blueprint) {
  if (!(blueprint.full.solid.viscosity > 0)) return 0;
  Coefficients<double> alone = blueprint.full;
  alone.springs.clear();
  alone.hinges.clear();
  alone.gas = 0;
  alone.drag = 0;
  std::vector<Vector3d> accelerations(blueprint.rest.size());
  const double eigenvalue = FindLargestEigenvalue(blueprint.rest.size(), [&](std::vector<Vector3d>& mode) {
    ComputeAccelerations<double>(alone, Load<double>{}, {}, {}, blueprint.rest, mode, accelerations);
    for (std::size_t i = 0; i < mode.size(); ++i) mode[i] = -accelerations[i];
  });
  return kFrequencyMargin * eigenvalue;
}

// The largest damping rate that hinges give a mode. At most c/k times their own square of a frequency, which is the
// same in every state: their forces are linear in x.
double FindHingeRate(const Blueprint& blueprint) {
  if (blueprint.full.hinges.empty()) return 0;
  Coefficients<double> alone = blueprint.full;
  alone.springs.clear();
  alone.tetrahedra.clear();
  alone.gas = 0;
  alone.drag = 0;
  const std::vector<Vector3d> zero(blueprint.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> accelerations(blueprint.rest.size());
  const double eigenvalue = FindLargestEigenvalue(blueprint.rest.size(), [&](std::vector<Vector3d>& mode) {
    ComputeElasticAccelerations(alone, mode, zero, accelerations);
    for (std::size_t i = 0; i < mode.size(); ++i) mode[i] = -accelerations[i];
  });
  double ratio = 0;
  for (const Hinge<double>& hinge : alone.hinges) ratio = std::max(ratio, hinge.damping / hinge.stiffness);
  return kFrequencyMargin * kFrequencyMargin * ratio * eigenvalue;
}

// The damping rate of quadratic drag, 1/s: on a face it is dragRate times the face's speed against the medium.
template <class Real>
double FindDragDamping(const Blueprint& blueprint, const Load<Real>& load, const State<Real>& state) {
  if (!(blueprint.dragRate > 0)) return 0;
  Real fastest = 0;
  for (const Vector3<Real>& v : state.velocities) fastest = std::max(fastest, (v - load.wind).squaredNorm());
  return blueprint.dragRate * std::sqrt(double{fastest});
}

// Bounds for a body on a rigid surface at any depth and speed.
Modes FindModesOnGround(const Blueprint& blueprint) {
  Modes modes;
  modes.body = {blueprint.angularFrequency * blueprint.angularFrequency, blueprint.dampingRate};
  const Coefficients<double>& body = blueprint.full;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    // Force and damping grow no steeper beyond the fade depth.
    const ContactRates rates =
        FindRates(body.contact, 2 * body.contact.fadeDepth, body.masses[i] / body.contactShares[i]);
    modes.surfaces.squareFrequency = std::max(modes.surfaces.squareFrequency, rates.squareFrequency);
    modes.surfaces.dampingRate = std::max(modes.surfaces.dampingRate, rates.dampingRate);
  }
  return modes;
}

// Of RK4; not rounded to the ladder.
double FindSubsteps(const Modes& modes, double duration) {
  bool lightlyDamped = false;
  const double rate = FindLargestRate(modes, lightlyDamped);
  return rate * duration / (lightlyDamped ? kStabilityLimitLightlyDamped : kStabilityLimit);
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
  blueprint.angularFrequency = FindFrequencyAtRest(blueprint, blueprint.full);
  blueprint.dampingRate = FindDashpotRate(blueprint) + FindViscousRate(blueprint) + FindHingeRate(blueprint);
}

double FindStableRate(Integrator integrator, const Blueprint& blueprint, const Modes& modes) {
  if (integrator == Integrator::kImplicitEuler) {
    // It treats forces that are not in its matrix as semi-implicit Euler does.
    return FindStableRate(Integrator::kSemiImplicitEuler, modes.bodies.squareFrequency, modes.bodies.dampingRate);
  }
  // The body's frequency covers springs and gas together. So springs that are taken as distances can be left out only
  // for a body without gas.
  const bool springsAreDistances = integrator == Integrator::kPositionVerlet && !(blueprint.full.gas > 0);
  const ContactRates body = springsAreDistances ? ContactRates{} : modes.body;
  const ContactRates contact = modes.surfaces + modes.bodies;
  const double together = body.squareFrequency + contact.squareFrequency;
  const double damping = body.dampingRate + contact.dampingRate;
  return std::max({FindStableRate(integrator, body.squareFrequency, damping),
                   FindStableRate(integrator, together, damping),
                   FindStableRate(integrator, together, body.dampingRate)});
}

// Rates are the largest over all contacts. A vertex in a corner touches several surfaces at once; where obstacles are
// boxes these push along different axes, so one contact's stiffness is taken for each axis.
//
// Agitation: a body that vibrates faster than a tick may throw any of its vertices onto a surface at this speed,
// whatever the vertex does now. Of 600 lattices dropped into a wedge 17 ran away when bounded by the speed of each
// vertex alone, none with this bound.
//
// Landing: RK4's stages do not see the error that is made while landing vertices cross the depth over which the
// surface's force sets in. It shows in how high the body comes back, in proportion to the square root of the mass that
// lands, and so does the number of substeps for the crossing. Without them a lone particle came back up to 10 % too
// high or too low.
template <class Real>
SurfaceDemands FindSurfaceDemands(const Blueprint& blueprint, std::span<const Surface<Real>> surfaces,
                                  const State<Real>& state, double agitation, double duration) {
  const Coefficients<Real>& body = blueprint.Read<Real>();
  const ContactParameters<Real>& contact = body.contact;
  const double fade = double{contact.fadeDepth};
  SurfaceDemands demands;
  double deepest = -std::numeric_limits<double>::infinity();
  double itsMass = 0;
  double landing = 0;
  double fastest = 0;
  for (const Contact<Real>& candidate : state.contacts) {
    const std::uint32_t i = candidate.vertex;
    const Surface<Real>& surface = surfaces[candidate.surface];
    const SurfacePoint<Real> point = FindContactPoint(surface, candidate, state.positions[i]);
    const double approach = double{FindApproach(surface, point, state.velocities[i])};
    const double depth = -double{point.distance};
    const double mass = double{body.masses[i]} / double{body.contactShares[i]};
    const double shaken = PredictDepth(depth, std::max(agitation, approach), duration);
    // Rates grow with the depth and fall with the mass: a contact that is neither deeper nor lighter adds nothing.
    if (shaken > deepest || mass < itsMass) {
      const ContactRates rates = FindRates(contact, shaken, mass);
      demands.rates.squareFrequency = std::max(demands.rates.squareFrequency, rates.squareFrequency);
      demands.rates.dampingRate = std::max(demands.rates.dampingRate, rates.dampingRate);
      deepest = shaken;
      itsMass = mass;
    }
    if (depth >= fade || PredictDepth(depth, approach, duration) <= -fade) continue;
    landing += double{body.masses[i]};
    fastest = std::max(fastest, approach);
  }
  if (fade > 0) demands.landing = fastest * duration / fade * std::sqrt(std::min(1.0, landing / blueprint.totalMass));
  return demands;
}

template <class Real>
Modes FindModes(const Blueprint& blueprint, const Load<Real>& load, const State<Real>& state,
                const ContactRates& fromSurfaces, const ContactRates& fromBodies) {
  const double factor = std::max({1.0, double{load.stiffnessFactor}, double{load.gasFactor}});
  Modes modes;
  modes.body.squareFrequency =
      blueprint.angularFrequency * blueprint.angularFrequency * factor * load.stiffening.squareFrequency;
  modes.body.dampingRate =
      blueprint.dampingRate * factor * load.stiffening.dampingRate + FindDragDamping(blueprint, load, state);
  const Coefficients<double>& full = blueprint.full;
  modes.body.squareFrequency +=
      load.recovery.fold * full.cells.squareFrequency + load.recovery.aim * full.aim.squareFrequency;
  if (load.recovery.fold > 0) modes.body.dampingRate += full.cells.damping;
  if (load.recovery.aim > 0) modes.body.dampingRate += full.aim.damping;
  modes.surfaces = fromSurfaces;
  modes.bodies = fromBodies;
  return modes;
}

double FindLargestRate(const Modes& modes, bool& lightlyDamped) {
  const double body = modes.body.squareFrequency;
  const double bodyDamping = modes.body.dampingRate;
  const ContactRates contact = modes.surfaces + modes.bodies;
  const double both = bodyDamping + contact.dampingRate;
  const double rate =
      std::max({FindModeRate(body, both), contact.dampingRate, FindModeRate(body + contact.squareFrequency, both),
                FindModeRate(body + contact.squareFrequency, bodyDamping)});
  lightlyDamped = both < rate * 2 / 3;  // g = 2ζω: under a third of critical
  return rate;
}

double FindSubstepsOnGround(const Blueprint& blueprint, double duration) {
  return FindSubsteps(FindModesOnGround(blueprint), duration);
}

// For RK4. Stiffer springs cost the other methods no stability: implicit Euler has them in its matrix, position Verlet
// takes them as distances.
double FindStiffnessBound(const Blueprint& blueprint, double duration) {
  const Modes atOne = FindModesOnGround(blueprint);
  double factor = kMaxStiffnessBound;
  for (; factor > 1; factor *= 0.95) {
    Modes modes = atOne;
    modes.body.squareFrequency *= factor;
    modes.body.dampingRate *= factor;
    const double substeps = blueprint.integrator == Integrator::kRungeKutta4
                                ? FindSubsteps(modes, duration)
                                : FindStableRate(blueprint.integrator, blueprint, modes) * duration;
    if (substeps <= kMaxSubsteps) return factor;
  }
  return 1;
}

template <class Real>
int ChooseSubsteps(Integrator integrator, const Blueprint& blueprint, const Load<Real>& load, const State<Real>& state,
                   const SurfaceDemands& fromSurfaces, const ContactRates& fromBodies, double duration) {
  const Modes modes = FindModes(blueprint, load, state, fromSurfaces.rates, fromBodies + fromSurfaces.rods);
  if (integrator != Integrator::kRungeKutta4) return FindRung(FindStableRate(integrator, blueprint, modes) * duration);
  return FindRung(std::max(FindSubsteps(modes, duration), fromSurfaces.landing));
}

#define WOBBLE_INSTANTIATE(Real)                                                                               \
  template SurfaceDemands FindSurfaceDemands<Real>(const Blueprint&, std::span<const Surface<Real>>,           \
                                                   const State<Real>&, double, double);                        \
  template Modes FindModes<Real>(const Blueprint&, const Load<Real>&, const State<Real>&, const ContactRates&, \
                                 const ContactRates&);                                                         \
  template int ChooseSubsteps<Real>(Integrator, const Blueprint&, const Load<Real>&, const State<Real>&,       \
                                    const SurfaceDemands&, const ContactRates&, double);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
