// Gas-filled balls: an icosphere of springs around an ideal gas.
#pragma once

#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

struct BallDefinition {
  std::string name = "ball";
  int subdivisions = 2;  // n = 0…kMaxSubdivisions: 10·4ⁿ + 2 vertices, so 12, 42, 162, 642, 2562, 10242
  double radius = 0.5;   // in equilibrium, m
  Material material;
};

inline constexpr int kMaxSubdivisions = 5;
[[nodiscard]] constexpr std::size_t CountVertices(int subdivisions) {
  return 10 * (std::size_t{1} << (2 * subdivisions)) + 2;
}

struct Icosphere {
  std::vector<Vector3d> vertices;  // on the unit sphere
  std::vector<Face> faces;         // wound to look outward
  std::vector<std::array<std::uint16_t, 2>> edges;
};
// A regular icosahedron whose faces are cut into four `subdivisions` times, with the new vertices put on the sphere.
[[nodiscard]] Icosphere MakeIcosphere(int subdivisions);

// Lists every bad field of a definition with its value and range; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidateBall(const BallDefinition& definition);

// The definition must be valid. The rest shape is the true equilibrium of springs and gas.
[[nodiscard]] Blueprint MakeBall(const BallDefinition& definition);

}  // namespace wobble::physics
