// Blueprints of a scene file: the kind that a [[blueprint]] names says which fields it has.
#pragma once

#include <filesystem>

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// The field `integrator` of a scene or of a blueprint.
void ReadIntegrator(TableReader& reader, physics::Integrator& integrator);

// Adds one blueprint to the scene, also when it is wrong: what names it is then no further mistake. folder: the scene
// file's; files that a blueprint names are looked for from there.
void ReadBlueprint(TableReader& reader, const std::filesystem::path& folder, physics::Integrator defaultIntegrator,
                   Scene& scene);

// The field `blueprint`, which must be there: one of the scene's by its name.
void ReadBlueprintName(TableReader& reader, const Scene& scene, std::size_t& blueprint);

}  // namespace wobble::scenes
