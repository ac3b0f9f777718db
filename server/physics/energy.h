// The energy of a body by kind: for whoever watches a world. A step keeps no account of it.
#pragma once

#include <vector>

#include "server/physics/world.h"

namespace wobble::physics {

// J.
struct Energy {
  double kinetic = 0;
  double gravity = 0;  // −m g·x of the centre of mass: nothing at the world's origin
  double springs = 0;  // repulsion as well
  double gas = 0;      // up to a constant, see ComputeGasEnergy
};

Energy& operator+=(Energy& sum, const Energy& part);

// As the body stands after the last step, without what contacts hold. Not finite for one whose state is not.
// scratch saves allocations.
[[nodiscard]] Energy ComputeEnergy(const World& world, const Body& body, std::vector<Vector3d>& scratch);

}  // namespace wobble::physics
