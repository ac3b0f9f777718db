// Bending of sheets that are flat at rest and whose vertices stand in a grid of squares: an angle spring at every
// vertex along each row and each column, and one for the twist of every square. Plain code in either precision, the
// reference for the lanes.
//
// A thin plate of flexural rigidity D, J, without coupling across the bend (ν = 0) stores
//   E = D/2 ∫ (u_xx² + u_yy² + 2 u_xy²) dA,
// which is the same in every direction, since the sum in it is the square of a tensor's norm. On a grid of spacing h
// the derivatives are differences, h² u_xx ≈ x₋ − 2 x₀ + x₊ and h² u_xy ≈ x₀₀ − x₁₀ − x₀₁ + x₁₁, and a square of area
// h² belongs to each. So
//   E = Σ ½ k |δ|² over all hinges (model/hinge.h), k = D/h² along rows and columns, k = 2 D/h² in squares.
// Differences of positions, not of heights over a plane: δ turns with the sheet and does not change as it moves, so E
// holds for any turn and any fold. Two sides that keep their length h and meet at the angle θ have |δ| = 2 h sin(θ/2),
// and the hinge is the angle spring E = D (1 − cos θ), of torque D sin θ for each h of width: D κ for a small curvature
// κ = θ/h, and gentler towards a sharp fold, with no angle at which it jumps. Even stretch and shear in the plane cost
// nothing (δ stays 0).
//
// All sums together are D times the square of the five-point Laplacian: waves of length λ along a row have the
// frequency of a plate's less (π h/λ)²/3 of it, at 45° less half as much. The forces −∂E/∂x are linear in x. So the
// stiffness is the same in every state, at most 64 D/h² for a vertex, and what the power iteration finds at rest
// (stability.h) bounds it for good; there is neither a root nor a quotient in them.
//
// The idea to write bending as a quadratic energy with constant coefficients is that of Bergou, Wardetzky, Harmon,
// Zorin & Grinspun (2006), "A quadratic bending model for inextensible surfaces". Rejected: their weights for the two
// triangles at an edge, and the hinges of Grinspun, Hirani, Desbrun & Schröder (2003), "Discrete shells", 3 |e|²/A
// (θ − θ₀)². On squares that are cut into triangles only one edge in three sees a bend along a row, with a third of the
// area: the sheet is 3 times as stiff as D. With weights that are right for this, a bend at 45° is 1.5 times too stiff
// where the cuts alternate, 1 or 3 times where they are parallel. Finer grids change none of it. The grid's own
// differences are right in every direction, and cheaper.
//
// Damping: −c (δ·δ̇) δ/(|δ|² + δ₀²) as a part of each hinge's tension. Along δ only, like a spring's dashpot: a sheet
// that turns as a whole is not slowed, and forces add up to no force and no torque. In a flat sheet δ has no direction,
// hence δ₀, the bend at an angle of kFlatAngle: below it damping sets in smoothly.
#pragma once

#include <span>

#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// The angle of δ₀: half of the damping acts where two sides meet at this angle.
inline constexpr double kFlatAngle = 0.005;

// Adds the forces of all hinges. floorSquare: δ₀², m². stiffnessFactor multiplies stiffness and damping.
template <class Real>
void AddHinges(std::span<const Hinge<Real>> hinges, Real floorSquare, Real stiffnessFactor,
               std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// The energy stored in all hinges, J; 0 for a flat sheet and never below.
[[nodiscard]] double ComputeBendingEnergy(const Coefficients<double>& body, std::span<const Vector3d> x);

}  // namespace wobble::physics
