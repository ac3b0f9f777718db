// Pairs: two masses on one spring, the smallest soft body. Its motion is known in closed form.
#pragma once

#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

struct PairDefinition {
  std::string name = "pair";
  double length = 1;             // of the spring at rest, m
  Vector3d direction{1, 0, 0};   // from the first mass to the second, of any length
  double radius = 0.03;          // of the masses and the spring, which meet other bodies as balls and a capsule, m
  bool firstIsFixed = false;     // the first mass then stays where the body is put, and the second swings about it
  Material material{.mass = 2};  // half of the mass for each; gas and drag are not used
};

// Lists every bad field of a definition; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidatePair(const PairDefinition& definition);

// The definition must be valid. Vertex 0 is the first mass, vertex 1 the second.
[[nodiscard]] Blueprint MakePair(const PairDefinition& definition);

}  // namespace wobble::physics
