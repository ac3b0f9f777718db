// Gas-filled rings in a plane: one ring of springs, or several round one another, joined radially and diagonally.
#pragma once

#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// All quantities are per metre of depth: the mass, the stiffness, the gas (nRT; its pressure is gas over area).
struct RingDefinition {
  std::string name = "ring";
  int points = 24;         // of each ring
  int layers = 1;          // rings; the gas is inside the innermost
  double radius = 0.5;     // of the outermost in equilibrium, m
  double thickness = 0.2;  // from the innermost to the outermost, m; of a single ring: not used
  Material material{.mass = 4, .stiffness = 1500, .gas = 100};
};

inline constexpr int kMaxRingPoints = 512;
inline constexpr int kMaxRingLayers = 8;

[[nodiscard]] std::vector<FieldError> ValidateRing(const RingDefinition& definition);

// The definition must be valid. Vertices ring by ring from the innermost, counter-clockwise as seen from −y. The rest
// shape is the true equilibrium of springs and gas. Faces between the rings; of a single ring, all over its inside.
[[nodiscard]] Blueprint MakeRing(const RingDefinition& definition);

}  // namespace wobble::physics
