// Verlet's method on positions, springs as distances to be kept (Jakobsen 2001, "Advanced character physics").
//
// x' = x + (x − x_before) + a h², with a from all forces but springs. Then each spring in turn moves its two ends to
// its rest length, each end by its share of inverse mass, in a few sweeps. Stiffness and dashpots do not appear: the
// stretch that is left depends on the numbers of sweeps, substeps and springs in a row. The state's v is (x −
// x_before)/h, so v is corrected along with x; computed as a difference of positions it would lose four digits of a
// float. Order 1.
//
// Springs that hold gas are stretched at rest; kept at their rest lengths they would crush it. So the springs of a body
// with gas are kept at the lengths that they have in the rest shape.
#pragma once

#include <span>

#include "server/physics/methods/stepped_body.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// Sweeps a step. At 60 steps a second a chain of 20 links that hangs from one end is stretched by 60 % with 1 sweep,
// 13 % with 4, 6.4 % with 8.
inline constexpr int kRelaxationSweeps = 8;

// Moves the ends of all whole springs, Gauss–Seidel, in the order of the springs. h: the step, s. x, v: of this body
// alone.
template <class Real>
void RelaxSprings(Real h, const SteppedBody<Real>& body, int sweeps, std::span<Vector3<Real>> x,
                  std::span<Vector3<Real>> v);

}  // namespace wobble::physics
