// One pass over all vertices of a body: its bounds, centre, velocity and kinetic energy.
//
// A tick needs most of these at once, and reading a body from memory costs more than adding it up. The pass takes 8
// vertices at a time in single and 4 in double precision, with AVX2 on every processor, so that the bits are the same
// everywhere. Sums are right to a few units in the last place, which is enough for a check or a margin; values that
// players see are summed in double precision (state.h).
#pragma once

#include <span>

#include "server/physics/model/bounds.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// The motion of a body as a whole.
struct BulkMotion {
  Vector3d centre = Vector3d::Zero();    // of mass, local coordinates, m
  Vector3d velocity = Vector3d::Zero();  // of the centre, m/s
  double kineticEnergy = 0;              // J
};

template <class Real>
struct Survey {
  BulkMotion bulk;
  Bounds<Real> bounds;
  Real agitation = 0;  // largest speed of a vertex against bulk.velocity, m/s
};

// x, v: of all vertices, at least one. masses: kg, all positive. A NaN in any vertex makes the energy or the centre
// NaN.
template <class Real>
[[nodiscard]] Survey<Real> MakeSurvey(std::span<const Real> masses, std::span<const Vector3<Real>> x,
                                      std::span<const Vector3<Real>> v);
// Survey::bulk alone: the same bits for half the work.
template <class Real>
[[nodiscard]] BulkMotion FindBulkMotion(std::span<const Real> masses, std::span<const Vector3<Real>> x,
                                        std::span<const Vector3<Real>> v);

}  // namespace wobble::physics
