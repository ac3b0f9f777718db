// Tells inside from outside of a surface by a method independent of the engine's contact search.
#pragma once

#include <vector>

#include "server/physics/world.h"

namespace wobble::bench {

// Winding number of the surface about p, by solid angles (van Oosterom & Strackee 1983). A closed surface gives 1
// inside and 0 outside. An open surface gives a fraction that jumps by 1 where p crosses it.
[[nodiscard]] double FindWinding(const std::vector<physics::Face>& faces, const std::vector<physics::Vector3d>& x,
                                 const physics::Vector3d& p);

// Distance from p to the nearest point of a surface, m.
[[nodiscard]] double FindDistance(const physics::Vector3d& p, const std::vector<physics::Face>& faces,
                                  const std::vector<physics::Vector3d>& x);

// The greatest depth of the points that lie inside a closed surface, m; 0 when none does.
[[nodiscard]] double FindDeepestInside(const std::vector<physics::Vector3d>& points,
                                       const std::vector<physics::Face>& faces,
                                       const std::vector<physics::Vector3d>& x);

// For every body the greatest depth of a vertex under a static surface or inside another closed body, over the body's
// size. Takes as long as several ticks.
[[nodiscard]] std::vector<float> ListDepths(const physics::World& world);

}  // namespace wobble::bench
