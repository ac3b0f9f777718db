// Bodies from triangle meshes: a closed mesh may hold gas, an open one is cloth of any cut.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

struct MeshDefinition {
  std::string name = "mesh";
  std::vector<Vector3d> vertices;  // m, once multiplied by `scale`
  std::vector<Face> faces;         // wound to look outward where the mesh is closed
  double scale = 1;
  double bend = 0.3;  // stiffness of springs across each side, which resist folding, as a share of that of the sides
  Material material{.gas = 0};
};

inline constexpr std::size_t kMaxMeshVertices = 4096;

// A fault of one face: repeated or missing vertices, no area, a side that more than two faces share, a neighbour that
// is wound the other way. face: its place in the list. what: a text that counts vertices from 1.
struct MeshFault {
  std::size_t face = 0;
  std::string what;
};
// One fault for each bad face.
[[nodiscard]] std::vector<MeshFault> FindMeshFaults(std::span<const Vector3d> vertices, std::span<const Face> faces);

// Lists every bad field of a definition; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidateMesh(const MeshDefinition& definition);

// The definition must be valid. The rest shape is that of the mesh, except for small shifts that balance the gas
// exactly.
[[nodiscard]] Blueprint MakeMesh(const MeshDefinition& definition);

}  // namespace wobble::physics
