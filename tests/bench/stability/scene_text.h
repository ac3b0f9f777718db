// A random world as the text of a scene, so that what befalls it is a recording that the server's programs open.
#pragma once

#include "server/scenes/loader.h"
#include "tests/bench/stability/random_world.h"

namespace wobble::bench {

// The blueprints, ground and wind of a world in which nothing has happened yet. Bodies, drives and gravity are left
// out: they are in a recording's first keyframe. Numbers stand there to the bit.
[[nodiscard]] scenes::SceneSource WriteScene(const RandomWorld& world, const std::string& name);

}  // namespace wobble::bench
