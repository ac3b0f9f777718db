// What turns a folded lattice right side out again. Springs know lengths alone, so a lattice whose corner was pushed
// through its cell, or that was mirrored as a whole, is at rest; this term knows orientations, and acts on nothing
// else. Plain code in either precision, used by every step: bodies that need it are few, and need it for a moment.
//
// Every corner of a cell has a deformation gradient F: its columns are the three edges there over the edge's length at
// rest. With singular values σ₁ ≥ σ₂ ≥ |σ₃|, of which the last is negative where the corner is inside out, the corner
// stores
//   E = K Σ f(σᵢ),   f = ½ m² up to m = s₁, then s₁ (m − ½ s₁), with m = max(0, s₀ − σ),
// so nothing acts on a cell until a corner of it is thinner than s₀ = kFoldStretch of its rest. The force draws the
// corner apart along its own thinnest direction and does not vanish in any state, also not in one that is flat, a line
// or a point. It is bounded, and ∂²E/∂F² is at most K: f'' ≤ 1, and f' ≤ 0 makes the parts that come from the turning
// of the axes negative or at most f''. Where σ₂ = −σ₃ the axis is open and E has a crest, from which a corner falls to
// one side or the other. Forces are −∂E/∂F times the edges' gradients: they sum up to zero, and, since ∂E/∂F Fᵀ is
// symmetric, so do their torques.
//
// Beside it the corner's motion is damped at the rate γ by as much as it is folded, but for what a rigid motion of its
// vertices has of it. That keeps both momenta, and what unfolds does not burst.
//
// The idea to extend a material past J = 0 by signed singular values is that of Irving, Teran & Fedkiw (2004),
// "Invertible finite elements for robust simulation of large deformation". Rejected: a penalty in J = det F alone,
// whose force vanishes in corners that are thin along two directions and grows with the square of their size; a term
// that also acts above s₀, which would make lattices another material.
//
// In a plane F has the unit vector across it as its second column, and corners have two edges.
#pragma once

#include <span>

#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

inline constexpr double kFoldStretch = 0.15;  // s₀
inline constexpr double kMostMissing = 0.3;   // s₁
// Factors on the columns of F. In a mirrored lattice all axes are as thin, and corners that chose different ones would
// fold it anew; so one axis is a little thinner than the others for all of them.
inline constexpr double kFoldWeights[] = {1, 0.99, 0.98};

// The cells of a lattice whose vertices, springs and modes are known. edge: of a cell, m. cellMass: kg (planar: of a
// metre of depth). blueprint: finished, with its grid.
[[nodiscard]] Cells<double> MakeCells(const Blueprint& blueprint, double edge, double cellMass);

// Whether a corner of any cell is thinner than s₀. For most lattices a bound on their edges answers that, in four
// operations an edge.
template <class Real>
[[nodiscard]] bool HasFolds(const Cells<Real>& cells, std::span<const Vector3<Real>> x);

// The share of the stiffness that acts at a time, s: all of it and less in turns. A tangle in which corners hold one
// another is at rest under the one and not under the other.
[[nodiscard]] double FindFoldStrength(double time);

// Adds the forces of all corners that are thinner than s₀, elastic and damping. factor multiplies the elastic ones.
template <class Real>
void AddUnfolding(const Cells<Real>& cells, Real factor, std::span<const Vector3<Real>> x,
                  std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// The energy that all corners store, J.
[[nodiscard]] double ComputeFoldEnergy(const Cells<double>& cells, std::span<const Vector3d> x);

}  // namespace wobble::physics
