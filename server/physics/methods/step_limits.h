// How large a step each of the methods bears, and so how many substeps a second a mode asks for.
//
// A limit is that of one mode x'' = −w²x − g x', with both eigenvalues of the step's matrix inside the unit circle
// (Jury 1964). With z = hw and d = hg:
//   explicit Euler            z² < d and, overdamped, the faster decay rate times h < 2: never without damping;
//   semi-implicit Euler,
//   leap-frog, position Verlet z² + 2d < 4: the same recursion, read at different moments;
//   velocity Verlet           z² (1 + q) < 4 (1 + q²) and d < 4, with q = 1 − d/2;
//   RK4                       |1 + μ + μ²/2 + μ³/6 + μ⁴/24| < 1 for both roots of μ² + dμ + z² = 0;
//   implicit Euler            none.
#pragma once

#include "server/physics/model/integrator.h"

namespace wobble::physics {

// The theory: the largest step, s, with which no mode of that square of an angular frequency, 1/s², and damping rate,
// 1/s, grows. 0: every step lets it grow; infinity: none does. For position Verlet, of modes other than its springs'.
[[nodiscard]] double FindLargestStep(Integrator integrator, double squareFrequency, double dampingRate);

// Substeps a second to step such a mode with. Never infinite: explicit Euler, which no step makes stable without
// damping, takes those of semi-implicit Euler and grows as it does. RK4 keeps the margins of kStabilityLimit.
[[nodiscard]] double FindStableRate(Integrator integrator, double squareFrequency, double dampingRate);

}  // namespace wobble::physics
