// Which bodies are near one another, in time linear in bodies that are apart.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/vector.h"

namespace wobble::physics {

// Parallel to the axes, in the world, m.
struct Box {
  Vector3d low = Vector3d::Zero();
  Vector3d high = Vector3d::Zero();
};

using IndexPair = std::array<std::uint32_t, 2>;  // the lower index first

// All pairs of boxes that overlap or touch, ascending, each once; `pairs` is reused.
void FindOverlaps(std::span<const Box> boxes, std::vector<IndexPair>& pairs);

// Sets of bodies that hang together by pairs: members[begins[g]] up to members[begins[g + 1]] is group g. Groups are
// ordered by their least member, members ascending; a body without a pair is a group of its own.
struct Groups {
  std::vector<std::uint32_t> begins;
  std::vector<std::uint32_t> members;

  [[nodiscard]] std::size_t Count() const { return begins.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> MembersOf(std::size_t group) const {
    return std::span(members).subspan(begins[group], begins[group + 1] - begins[group]);
  }
};
// `groups` is reused.
void FindGroups(std::size_t count, std::span<const IndexPair> pairs, Groups& groups);

}  // namespace wobble::physics
