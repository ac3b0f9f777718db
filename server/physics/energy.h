// The energy of a body by kind, computed on demand; a step keeps no account of it.
#pragma once

#include <vector>

#include "server/physics/world.h"

namespace wobble::physics {

// J.
struct Energy {
  double kinetic = 0;
  double gravity = 0;  // −m g·x of the centre of mass: zero at the world's origin
  double springs = 0;  // tetrahedra and hinges, with repulsion
  double gas = 0;      // up to a constant, as in ComputeGasEnergy
};

Energy& operator+=(Energy& sum, const Energy& part);

// Of the body as it stands after the last step, in double precision, without the energy that contacts store. Not finite
// for a body whose state is not finite. O(vertices + springs + tetrahedra + hinges). scratch saves allocations.
[[nodiscard]] Energy ComputeEnergy(const World& world, const Body& body, std::vector<Vector3d>& scratch);

}  // namespace wobble::physics
