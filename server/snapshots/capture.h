// World to wire: the one place where the engine's types become the protocol's on the way out.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/messages.h"
#include "protocol/patch_model.h"
#include "server/physics/world.h"
#include "server/play/workshop.h"
#include "server/scenes/scene.h"

namespace wobble::server {

// A body as clients are to see it: pose and vertices in the world, metres.
struct CapturedBody {
  std::uint32_t body = 0;
  std::uint64_t version = 0;  // another one whenever it has been captured again
  std::uint8_t blueprint = 0;
  std::uint32_t restTick = 0;  // as ShownBody has it
  protocol::Pose pose;
  std::vector<protocol::Vector3> vertices;
};

// What clients know of a blueprint.
struct CapturedBlueprint {
  std::vector<protocol::Vector3> rest;
  float size = 0;
  protocol::Message message;                      // serialised, to be sent in chunks
  std::vector<protocol::PatchConstants> patches;  // in order
  std::uint64_t hash = 0;                         // of the message
  std::uint64_t revision = 0;                     // of its slot in the world
  std::uint8_t generation = 0;                    // under its number on the wire, below protocol::kGenerations
};

// Ground as clients draw it.
struct CapturedGround {
  protocol::wire::HeightField field;
  std::vector<std::uint16_t> heights;  // row by row
};

// Of the particles and springs of the workshop, one a vertex and one a spring; of other bodies none.
struct BlueprintTags {
  std::vector<protocol::wire::ParticleTag> particles;
  std::vector<protocol::wire::SpringTag> springs;
};
[[nodiscard]] BlueprintTags CaptureTags(const physics::Blueprint& blueprint, std::span<const PartTag> particles,
                                        std::span<const PartTag> springs);
// What the scene lets hands do, as the welcome has it.
[[nodiscard]] std::uint8_t CaptureHands(const scenes::Scene& scene);

// bases: as TrainBases makes them.
[[nodiscard]] CapturedBlueprint CaptureBlueprint(const physics::Blueprint& blueprint,
                                                 std::span<const std::vector<std::uint8_t>> bases = {},
                                                 const BlueprintTags& tags = {});
// All but height fields, and these.
[[nodiscard]] std::vector<protocol::wire::Obstacle> CaptureObstacles(std::span<const physics::Obstacle> obstacles);
[[nodiscard]] std::vector<CapturedGround> CaptureGrounds(std::span<const physics::Obstacle> obstacles);

// Under these numbers: the heights of the welcome's field, and a blueprint, in as many messages as they take.
[[nodiscard]] std::vector<protocol::Message> MakeRows(std::uint16_t number, const CapturedGround& ground);
[[nodiscard]] std::vector<protocol::Message> MakeChunks(std::uint8_t number, const CapturedBlueprint& blueprint);

// Captures the body. What is there of its last capture speeds this one up: memory, and its rotation as the start of the
// search for the new one.
void CaptureBody(const physics::World& world, const physics::Body& body, CapturedBody& captured);

// The forces on the body, which is there, of at most kMaxShownForces vertices.
[[nodiscard]] protocol::Message CaptureForces(const physics::World& world, physics::BodyId body);

// A body that clients may be told of, and where, m, as near as it takes to choose among them.
struct ShownBody {
  std::uint32_t body = 0;
  protocol::Vector3 centre;
  float speed = 0;             // of the centre, m/s
  std::uint32_t restTick = 0;  // since when it sleeps; 0: it does not
};

// Brings what is kept of each body in line with those there are now: both ascend by id, and ids are never reused, so
// without the removed ones the kept begin the others. Kept: default-made, with a member `body`.
template <class Kept>
void FollowBodies(std::span<const ShownBody> bodies, std::vector<Kept>& kept) {
  std::size_t next = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (next == bodies.size() || kept[i].body != bodies[next].body) continue;
    if (next != i) kept[next] = std::move(kept[i]);
    ++next;
  }
  kept.resize(next);
  kept.resize(bodies.size());
  for (; next < bodies.size(); ++next) kept[next].body = bodies[next].body;
}

// Of what is kept of each body, by ascending id. Null when there is none.
template <class Kept>
[[nodiscard]] Kept* FindBody(std::span<Kept> kept, std::uint32_t body) {
  const auto found = std::lower_bound(kept.begin(), kept.end(), body,
                                      [](const Kept& each, std::uint32_t wanted) { return each.body < wanted; });
  return found != kept.end() && found->body == body ? &*found : nullptr;
}

// The world's bodies, each captured when somebody asks for it, and again only when it has moved since.
class BodyCaptures {
 public:
  // After every step of the world, and before Bodies() is read.
  void Follow(const physics::World& world);

  [[nodiscard]] std::span<const ShownBody> Bodies() const { return m_shown; }  // by ascending id
  // CapturedBody::version of Bodies()[index]; 0 when it has moved since, or was never captured.
  [[nodiscard]] std::uint64_t Version(std::size_t index) const {
    return m_moved[index] != 0 ? 0 : m_captured[index].version;
  }
  // Of Bodies()[index].
  const CapturedBody& Read(const physics::World& world, std::size_t index);

 private:
  void DropRemoved(const physics::World& world);

  std::vector<ShownBody> m_shown;
  std::vector<CapturedBody> m_captured;
  std::vector<std::uint8_t> m_moved;  // since it was captured
  std::uint64_t m_removals = 0;       // of the world
};

}  // namespace wobble::server
