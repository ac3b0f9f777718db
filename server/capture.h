// World to wire: the one place where the engine's types become the protocol's on the way out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/messages.h"
#include "server/physics/world.h"

namespace wobble::server {

// A body as clients are to see it: pose and vertices in the world, metres.
struct CapturedBody {
  std::uint32_t body = 0;
  std::uint8_t blueprint = 0;
  protocol::Pose pose;
  std::vector<protocol::Vector3> vertices;
};

// What clients know of a blueprint.
struct CapturedBlueprint {
  std::vector<protocol::Vector3> rest;
  float size = 0;
  protocol::Message message;    // serialised, to be sent in chunks
  std::uint64_t hash = 0;       // of the message
  std::uint64_t revision = 0;   // of its slot in the world
  std::uint8_t generation = 0;  // under its number on the wire, below protocol::kGenerations
};

// Ground as clients draw it.
struct CapturedGround {
  protocol::wire::HeightField field;
  std::vector<std::uint16_t> heights;  // row by row
};

[[nodiscard]] CapturedBlueprint CaptureBlueprint(const physics::Blueprint& blueprint);
// All but height fields, and these.
[[nodiscard]] std::vector<protocol::wire::Obstacle> CaptureObstacles(std::span<const physics::Obstacle> obstacles);
[[nodiscard]] std::vector<CapturedGround> CaptureGrounds(std::span<const physics::Obstacle> obstacles);

// Fills `bodies` with the world's, by ascending id. What it holds from the last capture speeds up the next: memory, and
// each body's rotation as the start of the search for the new one.
void CaptureBodies(const physics::World& world, std::vector<CapturedBody>& bodies);

}  // namespace wobble::server
