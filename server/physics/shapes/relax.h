// From a shape that is nearly in balance to the one that is.
#pragma once

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Damped motion of a finished blueprint's rest shape towards equilibrium, without gravity, until no coordinate
// accelerates faster than `tolerance`, m/s². The blueprint must be finished again. False when that has not come about
// in `maxSteps` steps.
[[nodiscard]] bool RelaxRest(Blueprint& blueprint, double tolerance, int maxSteps);

}  // namespace wobble::physics
