// What a body loses besides in its dashpots and in contacts: in its gas while the volume changes, and in rolling.
//
// Dashpots along springs hardly damp the slow motions that a body ends with. A ball of 42 vertices on the ground
// bounces at 16 rad/s with a damping ratio of 0.023, since that motion is carried by its gas, and rocks in the well of
// its facets at 4 rad/s with 0.008 (springs: 0.2). Without these losses the balls of `ball_drop` stayed awake for 34 s
// in the mean, and a mesh for 90.
//
//   gas      pressure −c_g V̇ more, c_g: Blueprint::gasViscosity. A force along ∇V, so it neither pushes nor turns the
//            body as a whole.
//   rolling  a moment −C_rr N R ω/(|ω| + u₀/R) on a body that static surfaces carry with the normal force N; R is its
//            size, ω its angular velocity. Coulomb's law of rolling resistance, by which the hysteresis of a soft
//            contact is described, made smooth below the speed u₀ at the surface.
//
// Both act once a tick, before its first substep, by solutions of their own equations: energy is never gained, whatever
// the strength and the tick, and no substep is asked for. In the stages the gas's viscosity would cost a second pass
// over the vertices, because the force is known only when the rate of the volume is.
#pragma once

#include <span>
#include <vector>

#include "server/physics/contact/obstacle.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/state.h"

namespace wobble::physics {

// u₀, m/s: what rolls slower dies out exponentially.
inline constexpr double kRollingSpeed = 0.025;

// Slows the body down by both losses. surfaces: the world's obstacles in coordinates relative to state.origin; the
// contacts are those of the last tick's end. duration: of the tick, s. scratch is overwritten; it only saves
// allocations. One pass over the faces of a body with gas, and one over the vertices of a body that is carried.
template <class Real>
void ApplyLosses(const Blueprint& blueprint, std::span<const Surface<Real>> surfaces, double duration,
                 std::vector<Real>& scratch, State<Real>& state);

}  // namespace wobble::physics
