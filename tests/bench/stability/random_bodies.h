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
  // Highest impact speed that leaves every lattice cell uninverted, m/s; for other bodies above any speed in the
  // trials.
  double bearableSpeed = 0;
  int refused = 0;  // earlier draws whose material Validate refused
  int crushed = 0;  // earlier draws whose gas could not carry the load
};

// The gas, nRT in J (for a ring per metre of depth), above which a shell is not crushed flat by `mass` kg, its own or
// resting on it, under `gravity` m/s².
[[nodiscard]] double FindCarryingGas(double mass, double gravity, double reach);

// vertices: approximate count, 1 to 642. gravity: under which the gas must carry the body, m/s²; 0: no such
// requirement.
[[nodiscard]] RandomBody DrawBody(Random& random, std::size_t vertices, double gravity);

}  // namespace wobble::bench
