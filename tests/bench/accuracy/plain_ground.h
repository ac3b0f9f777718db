// A second, independent implementation of bodies on planes with friction: equations.h plus friction anchors.
#pragma once

#include "server/physics/model/state.h"
#include "tests/bench/accuracy/problem.h"

namespace wobble::bench {

// Solves from `begin`, with its anchors, for `duration` s in `steps` equal RK4 steps. Anchors are updated after each
// step: in the limit of short steps, an anchor is set where a vertex enters the ground and is dragged as soon as it
// slips.
[[nodiscard]] Motion SolveOnGround(const Equations& equations, const physics::State<float>& begin, double duration,
                                   int steps);

}  // namespace wobble::bench
