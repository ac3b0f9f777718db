// Signed distances and normals of the five kinds of obstacle. Spheres and capsules share one formula; boxes are rounded
// so that the normal turns smoothly over edges; a height field's distance is first order (obstacle.h).
#include "server/physics/contact/obstacle.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

// The box is the inner box grown by a radius r, kEdgeRadius and more: with q = |x − c| − (half − r), the distance is
// |max(q, 0)| − r outside the inner box and max(q) − r inside it (Quilez, "Distance functions").
template <class Real>
SurfacePoint<Real> FindBoxPoint(const Surface<Real>& surface, const Vector3<Real>& x) {
  const Vector3<Real> fromCentre = x - surface.centre;
  const Vector3<Real> q = fromCentre.cwiseAbs() - surface.halfExtents;
  const Vector3<Real> outside = q.cwiseMax(Real(0));
  const Real length = std::sqrt(outside.dot(outside));
  if (length > Real(0)) {
    Vector3<Real> normal;
    for (int axis = 0; axis < 3; ++axis) normal[axis] = std::copysign(outside[axis] / length, fromCentre[axis]);
    return {length - surface.radius, normal};
  }
  int deepest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (q[axis] > q[deepest]) deepest = axis;
  }
  Vector3<Real> normal = Vector3<Real>::Zero();
  normal[deepest] = std::copysign(Real(1), fromCentre[deepest]);
  return {q[deepest] - surface.radius, normal};
}

// A sphere is a capsule whose axis has no length.
template <class Real>
SurfacePoint<Real> FindCapsulePoint(const Surface<Real>& surface, const Vector3<Real>& x) {
  Vector3<Real> from = x - surface.centre;
  const Real squaredLength = surface.axis.dot(surface.axis);
  if (squaredLength > Real(0)) {
    from -= std::clamp(from.dot(surface.axis) / squaredLength, Real(0), Real(1)) * surface.axis;
  }
  const Real length = std::sqrt(from.dot(from));
  if (length > Real(0)) return {length - surface.radius, from / length};
  return {-surface.radius, Vector3<Real>::UnitZ()};
}

// `at` clamped to the ends of a field's `nodes` along an axis, counted in nodes from the surface's own node. A NaN
// gives the first end.
template <class Real>
Real ClampToField(Real at, int node, int nodes) {
  const auto first = static_cast<Real>(-node);
  const auto last = static_cast<Real>(nodes - 1 - node);
  return at > first ? std::min(at, last) : first;
}

// Height over the body's origin and slopes at (u, v), in nodes from the surface's own node.
template <class Real>
FieldPoint<Real> FindGround(const Surface<Real>& surface, Real u, Real v) {
  const Real column = std::nearbyint(u);
  const Real row = std::nearbyint(v);
  return FindFieldPoint<Real>(*surface.field, surface.column + static_cast<int>(column),
                              surface.row + static_cast<int>(row), u - column, v - row, surface.base);
}

template <class Real>
SurfacePoint<Real> FindFieldSurfacePoint(const Surface<Real>& surface, const Vector3<Real>& x) {
  const auto cell = static_cast<Real>(surface.field->cellSize);
  const Real u = (x.x() - surface.centre.x()) / cell;
  const Real v = (x.y() - surface.centre.y()) / cell;
  if (ClampToField(u, surface.column, surface.field->columns) != u ||
      ClampToField(v, surface.row, surface.field->rows) != v) {
    return {static_cast<Real>(kBeyond), Vector3<Real>::UnitZ()};
  }
  const FieldPoint<Real> ground = FindGround(surface, u, v);
  const Vector3<Real> across(-ground.slopeX, -ground.slopeY, Real(1));
  const Real up = Real(1) / std::sqrt(across.dot(across));
  return {(x.z() - ground.height) * up - surface.radius, across * up};
}

