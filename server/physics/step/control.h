// What a player asks of a body, as something that acts on it.
#pragma once

#include "server/physics/methods/forces.h"
#include "server/physics/step/body.h"

namespace wobble::physics {

// Applies a jump at once and returns what else acts through the tick. state: the body's own.
template <class Real>
[[nodiscard]] Load<Real> ApplyControl(const Blueprint& blueprint, const Vector3d& gravity,
                                      const StiffnessRule& stiffness, Body& body, State<Real>& state);

}  // namespace wobble::physics
