// What a world holds and what is asked of its bodies between two ticks.
//
// Every change of a body wakes it, and what rests on a body that goes away wakes too: a sleeping body is neither
// stepped nor looked at, so it would not notice the change.
#include "server/physics/world.h"

#include <algorithm>
#include <cassert>

#include "server/physics/methods/stability.h"
#include "server/physics/world_engine.h"
#include "server/physics/world_prepare.h"

namespace wobble::physics {

World::World(const WorldSettings& settings) : m_settings(settings), m_engine(std::make_unique<Engine>(settings)) {
  assert(settings.threads >= 1 && settings.tickDuration > 0);
  assert(settings.stiffnessFactor >= kLeastStiffnessFactor && settings.stiffnessFactor <= kMostStiffnessFactor);
}

World::~World() = default;

std::uint8_t World::AddBlueprint(Blueprint blueprint) {
  assert(m_bodies.empty() && m_blueprints.size() < 255);
  m_blueprints.push_back(std::move(blueprint));
  m_slots.push_back({.revision = ++m_blueprintRevision,
                     .isKept = true,
                     .stiffnessBound = FindStiffnessBound(m_blueprints.back(), m_settings.tickDuration)});
  const auto slot = static_cast<std::uint8_t>(m_blueprints.size() - 1);
  m_recipes.push_back({.base = slot, .parts = {}, .torn = {}});
  return slot;
}

void World::AddObstacle(const Obstacle& obstacle) {
  assert(m_bodies.empty());
  m_obstacles.push_back(obstacle);
}

Body World::MakeBody(BodyId id, std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity) const {
  assert(blueprint < m_blueprints.size());
  Body body;
  body.id = id;
  body.blueprint = blueprint;
  body.stiffnessFactor = FindStiffnessRule(m_settings, m_slots[blueprint]).Find(1);
  if (m_settings.precision == Precision::kSingle) {
    body.state = MakeState<float>(m_blueprints[blueprint], position, velocity);
  } else {
    body.state = MakeState<double>(m_blueprints[blueprint], position, velocity);
  }
  return body;
}

BodyId World::AddBody(std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity) {
  m_bodies.push_back(MakeBody(m_nextId++, blueprint, position, velocity));
  m_engine->roster.Add();
  return m_bodies.back().id;
}

void World::RenewBody(BodyId id, std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity) {
  DropPairsOf(id);
  DropForcesOn(id);
  Body& body = Write(id);
  WakeUp(body);
  body = MakeBody(id, blueprint, position, velocity);
}

void World::DropForcesOn(BodyId id) {
  std::erase(m_tearing, id);
  std::erase_if(m_drives, [id](const Drive& drive) { return drive.body == id; });
  std::erase_if(m_stepForces, [id](const StepForce& force) { return force.body == id; });
}

const Body* World::FindBody(BodyId id) const {
  const auto found = std::lower_bound(m_bodies.begin(), m_bodies.end(), id,
                                      [](const Body& body, BodyId wanted) { return body.id < wanted; });
  return found != m_bodies.end() && found->id == id ? &*found : nullptr;
}

const Body& World::ReadBody(BodyId id) const {
  const Body* body = FindBody(id);
  assert(body != nullptr);
  return *body;
}

Body& World::Write(BodyId id) { return const_cast<Body&>(ReadBody(id)); }

void World::WakeUp(Body& body) {
  if (body.asleep) m_engine->roster.Wake(static_cast<std::uint32_t>(&body - m_bodies.data()));
  physics::WakeUp(body);
}

void World::WakeAll() {
  for (Body& body : m_bodies) WakeUp(body);
}

WorldChanges World::Changes() const {
  return {.stepped = m_engine->stepped,
          .boxes = std::visit([](const auto& work) { return std::span<const Box>(work.boxes); }, m_engine->workspace),
          .removals = m_removals,
          .restores = m_restores,
          .blueprintRevision = m_blueprintRevision,
          .slots = m_slots};
}

void World::RemoveBody(BodyId id) {
  DropPairsOf(id);
  const Body& body = Write(id);
  const auto index = static_cast<std::size_t>(&body - m_bodies.data());
  m_engine->Forget(index, body);
  m_bodies.erase(m_bodies.begin() + static_cast<std::ptrdiff_t>(index));
  ++m_removals;
  DropForcesOn(id);
}

void World::PlaceBody(BodyId id, const Vector3d& position) {
  DropPairsOf(id);
  Body& body = Write(id);
  std::visit([&]<class Real>(State<Real>& state) { PutBackToRest(m_blueprints[body.blueprint], position, state); },
             body.state);
  body.steps = {};
  WakeUp(body);
}

void World::SetMotion(BodyId id, std::span<const Vector3d> positions, std::span<const Vector3d> velocities) {
  Body& body = Write(id);
  WakeUp(body);
  body.lostTicks = std::max(body.lostTicks, 1);  // so that the next step looks
  std::visit(
      [&]<class Real>(State<Real>& state) {
        assert(positions.size() == state.positions.size() && velocities.size() == state.velocities.size());
        const Coefficients<double>& full = m_blueprints[body.blueprint].full;
        for (std::size_t i = 0; i < positions.size(); ++i) {
          state.positions[i] = (positions[i] - state.origin).template cast<Real>();
          state.velocities[i] = velocities[i].template cast<Real>();
          if (full.planar) state.velocities[i].y() = Real(0);
        }
        for (const std::uint16_t vertex : full.fixed) state.velocities[vertex].setZero();
      },
      body.state);
}

void World::SetGravity(const Vector3d& gravity) {
  if (gravity == m_settings.gravity) return;
  m_settings.gravity = gravity;
  WakeAll();
}

void World::SetStiffnessFactor(double factor) {
  assert(factor >= kLeastStiffnessFactor && factor <= kMostStiffnessFactor);
  if (factor == m_settings.stiffnessFactor) return;
  m_settings.stiffnessFactor = factor;
  WakeAll();
}

void World::AddDrive(const Drive& drive) {
  assert(drive.period > 0 && drive.begin < drive.end);
  m_drives.push_back(drive);
}

// A sleeping body wakes as a drive goes on, to follow it, and as it goes off, to come back to rest without it.
void World::WakeTheDriven() {
  const double duration = m_settings.tickDuration;
  for (const Drive& drive : m_drives) {
    const bool isOn = IsOn(drive, (m_tick - 1.0) * duration);
    if (isOn == IsOn(drive, (m_tick - 2.0) * duration)) continue;
    for (Body& body : m_bodies) {
      if (drive.body == 0 || drive.body == body.id) WakeUp(body);
    }
  }
}

void World::SetControl(BodyId id, const Control& control, const ControlLimits& limits) {
  assert(control.IsPossible());
  Body& body = Write(id);
  if (control != body.control || limits != body.limits) WakeUp(body);
  body.control = control;
  body.limits = limits;
}

void World::PushVertices(BodyId id, std::span<const VertexForce<double>> forces) {
  if (forces.empty()) return;
  Body& body = Write(id);
  WakeUp(body);
  const auto comesBefore = [](BodyId wanted, const StepForce& each) { return wanted < each.body; };
  for (const VertexForce<double>& force : forces) {
    assert(force.vertex < BlueprintOf(body).rest.size() && force.force.allFinite());
    const auto behind = std::upper_bound(m_stepForces.begin(), m_stepForces.end(), id, comesBefore);
    m_stepForces.insert(behind, {.body = id, .force = force});
  }
  // Makes the room here, since a step must not allocate.
  const auto place = static_cast<std::size_t>(&body - m_bodies.data());
  const std::size_t room = FindForcesOn(id, m_stepForces).size() + m_drives.size();
  std::visit(
      [&](auto& work) {
        if (place < work.members.size()) work.members[place].pushes.reserve(room);
      },
      m_engine->workspace);
}

void World::WakeNeighboursOf(BodyId id) {
  const auto wake = [&](const auto& pair) { WakeUp(Write(pair.OtherThan(id))); };
  std::visit([&](auto& work) { VisitPairsOf(id, work.pairs, wake); }, m_engine->workspace);
}

void World::DropPairsOf(BodyId id) {
  WakeNeighboursOf(id);  // they may rest on the body
  const auto hasBody = [id](const auto& pair) { return pair.Has(id); };
  std::visit(
      [&](auto& work) {
        std::erase_if(work.pairs.awake, hasBody);
        std::erase_if(work.pairs.resting, hasBody);
      },
      m_engine->workspace);
}

Vector3d World::FindCentre(const Body& body) const {
  return std::visit([&](const auto& state) { return physics::FindCentre(m_blueprints[body.blueprint], state); },
                    body.state);
}

void World::ListTouching(BodyId id, std::vector<BodyId>& touching) const {
  touching.clear();
  const auto list = [&](const auto& pair) {
    if (!pair.IsSelf() && pair.IsTouching()) touching.push_back(pair.OtherThan(id));
  };
  std::visit([&](const auto& work) { VisitPairsOf(id, work.pairs, list); }, m_engine->workspace);
  std::sort(touching.begin(), touching.end());
}

std::uint64_t World::Hash() const {
  std::uint64_t hash = kHashSeed;
  for (const Body& body : m_bodies) {
    hash = HashBytes(std::as_bytes(std::span(&body.id, 1)), hash);
    hash = std::visit([&](const auto& state) { return HashState(state, hash); }, body.state);
  }
  return hash;
}

}  // namespace wobble::physics
