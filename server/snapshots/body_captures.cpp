// Following the world costs a few operations per stepped body; the vertices are copied only when a body is read.
#include "server/snapshots/body_captures.h"

namespace wobble::server {
namespace {

void NoteBlueprint(const physics::World& world, const physics::Body& body, ShownBody& shown) {
  shown.blueprint = body.blueprint;
  shown.size = static_cast<float>(world.Blueprints()[body.blueprint].size);
}

}  // namespace

void BodyCaptures::Follow(const physics::World& world, std::uint32_t tick) {
  const physics::WorldChanges changes = world.Changes();
  if (m_removals != changes.removals) DropRemoved(world);
  const std::span<const physics::Body> present = world.Bodies();
  while (m_shown.size() < present.size()) {
    const physics::Body& added = present[m_shown.size()];
    m_shown.push_back({.body = added.id, .centre = ToWire(world.FindCentre(added))});
    NoteBlueprint(world, added, m_shown.back());
    m_captured.emplace_back().body = added.id;
    m_moved.push_back(1);
  }
  if (m_restores != changes.restores) TakeRestored(world, tick);
  const auto perTick = static_cast<float>(1 / world.Settings().tickDuration);
  for (const std::uint32_t place : changes.stepped) {
    m_moved[place] = 1;
    ShownBody& shown = m_shown[place];
    const protocol::Vector3 centre = ToWire(changes.FindMiddle(place));
    shown.speed = protocol::Length(centre - shown.centre) * perTick;
    shown.centre = centre;
    shown.restTick = present[place].asleep ? tick : 0;
    if (shown.blueprint != present[place].blueprint) NoteBlueprint(world, present[place], shown);
  }
}

// Any body may be elsewhere. Versions go on from where no capture has been: a body may be gone and there again, and
// what was encoded of it before must not be taken for what it is now.
void BodyCaptures::TakeRestored(const physics::World& world, std::uint32_t tick) {
  m_restores = world.Changes().restores;
  for (std::size_t i = 0; i < m_shown.size(); ++i) {
    const physics::Body& body = world.Bodies()[i];
    m_moved[i] = 1;
    m_captured[i].version = m_restores << 32;
    m_shown[i].centre = ToWire(world.FindCentre(body));
    m_shown[i].restTick = body.asleep ? tick : 0;
    NoteBlueprint(world, body, m_shown[i]);
  }
}

// As FollowBodies, on three lists at once.
void BodyCaptures::DropRemoved(const physics::World& world) {
  m_removals = world.Changes().removals;
  const std::span<const physics::Body> present = world.Bodies();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < m_shown.size(); ++i) {
    if (kept == present.size() || m_shown[i].body != present[kept].id) continue;
    m_shown[kept] = m_shown[i];
    m_moved[kept] = m_moved[i];
    if (kept != i) m_captured[kept] = std::move(m_captured[i]);
    ++kept;
  }
  m_shown.resize(kept);
  m_moved.resize(kept);
  m_captured.resize(kept);
}

const CapturedBody& BodyCaptures::Read(const physics::World& world, std::size_t index) {
  CapturedBody& captured = m_captured[index];
  if (m_moved[index] != 0) {
    CaptureBody(world, world.Bodies()[index], captured);
    captured.restTick = m_shown[index].restTick;
    m_moved[index] = 0;
  }
  return captured;
}

}  // namespace wobble::server
