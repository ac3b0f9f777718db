// Bodies drawn by chance, of every kind that a scene can have and within what its author is bound by.
#pragma once

#include <string>

#include "server/scenes/body_definition.h"
#include "tests/bench/random.h"

namespace wobble::bench {

struct RandomBody {
  physics::Blueprint blueprint;
  std::string description;  // shape and material, for people
  // Of an impact that leaves every cell of a lattice as it was, m/s; of all else, beyond any that comes.
  double bearableSpeed = 0;
  int refused = 0;  // materials that Validate refused before this one
  int crushed = 0;  // and those whose gas would not have carried them
};

// Above this a skin is not crushed flat by `mass` kg that lie on it or are its own, under `gravity` m/s²: nRT, J. Per
// metre of depth of a ring.
[[nodiscard]] double FindCarryingGas(double mass, double gravity, double reach);

// vertices: about how many, 1 to 642. gravity: what its gas must carry it against, m/s²; 0: whatever it may be.
[[nodiscard]] RandomBody DrawBody(Random& random, std::size_t vertices, double gravity);

}  // namespace wobble::bench