// The larger of two lower bounds: the way to the rectangle, and the height above ground over √(1 + steepest²). Beyond
// the rectangle the ground is taken to go on level from its rim.
template <class Real>
Real FindFieldClearance(const Surface<Real>& surface, const Vector3<Real>& x) {
  const auto cell = static_cast<Real>(surface.field->cellSize);
  const Real u = (x.x() - surface.centre.x()) / cell;
  const Real v = (x.y() - surface.centre.y()) / cell;
  const Real insideU = ClampToField(u, surface.column, surface.field->columns);
  const Real insideV = ClampToField(v, surface.row, surface.field->rows);
  const auto steepest = static_cast<Real>(surface.field->steepest);
  const Real above = (x.z() - FindGround(surface, insideU, insideV).height) / std::sqrt(Real(1) + steepest * steepest);
  const Real beside = cell * std::sqrt((u - insideU) * (u - insideU) + (v - insideV) * (v - insideV));
  return (beside > Real(0) ? std::max(above, beside) : above) - surface.radius;
}

}  // namespace

template <class Real>
Surface<Real> MakeSurface(const Obstacle& obstacle, const Vector3d& origin, double radius) {
  using Kind = Obstacle::Kind;
  Surface<Real> surface;
  surface.kind = obstacle.kind;
  surface.friction = static_cast<Real>(obstacle.friction);
  const Vector3d centre = obstacle.centre - origin;
  switch (obstacle.kind) {
    case Kind::kPlane:
      surface.normal = obstacle.normal.cast<Real>();
      surface.offset = static_cast<Real>(obstacle.offset - obstacle.normal.dot(origin) + radius);
      break;
    case Kind::kBox:
      surface.centre = centre.cast<Real>();
      surface.halfExtents = (obstacle.halfExtents.array() - kEdgeRadius).matrix().cast<Real>();
      surface.radius = static_cast<Real>(kEdgeRadius + radius);
      break;
    case Kind::kCapsule:
      surface.axis = (obstacle.end - obstacle.centre).cast<Real>();
      [[fallthrough]];
    case Kind::kSphere:
      surface.centre = centre.cast<Real>();
      surface.radius = static_cast<Real>(obstacle.radius + radius);
      break;
    case Kind::kHeightField: {
      surface.field = obstacle.field.get();
      surface.radius = static_cast<Real>(radius);
      const double column = std::nearbyint(-centre.x() / surface.field->cellSize);
      const double row = std::nearbyint(-centre.y() / surface.field->cellSize);
      surface.column = static_cast<int>(column);
      surface.row = static_cast<int>(row);
      surface.base = -centre.z();
      surface.centre = (centre + surface.field->cellSize * Vector3d(column, row, 0)).template cast<Real>();
      break;
    }
  }
  return surface;
}

template <class Real>
SurfacePoint<Real> FindOtherSurfacePoint(const Surface<Real>& surface, const Vector3<Real>& x) {
  using Kind = Obstacle::Kind;
  switch (surface.kind) {
    case Kind::kPlane:
      break;
    case Kind::kBox:
      return FindBoxPoint(surface, x);
    case Kind::kSphere:
    case Kind::kCapsule:
      return FindCapsulePoint(surface, x);
    case Kind::kHeightField:
      return FindFieldSurfacePoint(surface, x);
  }
  return {surface.normal.dot(x) - surface.offset, surface.normal};
}

template <class Real>
Real FindClearance(const Surface<Real>& surface, const Vector3<Real>& x) {
  return surface.kind == Obstacle::Kind::kHeightField ? FindFieldClearance(surface, x)
                                                      : FindSurfacePoint(surface, x).distance;
}

template <class Real>
Real FindApproachToGround(const Surface<Real>& surface, const Vector3<Real>& v) {
  // The rate at which the height above ground shrinks; the distance is at most the height.
  return static_cast<Real>(surface.field->steepest) * std::sqrt(v.x() * v.x() + v.y() * v.y()) - v.z();
}

#define WOBBLE_INSTANTIATE(Real)                                                                       \
  template Surface<Real> MakeSurface<Real>(const Obstacle&, const Vector3d&, double);                  \
  template SurfacePoint<Real> FindOtherSurfacePoint<Real>(const Surface<Real>&, const Vector3<Real>&); \
  template Real FindClearance<Real>(const Surface<Real>&, const Vector3<Real>&);                       \
  template Real FindApproachToGround<Real>(const Surface<Real>&, const Vector3<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
