// Cloths: a sheet of masses on a grid with structural, shear and bend springs, or with hinges that resist bending.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Horizontal: in the plane of x and y, its top edge the one at the largest y. Vertical: in the plane of x and z, its
// top edge the uppermost.
enum class Orientation : std::uint8_t { kHorizontal, kVertical };
// Which vertices are fixed. A clamp holds two rows, so that the sheet cannot turn about its edge.
enum class Pinned : std::uint8_t { kNone, kCorners, kTopCorners, kEdge, kFrame, kClamp };

struct ClothDefinition {
  std::string name = "cloth";
  std::array<int, 2> points{20, 20};  // along x, and downwards (horizontal: towards −y)
  double spacing = 0.1;               // of the points, m
  Orientation orientation = Orientation::kVertical;
  Pinned pinned = Pinned::kNone;
  double shear = 0.5;  // stiffness of a square's diagonals, as a share of that of its sides
  double bend = 0.1;   // the same of springs across two squares, which resist folding
  // Flexural rigidity D, J = N·m: the moment on each metre of width over the curvature (methods/bending.h), the same in
  // every direction. Of a plate of thickness t it is E t³/12. 0: bending costs nothing but what `bend` does.
  double bendStiffness = 0;
  double tearStretch = 0;  // springs tear when longer than this times their rest length; 0: never
  Material material{.mass = 1, .stiffness = 300, .drag = 0.6};  // no gas
};

inline constexpr int kMaxClothPoints = 100;  // along either side

// Lists every bad field of a definition; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidateCloth(const ClothDefinition& definition);

// The definition must be valid. Vertices run along x, row by row from the top. Faces look up; of a vertical cloth
// towards −y. Every side of a face has a spring.
[[nodiscard]] Blueprint MakeCloth(const ClothDefinition& definition);

}  // namespace wobble::physics
