// The definition of a body of any kind. A further kind is one more alternative and one more line in each function.
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

namespace wobble::scenes {

using BodyDefinition =
    std::variant<physics::BallDefinition, physics::LatticeDefinition, physics::PairDefinition, physics::RingDefinition,
                 physics::ClothDefinition, physics::GraphDefinition, physics::MeshDefinition>;

[[nodiscard]] const std::string& NameOf(const BodyDefinition& definition);
[[nodiscard]] std::size_t CountVertices(const BodyDefinition& definition);

// Everything that is wrong with a definition; empty when it can be built.
[[nodiscard]] std::vector<physics::FieldError> Validate(const BodyDefinition& definition);

// The definition must be valid.
[[nodiscard]] physics::Blueprint MakeBlueprint(const BodyDefinition& definition);

}  // namespace wobble::scenes
