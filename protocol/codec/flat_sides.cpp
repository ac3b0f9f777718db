#include "protocol/codec/flat_sides.h"

#include <algorithm>
#include <array>

namespace wobble::protocol {
namespace {

Vector3 FromWire(const wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }

// The side of a box that faces the point. False unless the point is outside along exactly one axis: before an edge or a
// corner no side faces it.
bool FindBoxSide(const wire::Obstacle& box, Vector3 point, Side& side) {
  const Vector3 way = point - FromWire(box.a());
  const std::array<float, 3> along{way.x, way.y, way.z};
  const std::array<float, 3> half{box.b().x(), box.b().y(), box.b().z()};
  int outside = 0;
  std::size_t axis = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::fabs(along[i]) <= half[i]) continue;
    ++outside;
    axis = i;
  }
  if (outside != 1) return false;
  std::array<float, 3> normal{};
  normal[axis] = along[axis] < 0 ? -1.0F : 1.0F;
  side = {{normal[0], normal[1], normal[2]}, std::fabs(along[axis]) - half[axis]};
  return true;
}

bool FindSide(const wire::Obstacle& obstacle, Vector3 point, Side& side) {
  if (obstacle.kind() == wire::ObstacleKind::Box) return FindBoxSide(obstacle, point, side);
  if (obstacle.kind() != wire::ObstacleKind::Plane) return false;
  side.normal = FromWire(obstacle.a());
  side.height = Dot(side.normal, point) - obstacle.b().x();
  return side.height >= 0;
}

}  // namespace

void FindSides(std::span<const wire::Obstacle> obstacles, const Pose& pose, float reach, std::vector<Side>& sides) {
  sides.clear();
  const Quaternion inverse = Conjugate(pose.rotation);
  for (const wire::Obstacle& obstacle : obstacles) {
    Side side;
    if (!FindSide(obstacle, pose.centroid, side) || !(side.height < reach)) continue;
    side.normal = Rotate(inverse, side.normal);
    sides.push_back(side);
    if (sides.size() == kMaxSides) return;
  }
}

bool PressOut(std::span<const Side> sides, std::span<Vector3> points) {
  bool moved = false;
  for (const Side& side : sides) {
    for (Vector3& point : points) {
      const float height = Dot(point, side.normal) + side.height;
      if (!(height < 0)) continue;
      point = point - side.normal * height;
      moved = true;
    }
  }
  return moved;
}

}  // namespace wobble::protocol
