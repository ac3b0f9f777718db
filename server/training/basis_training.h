// The room server/training learns the bases in which shapes are encoded. This file plays a blueprint's bodies and
// trains bases from what it recorded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/basis.h"
#include "server/physics/world.h"
#include "server/snapshots/capture.h"
#include "server/training/basis_statistics.h"

namespace wobble::server {

// Plays four bodies of the blueprint against each other in a walled room for 12 s of world time (less for bodies of
// more than 162 vertices) and records every second tick after the first second. Deterministic for a seed. Cost: at most
// about a second of one core.
[[nodiscard]] RecordedPlay RecordPlay(const physics::Blueprint& blueprint, const physics::Vector3d& gravity,
                                      const physics::ControlLimits& limits, std::uint64_t seed);

// Trains one basis per patch: cosines where the vertices stand in a grid, otherwise the principal directions of the
// play for bodies of up to protocol::kMaxTrainedVertices vertices, and the vibrations of the springs beyond. Empty when
// the blueprint has a single vertex or the play is empty.
[[nodiscard]] Bases TrainBases(const physics::Blueprint& blueprint, const RecordedPlay& play);

// Trains a basis of principal directions for a body of one patch. rest: its vertices in the body's frame, m. Returns it
// serialised.
[[nodiscard]] std::vector<std::uint8_t> TrainBasis(std::span<const protocol::Vector3> rest, const RecordedPlay& play);

}  // namespace wobble::server
