// Blueprints of a scene file: the kind that a [[blueprint]] names says which fields it has.
#pragma once

#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// The field `integrator` of a scene or of a blueprint.
void ReadIntegrator(TableReader& reader, physics::Integrator& integrator);

// Adds one blueprint to the scene, also when it is wrong: what names it is then no further mistake.
void ReadBlueprint(TableReader& reader, physics::Integrator defaultIntegrator, Scene& scene);

}  // namespace wobble::scenes
