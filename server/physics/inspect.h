// What acts on each vertex of a body, kind by kind: for whoever wants to look at it. Computed when it is asked for and
// never else.
#pragma once

#include <vector>

#include "server/physics/model/vector.h"

namespace wobble::physics {

// Of each vertex, in the world's directions. All kinds of force together are what the equations of motion hold: times
// the inverse mass they are the acceleration, but for fixed vertices, which have none, and for what is across the plane
// of a planar body.
struct InspectedForces {
  std::vector<Vector3d> elastic;        // of springs as stiff as they are now, and repulsion, N
  std::vector<Vector3d> damping;        // of dashpots, N
  std::vector<Vector3d> gas;            // puffed up as it is now, less the ambient pressure, N
  std::vector<Vector3d> weight;         // N
  std::vector<Vector3d> contact;        // with what stands still and with other bodies, N
  std::vector<Vector3d> other;          // drag of the medium, drives, pushes, and moving as the player asks, N
  std::vector<Vector3d> accelerations;  // m/s²
};

}  // namespace wobble::physics
