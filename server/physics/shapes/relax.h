// Relaxation of a rest shape that is nearly in balance to its equilibrium.
#pragma once

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Moves a finished blueprint's rest shape, damped and without gravity, until no coordinate accelerates faster than
// `tolerance`, m/s². The blueprint must then be finished again. Returns false when `maxSteps` steps do not suffice.
[[nodiscard]] bool RelaxRest(Blueprint& blueprint, double tolerance, int maxSteps);

}  // namespace wobble::physics
