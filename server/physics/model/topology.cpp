// Faces meet where one goes along a side from begin to end and another from end to begin.
#include "server/physics/model/topology.h"

#include <cassert>
#include <map>

namespace wobble::physics {
namespace {

void FillRings(std::span<const Face> faces, std::size_t vertexCount, Topology& topology) {
  topology.ringBegin.assign(vertexCount + 1, 0);
  for (const Face& face : faces) {
    for (const std::uint16_t vertex : face) ++topology.ringBegin[vertex + 1U];
  }
  for (std::size_t i = 0; i < vertexCount; ++i) {
    if (topology.ringBegin[i + 1] > 0 || faces.empty()) topology.vertices.push_back(static_cast<std::uint16_t>(i));
    topology.ringBegin[i + 1] += topology.ringBegin[i];
  }
  topology.ring.resize(topology.ringBegin.back());
  std::vector<std::uint32_t> next(topology.ringBegin.begin(), topology.ringBegin.end() - 1);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const std::uint16_t vertex : faces[f]) topology.ring[next[vertex]++] = static_cast<std::uint16_t>(f);
  }
}

}  // namespace

Topology MakeTopology(std::span<const Face> faces, std::size_t vertexCount) {
  assert(faces.size() < kNoFace);
  Topology topology;
  topology.neighbours.assign(faces.size(), {kNoFace, kNoFace, kNoFace});
  topology.across.assign(faces.begin(), faces.end());
  struct Side {
    std::uint16_t face;
    std::uint16_t corner;  // opposite to the side
  };
  // Sides without a neighbour yet, by {begin, end} in the winding of their face.
  std::map<std::array<std::uint16_t, 2>, Side> open;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::uint16_t corner = 0; corner < 3; ++corner) {
      const std::uint16_t begin = faces[f][(corner + 1U) % 3];
      const std::uint16_t end = faces[f][(corner + 2U) % 3];
      const auto face = static_cast<std::uint16_t>(f);
      const auto twin = open.find({end, begin});
      if (twin == open.end()) {
        open.insert({{begin, end}, {face, corner}});
        topology.sides.push_back({begin, end});
        continue;
      }
      const Side& other = twin->second;
      topology.neighbours[f][corner] = other.face;
      topology.neighbours[other.face][other.corner] = face;
      topology.across[f][corner] = faces[other.face][other.corner];
      topology.across[other.face][other.corner] = faces[f][corner];
      open.erase(twin);
    }
  }
  topology.isOpen = !open.empty() || faces.empty();
  FillRings(faces, vertexCount, topology);
  return topology;
}

}  // namespace wobble::physics
