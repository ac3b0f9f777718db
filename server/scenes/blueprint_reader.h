// Reads the blueprints of a scene file. The kind of a [[blueprint]] determines its fields.
#pragma once

#include <functional>
#include <string>

#include "server/scenes/obj_reader.h"
#include "server/scenes/scene.h"
#include "server/scenes/table_reader.h"

namespace wobble::scenes {

// Reads the field `integrator` of a scene or of a blueprint.
void ReadIntegrator(TableReader& reader, physics::Integrator& integrator);

// Reads one blueprint and adds it to the scene. A blueprint with mistakes is added as well, so that tables that name it
// cause no further errors. readMesh: reads a file by the name that the scene gives it.
using MeshReader = std::function<ObjMesh(const std::string& file)>;
void ReadBlueprint(TableReader& reader, const MeshReader& readMesh, physics::Integrator defaultIntegrator,
                   Scene& scene);

// Reads the required field `blueprint`, the name of a blueprint of the scene, into its index.
void ReadBlueprintName(TableReader& reader, const Scene& scene, std::size_t& blueprint);

}  // namespace wobble::scenes
