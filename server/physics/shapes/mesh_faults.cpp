// Finds the faults of a triangle mesh before a body is built from it.
#include <array>
#include <map>

#include "server/physics/shapes/mesh.h"

namespace wobble::physics {
namespace {

constexpr double kMinArea = 1e-12;  // as a share of the square of the longest side

std::string NameVertex(std::size_t vertex) { return std::to_string(vertex + 1); }

// The fault of a face by itself; empty when it has none.
std::string FindFault(std::span<const Vector3d> vertices, const Face& face) {
  for (const std::uint16_t vertex : face) {
    if (vertex >= vertices.size()) return "has vertex " + NameVertex(vertex) + " of " + std::to_string(vertices.size());
  }
  const auto& [a, b, c] = face;
  if (a == b || b == c || c == a) return "has vertex " + NameVertex(a == b ? a : c) + " twice";
  const Vector3d ab = vertices[b] - vertices[a];
  const Vector3d ac = vertices[c] - vertices[a];
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ab - ac).squaredNorm()});
  if (!(ab.cross(ac).norm() > kMinArea * longest)) return "has no area";
  return {};
}

}  // namespace

std::vector<MeshFault> FindMeshFaults(std::span<const Vector3d> vertices, std::span<const Face> faces) {
  std::vector<MeshFault> faults;
  // From a side, in the direction in which a face walks it, to the first face that does.
  std::map<std::array<std::uint16_t, 2>, std::size_t> sides;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::string what = FindFault(vertices, faces[f]);
    for (std::size_t side = 0; side < 3 && what.empty(); ++side) {
      const std::uint16_t a = faces[f][side];
      const std::uint16_t b = faces[f][(side + 1) % 3];
      const auto taken = sides.find({a, b});
      if (taken == sides.end()) continue;
      const std::string name = NameVertex(a) + "-" + NameVertex(b);
      what = sides.contains({b, a}) ? "is the third on side " + name : "is wound against its neighbour on side " + name;
    }
    if (!what.empty()) {
      faults.push_back({f, std::move(what)});
      continue;
    }
    for (std::size_t side = 0; side < 3; ++side) sides.insert({{faces[f][side], faces[f][(side + 1) % 3]}, f});
  }
  return faults;
}

}  // namespace wobble::physics
