// A box and a speed that bound all vertices of a body.
#pragma once

#include "server/physics/model/vector.h"

namespace wobble::physics {

template <class Real>
struct Bounds {
  Vector3<Real> low;  // low and high corner of a box that holds every vertex, local coordinates, m
  Vector3<Real> high;
  Real speed;  // of the fastest vertex, m/s
};

}  // namespace wobble::physics
