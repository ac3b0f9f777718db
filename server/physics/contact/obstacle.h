// Static obstacles and their surfaces as signed distances: planes, boxes, spheres, capsules, ground given by heights.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/physics/contact/height_field.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

struct Obstacle {
  enum class Kind { kPlane, kBox, kSphere, kCapsule, kHeightField };
  Kind kind = Kind::kPlane;
  Vector3d normal = Vector3d::UnitZ();  // plane: outward, of unit length
  double offset = 0;                    // plane: normal · x of its points, m
  // Centre of a box, which is parallel to the axes, or of a sphere; capsule: one end of its axis; height field: the
  // first corner of its rectangle, at height 0. World coordinates, m.
  Vector3d centre = Vector3d::Zero();
  Vector3d halfExtents = Vector3d::Ones();             // box, m, each at least kMinHalfExtent
  double friction = 1;                                 // factor on the coefficient of the body that touches it
  Vector3d end = Vector3d::Zero();                     // capsule: the other end of its axis, m
  double radius = 1;                                   // sphere, capsule, m, at least kMinRadius
  std::shared_ptr<const HeightField> field = nullptr;  // height field: solid below it, nothing beyond its rectangle
};

// Edges and corners of boxes are rounded by this radius, m: inside a sharp box the nearest face, and with it the
// direction of the push, jumps; inside a rounded one it turns smoothly down to this depth.
inline constexpr double kEdgeRadius = 0.05;
inline constexpr double kMinHalfExtent = 2 * kEdgeRadius;
inline constexpr double kMinRadius = 2 * kEdgeRadius;

// An obstacle in a body's local coordinates and the kernel's precision, made afresh each tick. The offset to the body
// is taken in double precision, so a body far from the world's origin loses nothing. The obstacle owns the field.
template <class Real>
struct Surface {
  Obstacle::Kind kind = Obstacle::Kind::kPlane;
  Vector3<Real> normal = Vector3<Real>::UnitZ();
  Real offset = 0;
  Vector3<Real> centre = Vector3<Real>::Zero();  // height field: x and y of the node (column, row)
  Vector3<Real> halfExtents = Vector3<Real>::Ones();
  Real friction = 0;                           // factor on the body's coefficient
  Vector3<Real> axis = Vector3<Real>::Zero();  // capsule: from `centre` to its other end
  Real radius = 0;                             // sphere, capsule; of a box's edges; by which ground stands out
  const HeightField* field = nullptr;
  int column = 0;  // of the node nearest to the body's origin; may lie outside of the field
  int row = 0;
  double base = 0;  // height of the body's origin over the field's height 0, m
};

// origin: of the body's local coordinates, in the world, m. radius: of the body's vertices, m; the surface stands out
// by it, so that balls meet it as points meet this surface (ground: to the first order of its slope).
template <class Real>
[[nodiscard]] Surface<Real> MakeSurface(const Obstacle& obstacle, const Vector3d& origin, double radius = 0);

template <class Real>
struct SurfacePoint {
  Real distance = 0;                              // m, negative inside
  Vector3<Real> normal = Vector3<Real>::UnitZ();  // where the distance grows fastest, unit length
};

// The signed distance of x from the surface and the normal there. The distance from a height field is the height above
// it times normal.z, right to the first order: at a distance d from ground whose radius of curvature is r it is off by
// about d²/r, and further away it says little. Beyond the field's rectangle, which has no walls, it is kBeyond.
template <class Real>
[[nodiscard]] SurfacePoint<Real> FindOtherSurfacePoint(const Surface<Real>& surface, const Vector3<Real>& x);
template <class Real>
[[nodiscard]] inline SurfacePoint<Real> FindSurfacePoint(const Surface<Real>& surface, const Vector3<Real>& x) {
  // Nearly all contacts are with planes, and for a plane a call would take longer than the answer.
  if (surface.kind != Obstacle::Kind::kPlane) return FindOtherSurfacePoint(surface, x);
  return {surface.normal.dot(x) - surface.offset, surface.normal};
}
inline constexpr double kBeyond = 1e6;  // m

// A lower bound of the distance from x to any point of the surface, m; at most 0 inside.
template <class Real>
[[nodiscard]] Real FindClearance(const Surface<Real>& surface, const Vector3<Real>& x);

template <class Real>
[[nodiscard]] Real FindApproachToGround(const Surface<Real>& surface, const Vector3<Real>& v);
// Upper bound of the speed at which the distance shrinks for a vertex that goes straight on at v from `point`, m/s. For
// a convex obstacle that is the present speed; ground may rise in the way.
template <class Real>
[[nodiscard]] inline Real FindApproach(const Surface<Real>& surface, const SurfacePoint<Real>& point,
                                       const Vector3<Real>& v) {
  if (surface.kind != Obstacle::Kind::kHeightField) return -point.normal.dot(v);
  return FindApproachToGround(surface, v);
}

}  // namespace wobble::physics
