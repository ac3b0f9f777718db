// A lead that went through a wall or into another body would have to come back when the records arrive. So it ends
// where it meets one, and the body waits there until its records have met it, too.
//
// What is met pushes the body out of itself, by the shortest way: that depends continuously on both places, so nothing
// jumps on the screen. To cut the lead where its line meets something was tried: a body that crossed the line made the
// lead jump by as much as a body's width.
#include "client/clearance.h"

#include <algorithm>

namespace wobble::client {
namespace {

using protocol::Vector3;

// Soft bodies that touch are nearer than their sizes together.
constexpr float kMeeting = 0.95F;
// A surface that faces upward by more than this is ground, and no wall.
constexpr float kWalkable = 0.7F;
// Metres of depth that are none.
constexpr float kTolerance = 1e-3F;
constexpr float kFar = 1e6F;

// The distance to what is solid, negative inside, and the direction away from it.
struct Nearness {
  float distance = 0;
  Vector3 away;
};

Nearness FindRound(Vector3 offset, float radius) {
  const float length = protocol::Length(offset);
  return {length - radius, length > 0 ? offset * (1 / length) : Vector3{0, 0, 1}};
}

float FindOutside(float offset, float half) { return offset - std::clamp(offset, -half, half); }

// Whatever is inside is as deep as can be.
Nearness FindBox(Vector3 offset, Vector3 half) {
  const Vector3 outside{FindOutside(offset.x, half.x), FindOutside(offset.y, half.y), FindOutside(offset.z, half.z)};
  Nearness nearness = FindRound(outside, 0);
  if (!(nearness.distance > 0)) nearness.distance = -kFar;
  return nearness;
}

Vector3 ToVector(const wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }

[[gnu::noinline]] Nearness FindNearness(const wire::Obstacle& obstacle, Vector3 place) {
  const Vector3 a = ToVector(obstacle.a());
  const Vector3 b = ToVector(obstacle.b());
  switch (obstacle.kind()) {
    case wire::ObstacleKind::Plane:
      return {protocol::Dot(a, place) - b.x, a};
    case wire::ObstacleKind::Box:
      return FindBox(place - a, b);
    case wire::ObstacleKind::Sphere:
      return FindRound(place - a, obstacle.radius());
    case wire::ObstacleKind::Capsule:
      break;
  }
  const Vector3 axis = b - a;
  const float square = protocol::Dot(axis, axis);
  const float along = square > 0 ? std::clamp(protocol::Dot(place - a, axis) / square, 0.0F, 1.0F) : 0;
  return FindRound(place - a - axis * along, obstacle.radius());
}

// As if the ground were level here: a lead is short.
[[gnu::noinline]] Nearness FindNearness(const Ground& ground, Vector3 place) {
  const float x = (place.x - ground.corner.x) / ground.cellSize;
  const float y = (place.y - ground.corner.y) / ground.cellSize;
  const bool isOver =
      x >= 0 && y >= 0 && x < static_cast<float>(ground.columns - 1) && y < static_cast<float>(ground.rows - 1);
  if (!isOver) return {kFar, {0, 0, 1}};
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
  const float* node = ground.heights.data() + row * ground.columns + column;
  const float* above = node + ground.columns;
  const float height = (1 - v) * ((1 - u) * node[0] + u * node[1]) + v * ((1 - u) * above[0] + u * above[1]);
  return {place.z - height, {0, 0, 1}};
}

// kept: the distance that is to be kept, unless the body is nearer at `place` already.
[[gnu::noinline]] void PushOut(const Nearness& before, const Nearness& after, float kept, Vector3& lead) {
  const float depth = std::min(before.distance, kept) - after.distance;
  if (depth <= kTolerance) return;
  if (depth > kept) {
    lead = {};
    return;
  }
  const bool isGround = after.away.z > kWalkable;
  if (isGround && before.away.z > kWalkable) {
    lead.z += depth / after.away.z;
  } else {
    lead = lead + (isGround ? before.away : after.away) * depth;  // beside a floor, or below it, nothing leads onto it
  }
}

}  // namespace

Vector3 ClearLead(const Surroundings& surroundings, Vector3 place, Vector3 lead) {
  for (const BodySample& other : surroundings.bodies) {
    if (other.body == surroundings.own) continue;
    const Vector3 offset = place - other.pose.centroid;
    PushOut(FindRound(offset, 0), FindRound(offset + lead, 0), kMeeting * (surroundings.size + other.blueprint->size),
            lead);
  }
  const auto clear = [&](const auto& solid) {
    PushOut(FindNearness(solid, place), FindNearness(solid, place + lead), surroundings.size, lead);
  };
  std::for_each(surroundings.obstacles.begin(), surroundings.obstacles.end(), clear);
  std::for_each(surroundings.grounds.begin(), surroundings.grounds.end(), clear);
  return lead;
}

}  // namespace wobble::client
