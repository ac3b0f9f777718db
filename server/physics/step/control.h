// Turns what a player asks of a body into what acts on the body.
#pragma once

#include "server/physics/methods/forces.h"
#include "server/physics/step/body.h"

namespace wobble::physics {

// Call once a tick for a body that is awake. Applies a jump to the state's velocities at once, moves the body's gas and
// stiffness factors towards what the control asks, and returns the load of this tick, without wind and pushes.
// gravity: m/s²; state: the body's own, which the returned load refers to.
template <class Real>
[[nodiscard]] Load<Real> ApplyControl(const Blueprint& blueprint, const Vector3d& gravity,
                                      const StiffnessRule& stiffness, Body& body, State<Real>& state);

}  // namespace wobble::physics
