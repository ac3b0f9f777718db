// Bases of blueprints, from play.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/basis.h"
#include "server/physics/world.h"
#include "server/training/basis_statistics.h"

namespace wobble::server {

// Of a blueprint's patches, as protocol::WriteBasis gives them; or none.
using Bases = std::vector<std::vector<std::uint8_t>>;

// Plays four of the blueprint's bodies against each other in a walled room, seeded, for about a second of one core at
// most, and keeps every second tick.
[[nodiscard]] Play RecordPlay(const physics::Blueprint& blueprint, const physics::Vector3d& gravity,
                              const physics::ControlLimits& limits, std::uint64_t seed);

// One for each patch: cosines where the vertices stand in a grid, the principal directions of
// play up to protocol::kMaxTrainedVertices vertices, vibrations of the springs beyond. Empty when none can be made.
[[nodiscard]] Bases TrainBases(const physics::Blueprint& blueprint, const Play& play);

// The same for one patch of principal directions, from any play; rest: of the whole body.
[[nodiscard]] std::vector<std::uint8_t> TrainBasis(std::span<const protocol::Vector3> rest, const Play& play);

}  // namespace wobble::server
