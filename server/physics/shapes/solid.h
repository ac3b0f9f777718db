// Solids: elastic bodies of tetrahedra, given by Young's modulus and Poisson's ratio: boxes, and what a closed triangle
// mesh encloses.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/shapes/lattice.h"

namespace wobble::physics {

// A box of `cells`, or, with faces, what these enclose.
//
// Limit: the strain is constant within a tetrahedron, so bending is too stiff: about three times with one cell across a
// slender bar, 1.34 to 1.46 times with two. Pulls, shears and changes of volume are exact.
struct SolidDefinition {
  std::string name = "solid";
  std::array<int, 3> cells{3, 3, 3};  // of a box, along x, y, z
  double cellSize = 0.25;             // edge of a cell of the body-centred lattice that the body is cut from, m
  std::vector<Vector3d> vertices;     // of a closed mesh, m, once multiplied by `scale`
  std::vector<Face> faces;            // wound to look outward
  double scale = 1;
  double youngModulus = 10000;      // E, Pa
  double poissonRatio = 0.3;        // ν
  double density = 20;              // kg/m³
  double dampingRatio = 0.1;        // of a vibration in which sound goes as far as a cell in one radian of its phase
  double friction = 0.8;            // Coulomb's coefficient, static and kinetic
  double rollingResistance = 0.03;  // moment on a body that rolls, over normal force and size
  double restitution = 0.5;         // of a single vertex on a rigid surface
  double contactStiffness = 0;      // of a vertex against a surface, N/m; 0: 4 E × cellSize
  Side fixed = Side::kNone;         // vertices on this side, of a mesh those within half a cell of its end, do not move
};

inline constexpr double kMaxPoissonRatio = 0.45;
inline constexpr std::size_t kMaxSolidVertices = 10000;

// The vertices of the body; 0 where it cannot be built.
[[nodiscard]] std::size_t CountVertices(const SolidDefinition& definition);

// Lists every bad field of a definition; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidateSolid(const SolidDefinition& definition);

// The definition must be valid. Faces lie on the outside.
[[nodiscard]] Blueprint MakeSolid(const SolidDefinition& definition);

}  // namespace wobble::physics
