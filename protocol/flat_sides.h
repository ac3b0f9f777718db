// Level ground and walls as both ends know them from the welcome, for guessing what contact does to a shape.
//
// A body's shape follows to a good part from where it stands: what of the rest shape would be inside a wall has been
// pressed out of it. Only flat sides count, seen from a body that stands before them; spheres, capsules and height
// fields are passed over. Everything is one fixed order of binary32 operations, so both ends agree to the bit.
#pragma once

#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/messages.h"

namespace wobble::protocol {

// A flat side near a body, in the body's frame: solid where normal · x + height < 0.
struct Side {
  Vector3 normal;
  float height = 0;  // of the body's centroid above it, m
};
inline constexpr std::size_t kMaxSides = 8;

// The sides that a body of this reach (the greatest distance of a rest vertex, m) may touch at this pose, at most
// kMaxSides, in the order of the obstacles.
void FindSides(std::span<const wire::Obstacle> obstacles, const Pose& pose, float reach, std::vector<Side>& sides);

// Moves every point that is inside a side onto it, side after side. True when any was moved.
bool PressOut(std::span<const Side> sides, std::span<Vector3> points);

}  // namespace wobble::protocol
