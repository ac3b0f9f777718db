// The room server/snapshots turns the world into snapshots: capture, encode, choose, send. This file converts the
// engine's types into the protocol's; on the way out no other room does.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/codec/patch_model.h"
#include "protocol/geometry.h"
#include "protocol/messages.h"
#include "server/physics/world.h"
#include "server/play/tuning.h"
#include "server/play/workshop.h"
#include "server/scenes/scene.h"

namespace wobble::server {

// The trained bases of one blueprint, one per patch, serialised by protocol::WriteBasis. Empty: the blueprint has none,
// and its shapes take three times the bits.
using Bases = std::vector<std::vector<std::uint8_t>>;

// Rounds a vector to the wire's single precision.
[[nodiscard]] protocol::Vector3 ToWire(const physics::Vector3d& v);

// A body as clients are to see it: pose and vertices in the world's frame, m.
struct CapturedBody {
  std::uint32_t body = 0;
  std::uint64_t version = 0;  // grows with every capture; 0: never captured
  std::uint8_t blueprint = 0;
  std::uint32_t restTick = 0;  // as ShownBody::restTick
  protocol::Pose pose;
  std::vector<protocol::Vector3> vertices;
};

// A blueprint as clients know it.
struct CapturedBlueprint {
  std::vector<protocol::Vector3> rest;            // m
  float size = 0;                                 // m
  protocol::Message message;                      // the wire's Blueprint, sent in chunks
  std::vector<protocol::PatchConstants> patches;  // in order
  std::uint64_t hash = 0;                         // of the message
  std::uint64_t revision = 0;                     // of its slot in the world
  std::uint8_t generation = 0;                    // of this number on the wire, below protocol::kGenerations
};

// A height field as clients draw it.
struct CapturedGround {
  protocol::wire::HeightField field;
  std::vector<std::uint16_t> heights;  // row by row, in steps of the field
};

// Owners and numbers of the workshop's particles and springs, in the blueprint's order. Empty for all other blueprints.
struct BlueprintTags {
  std::vector<protocol::wire::ParticleTag> particles;
  std::vector<protocol::wire::SpringTag> springs;
};

// particles, springs: of the workshop, as many as the blueprint has.
[[nodiscard]] BlueprintTags CaptureTags(const physics::Blueprint& blueprint, std::span<const PartTag> particles,
                                        std::span<const PartTag> springs);

// The hand permissions of a scene as the bits of the welcome (protocol::kMayGrab ...).
[[nodiscard]] std::uint8_t CaptureHands(const scenes::Scene& scene);
// How players' bodies answer to inputs.
[[nodiscard]] protocol::wire::Drive CaptureDrive(const scenes::Scene& scene);

// The tuned values, and what one player may tune (none: a spectator may tune nothing). timeRate: world seconds per
// second.
[[nodiscard]] protocol::TuningFields CaptureTuning(const Tuning& tuning, double timeRate, bool isSpectator,
                                                   bool isHost);

// Serialises a blueprint and hashes the message. bases: as training makes them, or none.
[[nodiscard]] CapturedBlueprint CaptureBlueprint(const physics::Blueprint& blueprint,
                                                 std::span<const std::vector<std::uint8_t>> bases = {},
                                                 const BlueprintTags& tags = {});

// All obstacles except height fields, in their order.
[[nodiscard]] std::vector<protocol::wire::Obstacle> CaptureObstacles(std::span<const physics::Obstacle> obstacles);
// The height fields among the obstacles, in their order. Each is sampled up to 8 times finer than its own grid and
// quantised to 16 bits between its lowest and highest point.
[[nodiscard]] std::vector<CapturedGround> CaptureGrounds(std::span<const physics::Obstacle> obstacles);

// Rows of a height field in one message, as many as protocol::kMaxRowsHeights allows.
[[nodiscard]] std::size_t CountRowsAtOnce(const CapturedGround& ground);
// The message with the next rows of a height field; number: of the field in the welcome.
[[nodiscard]] protocol::Message MakeRows(std::uint16_t number, const CapturedGround& ground, std::size_t firstRow);
// The message with the next bytes of a blueprint, at most protocol::kBlueprintChunkBytes; with an offset of the whole
// size, the one that tells a client to take what it has kept. number: of its slot.
[[nodiscard]] protocol::Message MakeChunk(std::uint8_t number, const CapturedBlueprint& blueprint, std::size_t offset);

// Captures a body and raises captured.version. `captured` may hold an older capture of the same body: its memory is
// reused, and its rotation starts the search for the new one.
void CaptureBody(const physics::World& world, const physics::Body& body, CapturedBody& captured);

// The Forces message of a body that is in the world: every n-th vertex, so that at most protocol::kMaxShownForces are
// shown.
[[nodiscard]] protocol::Message CaptureForces(const physics::World& world, physics::BodyId body, std::uint32_t tick);

}  // namespace wobble::server
