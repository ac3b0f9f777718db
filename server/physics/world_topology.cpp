// Bodies whose topology changes while the world runs. A blueprint is immutable, so each change is a new one in another
// slot; slots that no body uses any more are taken again, the one that has lain idle for longest first.
#include <algorithm>
#include <cassert>

#include "server/physics/tear.h"
#include "server/physics/world_engine.h"

namespace wobble::physics {
namespace {

// Between two blueprints of a body that goes on tearing, s: each is sent to every client, faces and all.
constexpr double kRebuildTime = 0.25;
constexpr std::size_t kMaxSlots = 255;

// Where each face of `before` is in `after`, which has lost some and kept the order of the others.
std::vector<std::uint16_t> MapFaces(std::span<const Face> before, std::span<const Face> after) {
  std::vector<std::uint16_t> map(before.size(), kNoFace);
  for (std::size_t i = 0, next = 0; i < before.size() && next < after.size(); ++i) {
    if (before[i] == after[next]) map[i] = static_cast<std::uint16_t>(next++);
  }
  return map;
}

// Contacts of others with the body's faces follow these to their new places; what a lost face held is let go.
template <class Real>
void FollowFaces(Workspace<Real>& workspace, BodyId id, std::span<const std::uint16_t> map) {
  for (auto* pairs : {&workspace.pairs, &workspace.restingPairs}) {
    for (BodyPair<Real>& pair : *pairs) {
      if (!pair.Has(id)) continue;
      auto& contacts = pair.sides[pair.second == id ? 0 : 1];
      std::erase_if(contacts, [&](const BodyContact<Real>& contact) { return map[contact.face] == kNoFace; });
      for (BodyContact<Real>& contact : contacts) contact.face = map[contact.face];
    }
  }
}

// Vertices beyond those that the body has had come where the rest shape has them beside these.
template <class Real>
void FitState(const Blueprint& blueprint, State<Real>& state) {
  const std::size_t kept = std::min(state.positions.size(), blueprint.rest.size());
  Vector3d shift = Vector3d::Zero();
  for (std::size_t i = 0; i < kept; ++i) shift += state.positions[i].template cast<double>() - blueprint.rest[i];
  if (kept > 0) shift /= static_cast<double>(kept);
  state.positions.resize(kept);
  for (std::size_t i = kept; i < blueprint.rest.size(); ++i) {
    state.positions.push_back((blueprint.rest[i] + shift).template cast<Real>());
  }
  state.velocities.resize(blueprint.rest.size(), Vector3<Real>::Zero());
  std::erase_if(state.contacts, [&](const Contact<Real>& contact) { return contact.vertex >= kept; });
  state.torn.assign(blueprint.full.tearStretch > 0 ? blueprint.full.springs.size() : 0, 0);
}

}  // namespace

std::size_t World::FindFreeSlot() const {
  std::vector<bool> isUsed(m_slots.size(), false);
  for (const Body& body : m_bodies) isUsed[body.blueprint] = true;
  std::size_t best = m_slots.size();
  for (std::size_t slot = 0; slot < m_slots.size(); ++slot) {
    if (m_slots[slot].isKept || isUsed[slot]) continue;
    if (best == m_slots.size() || m_slots[slot].revision < m_slots[best].revision) best = slot;
  }
  return best;
}

void World::PutOntoSlot(Body& body, std::size_t slot, Blueprint blueprint) {
  if (slot == m_slots.size()) {
    m_blueprints.emplace_back();
    m_slots.emplace_back();
  }
  m_blueprints[slot] = std::move(blueprint);
  SetIntegrator(m_blueprints[slot], m_blueprints[slot].integrator);  // of these springs, not those before
  m_slots[slot].revision = ++m_blueprintRevision;
  body.blueprint = static_cast<std::uint8_t>(slot);
  WakeUp(body);
  std::visit([&](auto& state) { FitState(m_blueprints[slot], state); }, body.state);
}

bool World::ReplaceBlueprint(BodyId id, Blueprint blueprint) {
  const std::size_t slot = FindFreeSlot();
  if (slot >= kMaxSlots) return false;
  DropPairsOf(id);
  PutOntoSlot(FindBody(id), slot, std::move(blueprint));
  return true;
}

void World::RebuildTorn() {
  for (const std::uint32_t place : Stepped()) {
    if (m_bodies[place].tornTicks == 1) m_tearing.push_back(m_bodies[place].id);
  }
  if (m_tearing.empty()) return;
  std::sort(m_tearing.begin(), m_tearing.end());
  for (const BodyId id : m_tearing) {
    Body& body = FindBody(id);
    if (body.tornTicks * m_settings.tickDuration < kRebuildTime) continue;
    const std::size_t slot = FindFreeSlot();
    if (slot >= kMaxSlots) break;
    const auto& torn = std::visit(
        [](const auto& state) -> const auto& { return state.torn; }, body.state);
    Blueprint left = MakeTornBlueprint(m_blueprints[body.blueprint], torn);
    const auto map = MapFaces(m_blueprints[body.blueprint].full.faces, left.full.faces);
    FollowFaces(std::get<0>(m_engine->workspaces), body.id, map);
    FollowFaces(std::get<1>(m_engine->workspaces), body.id, map);
    PutOntoSlot(body, slot, std::move(left));
    body.tornTicks = 0;
  }
  std::erase_if(m_tearing, [this](BodyId id) { return FindBody(id).tornTicks == 0; });
}

}  // namespace wobble::physics
