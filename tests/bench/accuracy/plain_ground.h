// Bodies on planes with friction, written a second time: equations.h, and anchors beside them.
#pragma once

#include "server/physics/model/state.h"
#include "tests/bench/accuracy/problem.h"

namespace wobble::bench {

// Where the body of `equations` is after `duration` s, from a state with its anchors, by RK4 in so many equal steps.
// Anchors are renewed after each step: in the limit of short steps they are set where a vertex enters the ground and
// dragged as soon as it slips.
[[nodiscard]] Motion SolveOnGround(const Equations& equations, const physics::State<float>& begin, double duration,
                                   int steps);

}  // namespace wobble::bench
