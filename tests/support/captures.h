// Captures of all bodies of a world, for tests.
#pragma once

#include <vector>

#include "server/snapshots/capture.h"

namespace wobble::test {

// Captures all bodies, moved or not, each relative to its previous capture.
inline void CaptureAll(const physics::World& world, std::vector<server::CapturedBody>& bodies) {
  bodies.resize(world.Bodies().size());
  for (std::size_t i = 0; i < bodies.size(); ++i) server::CaptureBody(world, world.Bodies()[i], bodies[i]);
}

}  // namespace wobble::test
