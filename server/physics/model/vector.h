// The vectors of the engine. SI units; z is up.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <cstdint>

#ifdef __aarch64__
// Sums in the order of x86, where no vector is narrower than four floats, so that three are added one by one. On ARM
// Eigen would add two of them in a vector of two. Doubles have the same order on both.
template <int Size>
struct Eigen::internal::find_best_packet_helper<Size, Eigen::internal::Packet4f, false> {
  using type = Eigen::internal::Packet4f;
};
#endif

namespace wobble::physics {

template <class Real>
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Vector3d = Vector3<double>;
using Vector3f = Vector3<float>;

// A force on one vertex from outside, N, for example from a hand that drags it.
template <class Real>
struct VertexForce {
  std::uint16_t vertex = 0;
  Vector3<Real> force = Vector3<Real>::Zero();
};

// The part of v that is tangential to a surface with this unit normal.
template <class Real>
[[nodiscard]] Vector3<Real> RemoveNormalPart(const Vector3<Real>& v, const Vector3<Real>& normal) {
  return v - normal.dot(v) * normal;
}

}  // namespace wobble::physics
