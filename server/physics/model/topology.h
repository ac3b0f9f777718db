// The adjacency of the faces of a body's skin: fixed, shared by all bodies of a blueprint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace wobble::physics {

using Face = std::array<std::uint16_t, 3>;  // vertices, counter-clockwise seen from outside

using EdgeEnds = std::array<std::uint16_t, 2>;  // vertices
// The corners of the two faces at an edge that are not its ends; of a border the only one, twice.
using EdgeWings = std::array<std::uint16_t, 2>;

inline constexpr std::uint16_t kNoFace = 0xFFFF;

struct Topology {
  // By face: the face across the side opposite to its first, second, third corner; kNoFace at a border.
  std::vector<std::array<std::uint16_t, 3>> neighbours;
  // By face, for each of these neighbours: its corner that is not on the side; at a border the face's own corner.
  std::vector<std::array<std::uint16_t, 3>> across;
  std::vector<EdgeEnds> sides;          // the sides of all faces, each once
  std::vector<std::uint16_t> vertices;  // the vertices of all faces, ascending; of a body without faces, all
  bool isOpen = false;  // some side has no face across it: a sheet, which can be touched from both sides; or no faces
  // The faces round vertex i are ring[ringBegin[i]] up to, but not including, ring[ringBegin[i + 1]].
  std::vector<std::uint32_t> ringBegin;
  std::vector<std::uint16_t> ring;

  [[nodiscard]] std::span<const std::uint16_t> RingOf(std::uint16_t vertex) const {
    return std::span(ring).subspan(ringBegin[vertex], ringBegin[vertex + 1U] - ringBegin[vertex]);
  }
};

// faces: fewer than 65,535, of vertices below vertexCount. If more than two faces share a side, the first two that are
// consistently wound become neighbours.
[[nodiscard]] Topology MakeTopology(std::span<const Face> faces, std::size_t vertexCount);

}  // namespace wobble::physics
