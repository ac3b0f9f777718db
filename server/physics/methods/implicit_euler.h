// Backward Euler, one linear system a step (Baraff & Witkin 1998): with f and its Jacobians at the step's beginning,
//   (M − h ∂f/∂v − h² ∂f/∂x) Δv = h (f + h ∂f/∂x v),  v' = v + Δv,  x' = x + h v'.
//
// Newton's method to convergence would have the same order (1) at two to five factorisations a step, and needs a line
// search far from the solution. Its cost would depend on the state, which does not suit play.
//
// Any symmetric matrix in place of ∂f/∂x keeps the order; stability needs one that is definite and at least half as
// stiff as the exact one. Hence the terms:
//   springs    k [d dᵀ + max(0, 1 − r/l)(1 − d dᵀ)] and c d dᵀ. The term by which a compressed spring pushes its ends
//              aside is left out (Choi & Ko 2002);
//   gas        nRT/V² ∇V ∇Vᵀ, of rank one, by Sherman & Morrison: written out it would fill the whole matrix.
//              (P − P₀) ∂²V is left out: it is not definite, and at rest the tension of the skin outweighs it;
//   contacts   slope, damping, and, scaled by what Coulomb's limit leaves of them, stick spring and its dashpot.
// All other forces, those of other bodies among them, enter by their value alone and bound the step as in an explicit
// method.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/physics/methods/stepped_body.h"
#include "server/physics/model/sparse_pattern.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

template <class Real>
class ImplicitSolver;

// Solvers of the last topologies seen, by their sparse pattern: a pattern is analysed once, at the cost of a few steps.
template <class Real>
struct ImplicitScratch {
  std::vector<std::shared_ptr<ImplicitSolver<Real>>> solvers;
  std::size_t oldest = 0;
};

// Steps one body, whose blueprint has a sparse pattern, by h s. a: its accelerations at x and v, m/s². x, v and a hold
// this body alone. A topology seen before costs no allocation up to 5,461 vertices; beyond, Eigen puts its work arrays
// on the heap.
template <class Real>
void StepImplicitEuler(Real h, const SteppedBody<Real>& body, std::span<const Vector3<Real>> a,
                       std::span<Vector3<Real>> x, std::span<Vector3<Real>> v, ImplicitScratch<Real>& scratch);

}  // namespace wobble::physics
