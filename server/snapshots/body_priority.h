// How much a body matters to a client, when a snapshot's budget does not hold all bodies.
//
// The nearest bodies come in every snapshot, and get coarser (coarseness.h) before one of them is left out. The others
// share what is left by turns, each the more often the larger it looks and the faster it moves. Without a part of their
// own they would starve beside near bodies that are large.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "server/snapshots/body_captures.h"

namespace wobble::server {

// So many bodies within so many metres of a client's viewpoint come in every snapshot: the 24 that a player can follow,
// and a few more, so that one that comes near has been followed before.
inline constexpr std::size_t kNearest = 26;
inline constexpr float kNearDistance = 16;

// The distance from `from`, m, within which the kNearest nearest bodies in motion lie; at most kNearDistance. scratch:
// is overwritten. O(bodies).
[[nodiscard]] float FindNearRadius(std::span<const ShownBody> bodies, protocol::Vector3 from,
                                   std::vector<float>& scratch);

// The distance, m, at which a ball of 1 m across looks as large as a body of this size, m, does at this distance, m.
[[nodiscard]] float FindApparentDistance(float distance, float size);

// The growth of a body's priority in one snapshot that leaves it out.
[[nodiscard]] float FindGain(float apparentDistance, float speed);

}  // namespace wobble::server
