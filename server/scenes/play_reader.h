// The tables [hands], [tuning], [workshop] and [game] of a scene.
#pragma once

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// After the scene's blueprints and bodies.
void ReadPlayRules(TableReader& reader, Scene& scene);

}  // namespace wobble::scenes
