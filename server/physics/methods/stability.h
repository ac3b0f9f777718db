// The number of substeps that keeps a body stable through a tick.
//
// For one mode x'' = −ω²x − 2γ'x' RK4 is stable for hω < 2.83 without damping, and down to 2.6 at the worst damping
// (about half of critical). A body's largest ω at rest comes from a power iteration. Contacts add to it, by their
// stiffness and friction; each tick bounds this from the depth that the vertices will reach.
#pragma once

#include <span>

#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/integrator.h"
#include "server/physics/model/state.h"

namespace wobble::physics {

// RK4's limit on hρ, ρ the largest rate: at any damping, and where damping is under a third of critical.
inline constexpr double kStabilityLimit = 2.6;
inline constexpr double kStabilityLimitLightlyDamped = 2.78;

// The numbers of substeps that a tick may take: few, so that bodies with equal numbers can be stepped together.
inline constexpr int kSubstepLadder[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
inline constexpr int kMaxSubsteps = 64;

// The first rung that is at least `needed`; the last one when none is.
[[nodiscard]] int FindRung(double needed);

// Fills in angularFrequency, rad/s (power iteration on springs, tetrahedra, hinges and gas at rest, times 1.05 for
// squeezing),
// and dampingRate, 1/s. Takes longer than all other steps of finishing a blueprint.
void FindBodyStability(Blueprint& blueprint);

// Bounds of the modes of a body and of all that it may touch within a tick: squares of the largest angular frequencies,
// 1/s², and the damping rates that go with them, 1/s.
struct Modes {
  ContactRates body;
  ContactRates surfaces;
  ContactRates bodies;  // its contacts with others
};
// fromSurfaces, fromBodies: what contacts with obstacles and with other bodies add.
template <class Real>
[[nodiscard]] Modes FindModes(const Blueprint& blueprint, const Load<Real>& load, const State<Real>& state,
                              const ContactRates& fromSurfaces, const ContactRates& fromBodies);

// Substeps a second with which the method is stable for all of these modes.
[[nodiscard]] double FindStableRate(Integrator integrator, const Blueprint& blueprint, const Modes& modes);

// Substeps for a tick of `duration` s with which RK4 is stable while the body lies on a rigid surface, at any depth and
// speed.
[[nodiscard]] double FindSubstepsOnGround(const Blueprint& blueprint, double duration);

// The largest factor on stiffness and damping of the body's springs, from 1 up to kMaxStiffnessBound, with which
// kMaxSubsteps suffice on a rigid surface.
inline constexpr double kMaxStiffnessBound = 16;
[[nodiscard]] double FindStiffnessBound(const Blueprint& blueprint, double duration);

// The largest rate ρ, 1/s, over the modes of the body together with all that it touches. Sets lightlyDamped to whether
// kStabilityLimitLightlyDamped applies.
[[nodiscard]] double FindLargestRate(const Modes& modes, bool& lightlyDamped);

// What the listed contacts with static surfaces demand of a tick.
struct SurfaceDemands {
  ContactRates rates;
  ContactRates rods;   // of springs between their ends (contact/rod_contact.h)
  double landing = 0;  // substeps that resolve a landing
};
// agitation: Survey::agitation, m/s. duration: of the tick, s.
template <class Real>
[[nodiscard]] SurfaceDemands FindSurfaceDemands(const Blueprint& blueprint, std::span<const Surface<Real>> surfaces,
                                                const State<Real>& state, double agitation, double duration);

// Substeps, on the ladder, for a tick of `duration` s with which the method is stable.
template <class Real>
[[nodiscard]] int ChooseSubsteps(Integrator integrator, const Blueprint& blueprint, const Load<Real>& load,
                                 const State<Real>& state, const SurfaceDemands& fromSurfaces,
                                 const ContactRates& fromBodies, double duration);

// The rate, 1/s, that an explicit method must resolve of an oscillator with square of frequency w², 1/s², and damping
// rate g, 1/s: w while it rings, its faster decay rate g/2 + √(g²/4 − w²) once overdamped.
[[nodiscard]] double FindModeRate(double squareFrequency, double dampingRate);

}  // namespace wobble::physics
