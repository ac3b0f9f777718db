// How many substeps a body needs this tick so that RK4 stays stable.
//
// For one mode x'' = −ω²x − 2γ'x' RK4 is stable while hω < 2.83 without damping, and down to 2.6 at the worst damping
// (about half of critical). A body's largest ω at rest comes from a power iteration; what it touches, how hard and
// with how much friction adds to it and is bounded each tick from the depth that its vertices will reach.
#pragma once

#include <span>

#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/integrator.h"
#include "server/physics/model/state.h"

namespace wobble::physics {

// RK4's limit on hρ: over every damping, and where damping is under a third of critical.
inline constexpr double kStabilityLimit = 2.6;
inline constexpr double kStabilityLimitLightlyDamped = 2.78;

// Substeps a tick may take: few distinct numbers, so that bodies with equal numbers can be stepped together.
inline constexpr int kSubstepLadder[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
inline constexpr int kMaxSubsteps = 64;

// The first rung that is at least `needed`; the last one when none is.
[[nodiscard]] int FindRung(double needed);

// Fills angularFrequency (power iteration on springs and gas at rest, times 1.05 for squeezing) and dampingRate.
void FindBodyStability(Blueprint& blueprint);

// The modes of a body with everything it may touch within a tick: squares of the largest angular frequencies, 1/s², and
// the damping rates that go with them, 1/s.
struct Modes {
  ContactRates body;
  ContactRates surfaces;
  ContactRates bodies;  // its contacts with others
};
// fromSurfaces, fromBodies: what its contacts add.
template <class Real>
[[nodiscard]] Modes FindModes(const Blueprint& blueprint, const Load<Real>& load, const State<Real>& state,
                              const ContactRates& fromSurfaces, const ContactRates& fromBodies);

// Substeps a second with which the method is stable for all of them.
[[nodiscard]] double FindStableRate(Integrator integrator, const Blueprint& blueprint, const Modes& modes);

// Substeps for a tick of `duration` seconds with which RK4 is stable while the body lies on a rigid surface, as deep in
// it and as fast as may be.
[[nodiscard]] double FindSubstepsOnGround(const Blueprint& blueprint, double duration);

// How many times stiffer and more damped its springs may become, from 1 up to kMaxStiffnessBound, so that no more
// substeps are needed on a rigid surface than there are.
inline constexpr double kMaxStiffnessBound = 16;
[[nodiscard]] double FindStiffnessBound(const Blueprint& blueprint, double duration);

// The largest rate ρ, 1/s, over the modes of the body with all that it touches at once.
[[nodiscard]] double FindLargestRate(const Modes& modes, bool& lightlyDamped);

// What the listed contacts with static surfaces ask of a tick.
struct SurfaceDemands {
  ContactRates rates;
  double landing = 0;  // substeps
};
// agitation: Survey's.
template <class Real>
[[nodiscard]] SurfaceDemands FindSurfaceDemands(const Blueprint& blueprint, std::span<const Surface<Real>> surfaces,
                                                const State<Real>& state, double agitation, double duration);

// Substeps for a tick of `duration` seconds with which the method is stable.
template <class Real>
[[nodiscard]] int ChooseSubsteps(Integrator integrator, const Blueprint& blueprint, const Load<Real>& load,
                                 const State<Real>& state, const SurfaceDemands& fromSurfaces,
                                 const ContactRates& fromBodies, double duration);

// What an oscillator with square of frequency w² and damping rate g asks of an explicit method: ω while it rings,
// its fast decay rate g/2 + √(g²/4 − w²) once overdamped.
[[nodiscard]] double FindModeRate(double squareFrequency, double dampingRate);

}  // namespace wobble::physics
