// Pairs: two masses on one spring, the least that wobbles.
#pragma once

#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

struct PairDefinition {
  std::string name = "pair";
  double length = 1;             // of the spring at rest, m
  Vector3d direction{1, 0, 0};   // from the first mass to the second, of any length
  bool firstIsFixed = false;     // it then stays where the body is put, and the second swings about it
  Material material{.mass = 2};  // the mass is shared by both; there is no gas and nothing to drag at
};

[[nodiscard]] std::vector<FieldError> ValidatePair(const PairDefinition& definition);

// The definition must be valid. Vertex 0 is the first mass, 1 the second.
[[nodiscard]] Blueprint MakePair(const PairDefinition& definition);

}  // namespace wobble::physics
