#include "server/physics/obstacle.h"

#include <cmath>

namespace wobble::physics {

template <class Real>
Surface<Real> MakeSurface(const Obstacle& obstacle, const Vector3d& origin) {
  Surface<Real> surface;
  surface.kind = obstacle.kind;
  surface.friction = static_cast<Real>(obstacle.friction);
  if (obstacle.kind == Obstacle::Kind::kPlane) {
    surface.normal = obstacle.normal.cast<Real>();
    surface.offset = static_cast<Real>(obstacle.offset - obstacle.normal.dot(origin));
  } else {
    surface.centre = (obstacle.centre - origin).cast<Real>();
    surface.halfExtents = (obstacle.halfExtents.array() - kEdgeRadius).matrix().cast<Real>();
  }
  return surface;
}

// The box is the inner box grown by kEdgeRadius: with q = |x − c| − (half − r), the distance is |max(q, 0)| − r outside
// the inner box and max(q) − r inside it (Quilez, "Distance functions").
template <class Real>
SurfacePoint<Real> FindSurfacePoint(const Surface<Real>& surface, const Vector3<Real>& x) {
  if (surface.kind == Obstacle::Kind::kPlane) return {surface.normal.dot(x) - surface.offset, surface.normal};

  const Vector3<Real> fromCentre = x - surface.centre;
  const Vector3<Real> q = fromCentre.cwiseAbs() - surface.halfExtents;
  const Vector3<Real> outside = q.cwiseMax(Real(0));
  const Real length = std::sqrt(outside.dot(outside));
  if (length > Real(0)) {
    Vector3<Real> normal;
    for (int axis = 0; axis < 3; ++axis) normal[axis] = std::copysign(outside[axis] / length, fromCentre[axis]);
    return {length - static_cast<Real>(kEdgeRadius), normal};
  }
  int deepest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (q[axis] > q[deepest]) deepest = axis;
  }
  Vector3<Real> normal = Vector3<Real>::Zero();
  normal[deepest] = std::copysign(Real(1), fromCentre[deepest]);
  return {q[deepest] - static_cast<Real>(kEdgeRadius), normal};
}

template Surface<float> MakeSurface<float>(const Obstacle&, const Vector3d&);
template Surface<double> MakeSurface<double>(const Obstacle&, const Vector3d&);
template SurfacePoint<float> FindSurfacePoint<float>(const Surface<float>&, const Vector3<float>&);
template SurfacePoint<double> FindSurfacePoint<double>(const Surface<double>&, const Vector3<double>&);

}  // namespace wobble::physics
