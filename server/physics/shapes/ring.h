// Gas-filled rings in a plane: one ring of springs, or several concentric ones, joined radially and diagonally.
#pragma once

#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// All quantities are per metre of depth: mass, stiffness, gas (nRT; its pressure is nRT over the area).
struct RingDefinition {
  std::string name = "ring";
  int points = 24;         // of each ring
  int layers = 1;          // number of rings; the gas is inside the innermost
  double radius = 0.5;     // of the outermost ring in equilibrium, m
  double thickness = 0.2;  // from the innermost to the outermost ring, m; not used with a single ring
  Material material{.mass = 4, .stiffness = 1500, .gas = 100};
};

inline constexpr int kMaxRingPoints = 512;
inline constexpr int kMaxRingLayers = 8;

// Lists every bad field of a definition; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidateRing(const RingDefinition& definition);

// The definition must be valid. Vertices run ring by ring from the innermost, counter-clockwise as seen from −y. The
// rest shape is the exact equilibrium of springs and gas. Faces lie between the rings; those of a single ring cover its
// inside.
[[nodiscard]] Blueprint MakeRing(const RingDefinition& definition);

}  // namespace wobble::physics
