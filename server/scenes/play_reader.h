// Reads the tables [hands], [tuning], [workshop] and [game] of a scene.
#pragma once

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// Reads all four tables. The blueprints and bodies have been read.
void ReadPlayRules(TableReader& reader, Scene& scene);

}  // namespace wobble::scenes
