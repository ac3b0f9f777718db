// Static obstacles of a scene.
#pragma once

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

void ReadObstacle(TableReader& reader, Scene& scene);

}  // namespace wobble::scenes
