// Reads the drives of a scene: periodic forces, gas and wind.
#pragma once

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// Reads one [[drive]] and adds it to the scene. The blueprints have been read.
void ReadDrive(TableReader& reader, Scene& scene);

}  // namespace wobble::scenes
