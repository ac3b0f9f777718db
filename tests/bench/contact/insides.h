// Inside or outside of a surface, by means that have nothing to do with how the engine finds its contacts.
#pragma once

#include <vector>

#include "server/physics/model/topology.h"
#include "server/physics/model/vector.h"

namespace wobble::bench {

// How often the surface wraps round p, by solid angles (van Oosterom & Strackee 1983): 1 inside and 0 outside a closed
// one; an open one is seen under a part of a turn that changes its sign, by a whole turn, where it is crossed.
[[nodiscard]] double FindWinding(const std::vector<physics::Face>& faces, const std::vector<physics::Vector3d>& x,
                                 const physics::Vector3d& p);

// From p to the nearest point of a surface, m.
[[nodiscard]] double FindDistance(const physics::Vector3d& p, const std::vector<physics::Face>& faces,
                                  const std::vector<physics::Vector3d>& x);

// Of the points inside a closed surface, the greatest distance from it, m; 0 when there are none.
[[nodiscard]] double FindDeepestInside(const std::vector<physics::Vector3d>& points,
                                       const std::vector<physics::Face>& faces,
                                       const std::vector<physics::Vector3d>& x);

}  // namespace wobble::bench
