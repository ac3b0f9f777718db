// Where a body is at most, and how fast.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "server/physics/vector.h"

namespace wobble::physics {

template <class Real>
struct Bounds {
  Vector3<Real> low;  // corners of a box that holds every vertex, local coordinates, m
  Vector3<Real> high;
  Real speed;  // of the fastest vertex, m/s
};

// At least one vertex.
template <class Real>
[[nodiscard]] Bounds<Real> FindBounds(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v) {
  Bounds<Real> bounds{x[0], x[0], 0};
  Real squaredSpeed = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    bounds.low = bounds.low.cwiseMin(x[i]);
    bounds.high = bounds.high.cwiseMax(x[i]);
    squaredSpeed = std::max(squaredSpeed, v[i].dot(v[i]));
  }
  bounds.speed = std::sqrt(squaredSpeed);
  return bounds;
}

}  // namespace wobble::physics
