// Vectors of the engine: metres, seconds, newtons; z is up.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products

namespace wobble::physics {

template <class Real>
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Vector3d = Vector3<double>;
using Vector3f = Vector3<float>;

}  // namespace wobble::physics
