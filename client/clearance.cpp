// A lead that went through a wall or into another body would have to come back when the records arrive. So it ends
// where the first of them is met, and the body waits there until its records have met it, too.
//
// What a body can stand on does not stop it, but lifts it; the line between the two is a slope of 45 degrees.
#include "client/clearance.h"

#include <algorithm>
#include <cmath>

namespace wobble::client {
namespace {

using protocol::Vector3;

// Soft bodies that touch are nearer than their sizes together, and bodies that touch soon count as well.
constexpr float kTouching = 1.1F;
constexpr float kMeeting = 0.95F;
constexpr float kWalkable = 0.7F;
// Places along a lead that are looked at first, so that it does not pass through a wall, and then where it ends.
constexpr float kProbe = 0.25F;
constexpr int kHalvings = 5;

// The distance to what is solid, negative inside, and how far upward its surface faces, -1 to 1.
struct Nearness {
  float distance = 0;
  float up = 0;
};

Nearness ByOffset(Vector3 offset, float radius) {
  const float length = protocol::Length(offset);
  return {length - radius, length > 0 ? offset.z / length : 1};
}

float Outside(float offset, float half) {
  return offset > half ? offset - half : offset < -half ? offset + half : 0;
}

Nearness FindBox(Vector3 offset, Vector3 half) {
  const Vector3 outside{Outside(offset.x, half.x), Outside(offset.y, half.y), Outside(offset.z, half.z)};
  if (protocol::Dot(outside, outside) > 0) return ByOffset(outside, 0);
  const float sides = std::max(std::fabs(offset.x) - half.x, std::fabs(offset.y) - half.y);
  const float ends = std::fabs(offset.z) - half.z;
  return {std::max(sides, ends), ends >= sides ? std::copysign(1.0F, offset.z) : 0};
}

Vector3 ToVector(const wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }

Nearness FindNearness(const wire::Obstacle& obstacle, Vector3 place) {
  const Vector3 a = ToVector(obstacle.a());
  const Vector3 b = ToVector(obstacle.b());
  switch (obstacle.kind()) {
    case wire::ObstacleKind::Plane:
      return {protocol::Dot(a, place) - b.x, a.z};
    case wire::ObstacleKind::Box:
      return FindBox(place - a, b);
    case wire::ObstacleKind::Sphere:
      return ByOffset(place - a, obstacle.radius());
    case wire::ObstacleKind::Capsule: {
      const Vector3 axis = b - a;
      const float length = protocol::Dot(axis, axis);
      const float along = length > 0 ? std::clamp(protocol::Dot(place - a, axis) / length, 0.0F, 1.0F) : 0;
      return ByOffset(place - a - axis * along, obstacle.radius());
    }
  }
  return {.distance = 1e9F, .up = 0};
}

// As if the ground were level here: a lead is short.
Nearness FindNearness(const Ground& ground, Vector3 place) {
  const float x = (place.x - ground.corner.x) / ground.cellSize;
  const float y = (place.y - ground.corner.y) / ground.cellSize;
  const bool isOver = x >= 0 && y >= 0 && x < static_cast<float>(ground.columns - 1) &&
                      y < static_cast<float>(ground.rows - 1);
  if (!isOver) return {.distance = 1e9F, .up = 1};
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float* node = ground.heights.data() + row * ground.columns + column;
  const float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
  const float* above = node + ground.columns;
  const float height = (1 - v) * ((1 - u) * node[0] + u * node[1]) + v * ((1 - u) * above[0] + u * above[1]);
  return {.distance = place.z - height, .up = 1};
}

float FindReach(const Surroundings& surroundings, const BodySample& other) {
  return surroundings.size + other.blueprint->size;
}

// The share of the lead after which the distance to `centre` is less than `reach`, and than it was.
float FindShare(Vector3 offset, Vector3 lead, float reach) {
  const float toward = protocol::Dot(offset, lead);
  if (toward >= 0) return 1;
  const float square = protocol::Dot(lead, lead);
  const float inside = protocol::Dot(offset, offset) - reach * reach;
  if (inside <= 0) return 0;
  const float root = toward * toward - square * inside;
  return root <= 0 ? 1 : std::clamp((-toward - std::sqrt(root)) / square, 0.0F, 1.0F);
}

// The share of the lead with which the body comes no nearer to a wall than its size, or than it was.
template <class Solid>
float FindShare(const Solid& solid, Vector3 place, Vector3 lead, float size) {
  const float least = std::min(FindNearness(solid, place).distance, size);
  const auto isFree = [&](float share) {
    const Nearness near = FindNearness(solid, place + lead * share);
    return near.up >= kWalkable || near.distance >= least - 1e-3F;
  };
  float free = 0, met = 0;
  while (free < 1 && isFree(met = free + kProbe)) free = met;
  if (free >= 1) return 1;
  for (int i = 0; i < kHalvings; ++i) {
    const float middle = 0.5F * (free + met);
    (isFree(middle) ? free : met) = middle;
  }
  return free;
}

template <class Solid>
float FindLift(const Solid& solid, Vector3 place, Vector3 lead, float size) {
  const float least = std::min(FindNearness(solid, place).distance, size);
  const Nearness near = FindNearness(solid, place + lead);
  return near.up >= kWalkable && near.distance > -size ? (least - near.distance) / near.up : 0;
}

}  // namespace

bool IsTouchingBody(const Surroundings& surroundings, Vector3 place) {
  return std::any_of(surroundings.bodies.begin(), surroundings.bodies.end(), [&](const BodySample& other) {
    return other.body != surroundings.own &&
           protocol::Length(place - other.pose.centroid) < kTouching * FindReach(surroundings, other);
  });
}

Vector3 LimitLead(const Surroundings& surroundings, Vector3 place, Vector3 lead) {
  float share = 1;
  for (const BodySample& other : surroundings.bodies) {
    if (other.body == surroundings.own) continue;
    const float reach = kMeeting * FindReach(surroundings, other);
    share = std::min(share, FindShare(place - other.pose.centroid, lead, reach));
  }
  for (const wire::Obstacle& obstacle : surroundings.obstacles) {
    share = std::min(share, FindShare(obstacle, place, lead, surroundings.size));
  }
  Vector3 limited = lead * share;
  float lift = 0;
  const auto raise = [&](const auto& solid) {
    lift = std::max(lift, FindLift(solid, place, limited, surroundings.size));
  };
  std::for_each(surroundings.obstacles.begin(), surroundings.obstacles.end(), raise);
  std::for_each(surroundings.grounds.begin(), surroundings.grounds.end(), raise);
  limited.z += lift;
  return limited;
}

}  // namespace wobble::client
