// Backward Euler, one linear system a step (Baraff & Witkin 1998): with f and its Jacobians at the step's beginning,
//   (M − h ∂f/∂v − h² ∂f/∂x) Δv = h (f + h ∂f/∂x v),  v' = v + Δv,  x' = x + h v'.
//
// Newton's method to the end would be the same order (1) for two to five factorisations a step, and far from the
// solution it needs a search along its direction: a step whose cost depends on the state is no step for play.
//
// Any symmetric matrix in place of ∂f/∂x keeps the order; stability asks that it is definite and no softer than half of
// the truth. So:
//   springs    k [d dᵀ + max(0, 1 − r/l)(1 − d dᵀ)] and c d dᵀ: a spring under pressure pushes its ends aside, which
//              is left out (Choi & Ko 2002);
//   gas        nRT/V² ∇V ∇Vᵀ, of rank one, by Sherman & Morrison: dense it would fill the whole matrix. (P − P₀) ∂²V
//              is left out: it is not definite, and at rest the tension of the skin outweighs it;
//   contacts   slope, damping, stick spring and its dashpot, those two by what Coulomb's limit leaves of them.
// Everything else that accelerates, other bodies among it, enters by its force alone and bounds the step as it did.
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

// Solvers of the last topologies seen, by their pattern: analysing one is done once, and costs as much as some steps.
template <class Real>
struct ImplicitScratch {
  std::vector<std::shared_ptr<ImplicitSolver<Real>>> solvers;
  std::size_t oldest = 0;
};

// Steps one body, whose blueprint has a pattern. a: its accelerations at x and v, m/s². All three of this body alone.
// A topology met before costs no allocation up to 5,461 vertices; beyond, Eigen puts its work arrays on the heap.
template <class Real>
void StepImplicitEuler(Real h, const SteppedBody<Real>& body, std::span<const Vector3<Real>> a,
                       std::span<Vector3<Real>> x, std::span<Vector3<Real>> v, ImplicitScratch<Real>& scratch);

}  // namespace wobble::physics
