#include "server/snapshots/body_priority.h"

#include <algorithm>
#include <cmath>

namespace wobble::server {
namespace {

// The size (Blueprint::size, half of its breadth) of the ball of 1 m that apparent distances compare with, m.
constexpr float kTypicalSize = 0.5F;
constexpr float kLeastSize = 0.01F;  // a single particle has none

// A body's priority grows by kFarShare + 1 / (1 + (d / kHalfDistance)²) a snapshot, at an apparent distance of d
// metres, so that the farthest is sent every fifth time that a near one is.
constexpr float kHalfDistance = 8;
constexpr float kFarShare = 0.25F;
// A body this fast, m/s, is sent twice as often as one that hardly moves; a faster one no more often.
constexpr float kDoubleSpeed = 4;

}  // namespace

float FindNearRadius(std::span<const ShownBody> bodies, protocol::Vector3 from, std::vector<float>& scratch) {
  constexpr float kMost = kNearDistance * kNearDistance;
  scratch.clear();
  for (const ShownBody& body : bodies) {
    const protocol::Vector3 way = body.centre - from;
    const float square = protocol::Dot(way, way);
    if (square <= kMost && body.restTick == 0) scratch.push_back(square);
  }
  if (scratch.size() <= kNearest) return kNearDistance;
  const auto last = scratch.begin() + static_cast<std::ptrdiff_t>(kNearest);  // the own body does not count
  std::nth_element(scratch.begin(), last, scratch.end());
  return std::sqrt(*last);
}

float FindApparentDistance(float distance, float size) { return distance * kTypicalSize / std::max(size, kLeastSize); }

float FindGain(float apparentDistance, float speed) {
  const float ratio = apparentDistance / kHalfDistance;
  return (kFarShare + 1.0F / (1.0F + ratio * ratio)) * (1.0F + std::min(speed / kDoubleSpeed, 1.0F));
}

}  // namespace wobble::server
