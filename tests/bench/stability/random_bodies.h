// Draws random bodies of every kind that a scene can have, within the ranges that scenes allow.
#pragma once

#include <string>

#include "server/scenes/blueprint_definition.h"
#include "tests/bench/random.h"

namespace wobble::bench {

struct RandomBody {
  scenes::BlueprintDefinition definition;
  physics::Blueprint blueprint;  // of the definition
  std::string description;       // shape and material, for people
  int refused = 0;               // earlier draws whose material Validate refused
};

// vertices: approximate count, 1 to 642.
[[nodiscard]] RandomBody DrawBody(Random& random, std::size_t vertices);

}  // namespace wobble::bench
