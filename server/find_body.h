// Bodies by numbers that somebody else says, which need not exist.
#pragma once

#include <algorithm>

#include "server/physics/world.h"

namespace wobble::server {

// nullptr when there is none of this number.
[[nodiscard]] inline const physics::Body* FindBody(const physics::World& world, physics::BodyId id) {
  const auto bodies = world.Bodies();
  const auto found =
      std::lower_bound(bodies.begin(), bodies.end(), id,
                       [](const physics::Body& body, physics::BodyId wanted) { return body.id < wanted; });
  return found != bodies.end() && found->id == id ? &*found : nullptr;
}

}  // namespace wobble::server
