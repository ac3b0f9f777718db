// Captures of a whole world, for tests that look at all of it.
#pragma once

#include <vector>

#include "server/snapshots/capture.h"

namespace wobble::test {

// All bodies anew, whether they have moved or not, each from what it was before.
inline void CaptureAll(const physics::World& world, std::vector<server::CapturedBody>& bodies) {
  bodies.resize(world.Bodies().size());
  for (std::size_t i = 0; i < bodies.size(); ++i) server::CaptureBody(world, world.Bodies()[i], bodies[i]);
}

}  // namespace wobble::test
