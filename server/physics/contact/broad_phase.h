// The broad phase: finds which bodies are near one another, in time linear in bodies that are apart, and the islands
// that such pairs form.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/model/vector.h"

namespace wobble::physics {

// A box parallel to the axes, in world coordinates, m.
struct Box {
  Vector3d low = Vector3d::Zero();
  Vector3d high = Vector3d::Zero();
};

// The longest side, m.
[[nodiscard]] inline double FindExtent(const Box& box) { return (box.high - box.low).maxCoeff(); }

// A box whose extent is more than this times the mean of all boxes is large: searches keep such boxes apart.
inline constexpr double kLargeRatio = 4;

// True also if the boxes only touch.
[[nodiscard]] inline bool Overlap(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

using IndexPair = std::array<std::uint32_t, 2>;  // the lower index first

// Keeps its working memory, so that it allocates nothing once warm.
class BroadPhase {
 public:
  // All pairs of boxes that overlap or touch, as indices into `boxes`, ascending, each once. Valid until the next call.
  std::span<const IndexPair> FindOverlaps(std::span<const Box> boxes);

 private:
  struct Placed {
    std::uint64_t cell;
    std::uint32_t box;
  };
  void AddPair(std::uint32_t a, std::uint32_t b);
  void AddRow(std::size_t first, std::int64_t x, std::int64_t y, std::int64_t z);

  std::span<const Box> m_boxes;
  std::vector<Placed> m_placed;  // by cell
  std::vector<std::uint32_t> m_large;
  std::vector<IndexPair> m_pairs;
};

// Islands: the connected components of bodies under pairs. Islands are ordered by their least member, members are
// ascending; a body without a pair is an island of its own.
class Islands {
 public:
  // bodies: ascending. pairs: each of two of these bodies.
  void Find(std::span<const std::uint32_t> bodies, std::span<const IndexPair> pairs);

  [[nodiscard]] std::size_t Count() const { return m_begins.size() - 1; }
  [[nodiscard]] std::size_t CountMembers() const { return m_members.size(); }
  [[nodiscard]] std::span<const std::uint32_t> MembersOf(std::size_t island) const {
    return std::span(m_members).subspan(m_begins[island], m_begins[island + 1] - m_begins[island]);
  }
  [[nodiscard]] std::uint32_t IslandOf(std::uint32_t member) const { return m_islandOf[member]; }

 private:
  std::vector<std::uint32_t> m_begins{0};
  std::vector<std::uint32_t> m_members;
  std::vector<std::uint32_t> m_islandOf;  // by body; undefined for bodies that Find was not given
};

}  // namespace wobble::physics
