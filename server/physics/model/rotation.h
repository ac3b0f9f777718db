// The rotation of a body that has no fixed shape.
#pragma once

#include "server/physics/model/vector.h"

namespace wobble::physics {

// The rotation nearest to the matrix A = Σ (x − c) restᵀ over the vertices of a body, x: where they are, c: their mean:
// it turns the rest shape nearest to the present one. near: where the search begins, of length 1; of a moving body its
// last rotation, from which the search takes two or three rounds. Where A leaves a choice, as for bodies on a line, the
// rotation stays as near to `near` as it can.
[[nodiscard]] Eigen::Quaterniond FindRotation(const Eigen::Matrix3d& a, const Eigen::Quaterniond& near);

}  // namespace wobble::physics
