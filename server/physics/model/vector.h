// The vectors of the engine. SI units; z is up.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products

namespace wobble::physics {

template <class Real>
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Vector3d = Vector3<double>;
using Vector3f = Vector3<float>;

// The part of v that is tangential to a surface with this unit normal.
template <class Real>
[[nodiscard]] Vector3<Real> RemoveNormalPart(const Vector3<Real>& v, const Vector3<Real>& normal) {
  return v - normal.dot(v) * normal;
}

}  // namespace wobble::physics
