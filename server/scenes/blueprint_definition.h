// The definition of a blueprint, which is a body of any kind. A new kind is one more alternative, and one more overload
// per function in blueprint_definition.cpp.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/mesh.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/shapes/ring.h"
#include "server/physics/shapes/solid.h"

namespace wobble::scenes {

using BlueprintDefinition =
    std::variant<physics::BallDefinition, physics::LatticeDefinition, physics::PairDefinition, physics::RingDefinition,
                 physics::ClothDefinition, physics::GraphDefinition, physics::MeshDefinition, physics::SolidDefinition>;

[[nodiscard]] const std::string& NameOf(const BlueprintDefinition& definition);
// The vertices of a body made from the definition.
[[nodiscard]] std::size_t CountVertices(const BlueprintDefinition& definition);

// Lists all fields of the definition that are out of range; empty when the body can be built.
[[nodiscard]] std::vector<physics::FieldError> Validate(const BlueprintDefinition& definition);

// Builds the blueprint of a valid definition.
[[nodiscard]] physics::Blueprint MakeBlueprint(const BlueprintDefinition& definition);

}  // namespace wobble::scenes
