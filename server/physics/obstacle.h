// Static surfaces: planes and boxes, as signed distances.
#pragma once

#include <span>
#include <vector>

#include "server/physics/vector.h"

namespace wobble::physics {

struct Obstacle {
  enum class Kind { kPlane, kBox };
  Kind kind = Kind::kPlane;
  Vector3d normal = Vector3d::UnitZ();      // plane: outward, of unit length
  double offset = 0;                        // plane: normal · x on it, m
  Vector3d centre = Vector3d::Zero();       // box, parallel to the axes, m
  Vector3d halfExtents = Vector3d::Ones();  // box, m, each at least kMinHalfExtent
  double friction = 1;                      // times the coefficient of the body that touches it
};

// Edges and corners of boxes are rounded by this radius, m: inside a sharp box the nearest face, and with it the
// direction of the push, jumps; inside a rounded one it turns smoothly down to this depth.
inline constexpr double kEdgeRadius = 0.05;
inline constexpr double kMinHalfExtent = 2 * kEdgeRadius;

// An obstacle in a body's local coordinates and the kernel's precision, made afresh each tick: the offset is taken in
// double precision, so a body far from the world's origin loses nothing.
template <class Real>
struct Surface {
  Obstacle::Kind kind = Obstacle::Kind::kPlane;
  Vector3<Real> normal = Vector3<Real>::UnitZ();
  Real offset = 0;
  Vector3<Real> centre = Vector3<Real>::Zero();
  Vector3<Real> halfExtents = Vector3<Real>::Ones();
  Real friction = 0;  // factor on the body's coefficient
};

template <class Real>
[[nodiscard]] Surface<Real> MakeSurface(const Obstacle& obstacle, const Vector3d& origin);

template <class Real>
struct SurfacePoint {
  Real distance = 0;                              // m, negative inside
  Vector3<Real> normal = Vector3<Real>::UnitZ();  // where the distance grows fastest, unit length
};

template <class Real>
[[nodiscard]] SurfacePoint<Real> FindSurfacePoint(const Surface<Real>& surface, const Vector3<Real>& x);

}  // namespace wobble::physics
