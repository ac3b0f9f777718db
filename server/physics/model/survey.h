// What one look at all vertices of a body tells: where it is at most, how fast, its centre, its energy of motion.
//
// Whoever needs one of these in a tick needs most of them, and to read a body from memory costs more than to add it up.
// Eight vertices at a time, in the body's own precision, with AVX2 wherever it runs, so that the bits are the same
// everywhere. Sums are right to a few units in the last place, which is all that a check or a margin asks; what
// players see is summed in double precision (state.h).
#pragma once

#include <span>

#include "server/physics/model/bounds.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// Of a body as a whole.
struct BulkMotion {
  Vector3d centre = Vector3d::Zero();    // of mass, local coordinates, m
  Vector3d velocity = Vector3d::Zero();  // of that, m/s
  double kineticEnergy = 0;              // J
};

template <class Real>
struct Survey {
  BulkMotion bulk;
  Bounds<Real> bounds;
  Real agitation = 0;  // fastest that a vertex moves against the velocity, m/s
};

// At least one vertex; masses: kg, all positive. Any vertex that is no number makes the energy or the centre none.
template <class Real>
[[nodiscard]] Survey<Real> MakeSurvey(std::span<const Real> masses, std::span<const Vector3<Real>> x,
                                      std::span<const Vector3<Real>> v);
// The same bits for half the work.
template <class Real>
[[nodiscard]] BulkMotion FindBulkMotion(std::span<const Real> masses, std::span<const Vector3<Real>> x,
                                        std::span<const Vector3<Real>> v);

}  // namespace wobble::physics
