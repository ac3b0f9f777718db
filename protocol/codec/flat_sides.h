// The flat sides of obstacles near a body: from these both ends predict what contact does to its shape.
//
// A body's shape follows to a large part from where it is: the part of the rest shape that would lie inside a wall has
// been pressed out of it. Only sides of planes and boxes that face the body count; spheres, capsules and height fields
// are ignored. All of it is binary32 operations in one fixed order, so both ends agree to the bit.
#pragma once

#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/messages.h"

namespace wobble::protocol {

// A flat side of an obstacle, in a body's frame: solid where normal · x + height < 0.
struct Side {
  Vector3 normal;    // of unit length, outward
  float height = 0;  // of the body's centroid above the side, m
};
inline constexpr std::size_t kMaxSides = 8;

// Finds the sides that a body of this reach (FindReach of its rest shape, m) may touch at this pose: the first
// kMaxSides at most, in the order of the obstacles. `sides` is overwritten.
void FindSides(std::span<const wire::Obstacle> obstacles, const Pose& pose, float reach, std::vector<Side>& sides);

// Moves every point (body's frame, m) that lies behind a side onto it, side after side. True when any was moved.
bool PressOut(std::span<const Side> sides, std::span<Vector3> points);

}  // namespace wobble::protocol
