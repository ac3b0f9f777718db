// The largest stable step of each method, and from it the substeps a second that a mode needs.
//
// A limit is that of one mode x'' = −w²x − g x': up to it both eigenvalues of the step's matrix lie inside the unit
// circle (Jury 1964). With z = hw and d = hg:
//   explicit Euler            z² < d and, overdamped, h times the faster decay rate < 2; unstable without damping;
//   semi-implicit Euler,
//   leap-frog, position Verlet z² + 2d < 4; all three are the same recursion, read at different moments;
//   velocity Verlet           z² (1 + q) < 4 (1 + q²) and d < 4, with q = 1 − d/2;
//   RK4                       |1 + μ + μ²/2 + μ³/6 + μ⁴/24| < 1 for both roots of μ² + dμ + z² = 0;
//   implicit Euler            none.
#pragma once

#include "server/physics/model/integrator.h"

namespace wobble::physics {

// The largest step, s, in theory, with which a mode of this square of an angular frequency, 1/s², and damping rate,
// 1/s, does not grow. 0: it grows with every step; infinity: it never grows. For position Verlet, of modes other than
// those of its springs.
[[nodiscard]] double FindLargestStep(Integrator integrator, double squareFrequency, double dampingRate);

// Substeps a second for such a mode. Always finite: explicit Euler, which no step makes stable without damping, gets
// those of semi-implicit Euler, and grows. RK4 keeps the margins of kStabilityLimit.
[[nodiscard]] double FindStableRate(Integrator integrator, double squareFrequency, double dampingRate);

}  // namespace wobble::physics
