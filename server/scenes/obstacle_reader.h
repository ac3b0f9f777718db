// Reads the static obstacles of a scene.
#pragma once

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// Reads one [[obstacle]] and adds it to the scene; one without a usable kind or height field is not added.
void ReadObstacle(TableReader& reader, Scene& scene);

}  // namespace wobble::scenes
