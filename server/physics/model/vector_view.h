// Positions or velocities of a body's vertices as a reader sees them: one after the other, as in a state, or with other
// numbers between them, as where positions and velocities lie side by side.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>

#include "server/physics/model/vector.h"

namespace wobble::physics {

// Owns nothing. A list or a span of vectors turns into one by itself.
template <class Real>
class VectorView {
 public:
  VectorView() = default;
  template <class List>
  requires std::convertible_to<const List&, std::span<const Vector3<Real>>> VectorView(const List& list)
      : VectorView(std::span<const Vector3<Real>>(list).data(), sizeof(Vector3<Real>)) {}
  // stride: bytes from each vector to the next.
  VectorView(const Vector3<Real>* first, std::size_t stride)
      : m_first(reinterpret_cast<const char*>(first)), m_stride(stride) {}

  const Vector3<Real>& operator[](std::size_t i) const {
    return *reinterpret_cast<const Vector3<Real>*>(m_first + i * m_stride);
  }

 private:
  const char* m_first = nullptr;
  std::size_t m_stride = sizeof(Vector3<Real>);
};

// Position, m, and velocity, m/s, of a vertex side by side: one line of the cache has both.
template <class Real>
struct alignas(8 * sizeof(Real)) MovingPoint {
  Vector3<Real> x;
  Real besideX = 0;  // never read for what it is
  Vector3<Real> v;
  Real besideV = 0;
};

}  // namespace wobble::physics
