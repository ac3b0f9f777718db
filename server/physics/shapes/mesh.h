// Bodies from triangle meshes: closed ones hold gas, open ones are cloth of any cut.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

struct MeshDefinition {
  std::string name = "mesh";
  std::vector<Vector3d> vertices;  // times `scale`: m
  std::vector<Face> faces;         // outward where closed
  double scale = 1;
  double bend = 0.3;  // stiffness of springs across each side, which resist folding, as a share of the sides'
  Material material{.gas = 0};
};

inline constexpr std::size_t kMaxMeshVertices = 4096;

// What is wrong with a mesh's faces: repeated or missing vertices, no area, sides that more than two faces share,
// neighbours that are wound against each other. One line for each bad face, by its place in the list; vertices are
// counted from 1.
struct MeshFault {
  std::size_t face = 0;
  std::string what;
};
[[nodiscard]] std::vector<MeshFault> FindMeshFaults(std::span<const Vector3d> vertices, std::span<const Face> faces);

[[nodiscard]] std::vector<FieldError> ValidateMesh(const MeshDefinition& definition);

// The definition must be valid. The rest shape is the mesh's own but for what balancing the gas exactly may ask.
[[nodiscard]] Blueprint MakeMesh(const MeshDefinition& definition);

}  // namespace wobble::physics
