// The forces on each vertex of a body, kind by kind, for display. Computed on demand; a step keeps no account of them.
#pragma once

#include <vector>

#include "server/physics/model/vector.h"
#include "server/physics/step/body.h"

namespace wobble::physics {

class World;

// One entry a vertex, in world directions. The kinds of force add up to what the equations of motion hold: the sum
// times the inverse mass is the acceleration, except for fixed vertices, which have none, and across the plane of a
// planar body.
struct InspectedForces {
  std::vector<Vector3d> elastic;        // springs, tetrahedra and hinges as stiff as now, and repulsion, N
  std::vector<Vector3d> damping;        // dashpots, and the losses with which the next tick begins, N
  std::vector<Vector3d> gas;            // with the present puff, less the ambient pressure, N
  std::vector<Vector3d> weight;         // N
  std::vector<Vector3d> contact;        // with obstacles and other bodies, N
  std::vector<Vector3d> other;          // drag of the medium, drives, step forces, and moving as the player asks, N
  std::vector<Vector3d> accelerations;  // m/s²
};

// The forces on a body that exists, as it stands after the last step, with the loads of that step; before the body's
// first step, with gravity and the world's wind alone. Costs about one evaluation of the body's forces in plain code,
// and a pass over the world's pairs.
[[nodiscard]] InspectedForces InspectForces(const World& world, BodyId id);

}  // namespace wobble::physics
