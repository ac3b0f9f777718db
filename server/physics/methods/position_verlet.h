// Verlet's method on positions, springs as distances to be kept (Jakobsen 2001, "Advanced character physics").
//
// x' = x + (x − x_before) + a h², with a of all forces but springs; then each spring in turn moves its two ends to its
// rest length, each by its share of inverse mass, a few sweeps over. Stiffness and dashpots do not appear: what is left
// of a stretch goes with the number of sweeps, substeps and springs in a row. The state's v is (x − x_before)/h, so v
// is corrected along with x; as a difference of positions it would lose four digits of a float. Order 1.
//
// Springs that hold gas in are stretched at rest. Kept at their rest lengths they would crush it, so those of a body
// with gas are kept as long as they are in the rest shape.
#pragma once

#include <span>

#include "server/physics/methods/stepped_body.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// Sweeps a step. A chain of 20 links hanging from one end, 60 steps a second, is stretched by 60 % with 1, 13 % with 4,
// 6.4 % with 8.
inline constexpr int kRelaxationSweeps = 8;

// Gauss–Seidel in the order of the springs. x, v: of this body alone.
template <class Real>
void RelaxSprings(Real h, const SteppedBody<Real>& body, int sweeps, std::span<Vector3<Real>> x,
                  std::span<Vector3<Real>> v);

}  // namespace wobble::physics
