// Rotation, stretches and rigid motion of a body that has no fixed shape.
#pragma once

#include <array>
#include <span>

#include "server/physics/model/vector.h"

namespace wobble::physics {

// The rotation nearest to the matrix A = Σ (x − c) restᵀ over the vertices of a body, x: where they are, c: their mean:
// it turns the rest shape nearest to the present one. near: where the search begins, of length 1; of a moving body its
// last rotation, from which the search takes two or three rounds. Where A leaves a choice, as for bodies on a line, the
// rotation stays as near to `near` as it can.
[[nodiscard]] Eigen::Quaterniond FindRotation(const Eigen::Matrix3d& a, const Eigen::Quaterniond& near);

using Columns = std::array<Vector3d, 3>;  // of a matrix

// The signed singular values of a matrix F and their directions; `left` and `right` are right-handed, so σ₃ has the
// sign of det F, and the rotation nearest to F is Σ uᵢ vᵢᵀ.
struct Stretches {
  std::array<double, 3> values{};  // σ₁ ≥ σ₂ ≥ |σ₃|
  Columns left;                    // uᵢ
  Columns right;                   // vᵢ: F vᵢ = σᵢ uᵢ
};
[[nodiscard]] Stretches FindStretches(const Columns& f);

// v less the rigid motion that fits it best, for points at x. masses: one a point; empty: all are equal.
void RemoveRigidMotion(std::span<const double> masses, std::span<const Vector3d> x, std::span<Vector3d> v);

}  // namespace wobble::physics
