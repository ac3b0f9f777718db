// Which faces of a body's surface lie beside one another: fixed, shared by all bodies of a blueprint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace wobble::physics {

using Face = std::array<std::uint16_t, 3>;  // vertices, counter-clockwise seen from outside

inline constexpr std::uint16_t kNoFace = 0xFFFF;

struct Topology {
  // Of each face: the face across the side opposite to its first, second, third corner; kNoFace at a border.
  std::vector<std::array<std::uint16_t, 3>> neighbours;
  // Of each of these neighbours: its corner that is not on the side; at a border the face's own.
  std::vector<std::array<std::uint16_t, 3>> across;
  std::vector<std::array<std::uint16_t, 2>> sides;  // of all faces, each once
  std::vector<std::uint16_t> vertices;              // those that belong to a face, ascending
  bool isOpen = false;  // a side without a face across it: a sheet, which has two sides to touch
  // The faces round vertex i are ring[ringBegin[i]] up to, not including, ring[ringBegin[i + 1]].
  std::vector<std::uint32_t> ringBegin;
  std::vector<std::uint16_t> ring;

  [[nodiscard]] std::span<const std::uint16_t> RingOf(std::uint16_t vertex) const {
    return std::span(ring).subspan(ringBegin[vertex], ringBegin[vertex + 1U] - ringBegin[vertex]);
  }
};

// At most 65,535 faces. A side that more than two faces share joins the first two that are consistently wound.
[[nodiscard]] Topology MakeTopology(std::span<const Face> faces, std::size_t vertexCount);

}  // namespace wobble::physics
