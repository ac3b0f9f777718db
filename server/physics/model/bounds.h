// Where a body is at most, and how fast.
#pragma once

#include "server/physics/model/vector.h"

namespace wobble::physics {

template <class Real>
struct Bounds {
  Vector3<Real> low;  // corners of a box that holds every vertex, local coordinates, m
  Vector3<Real> high;
  Real speed;  // of the fastest vertex, m/s
};

}  // namespace wobble::physics
