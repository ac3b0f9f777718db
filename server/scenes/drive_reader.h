// Drives of a scene: what acts on its bodies by the clock.
#pragma once

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// After the blueprints, one of which it may name.
void ReadDrive(TableReader& reader, Scene& scene);

}  // namespace wobble::scenes
