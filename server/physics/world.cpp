// What the world holds; world_step.cpp has what a tick does with it.
#include "server/physics/world.h"

#include <algorithm>
#include <cassert>

#include "server/physics/methods/stability.h"
#include "server/physics/world_engine.h"

namespace wobble::physics {

World::World(const WorldSettings& settings)
    : m_settings(settings), m_engine(std::make_unique<Engine>(settings.threads)) {
  assert(settings.threads >= 1 && settings.tickDuration > 0);
  assert(settings.stiffnessFactor >= kLeastStiffnessFactor && settings.stiffnessFactor <= kMostStiffnessFactor);
}

World::~World() = default;

std::uint8_t World::AddBlueprint(Blueprint blueprint) {
  assert(m_bodies.empty() && m_blueprints.size() < 255);
  m_blueprints.push_back(std::move(blueprint));
  m_slots.push_back({++m_blueprintRevision, true, FindStiffnessBound(m_blueprints.back(), m_settings.tickDuration)});
  return static_cast<std::uint8_t>(m_blueprints.size() - 1);
}

void World::AddObstacle(const Obstacle& obstacle) {
  assert(m_bodies.empty());
  m_obstacles.push_back(obstacle);
}

BodyId World::AddBody(std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity) {
  assert(blueprint < m_blueprints.size());
  Body body;
  body.id = m_nextId++;
  body.blueprint = blueprint;
  body.stiffnessFactor = FindStiffnessRule(body).Find(1);
  if (m_settings.precision == Precision::kSingle) {
    body.state = MakeState<float>(m_blueprints[blueprint], position, velocity);
  } else {
    body.state = MakeState<double>(m_blueprints[blueprint], position, velocity);
  }
  m_bodies.push_back(std::move(body));
  m_engine->roster.Add();
  return m_bodies.back().id;
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

Vector3d World::FindMiddle(std::size_t place) const {
  const std::vector<Box>& boxes = m_settings.precision == Precision::kSingle
                                      ? std::get<Workspace<float>>(m_engine->workspaces).boxes
                                      : std::get<Workspace<double>>(m_engine->workspaces).boxes;
  return (boxes[place].low + boxes[place].high) / 2;
}

std::span<const std::uint32_t> World::Stepped() const { return m_engine->stepped; }

void World::RemoveBody(BodyId id) {
  DropPairsOf(id);
  const Body& body = Write(id);
  const auto index = static_cast<std::size_t>(&body - m_bodies.data());
  m_engine->Forget(index, body);
  m_bodies.erase(m_bodies.begin() + static_cast<std::ptrdiff_t>(index));
  std::erase(m_tearing, id);
  ++m_removals;
  std::erase_if(m_drives, [id](const Drive& drive) { return drive.body == id; });
  std::erase_if(m_pushes, [id](const Push& push) { return push.body == id; });
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
  for (Body& body : m_bodies) WakeUp(body);
}

void World::SetStiffnessFactor(double factor) {
  assert(factor >= kLeastStiffnessFactor && factor <= kMostStiffnessFactor);
  if (factor == m_settings.stiffnessFactor) return;
  m_settings.stiffnessFactor = factor;
  for (Body& body : m_bodies) WakeUp(body);
}

StiffnessRule World::FindStiffnessRule(const Body& body) const {
  return {m_settings.stiffnessFactor, m_slots[body.blueprint].stiffnessBound};
}

void World::AddDrive(const Drive& drive) {
  assert(drive.period > 0 && drive.begin < drive.end);
  m_drives.push_back(drive);
}

// Asleep or not, a body feels a drive from its first tick on, and the lack of it from its last.
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
  assert(control.moveX * control.moveX + control.moveY * control.moveY <= 1.0001);
  Body& body = Write(id);
  if (control != body.control || limits != body.limits) WakeUp(body);
  body.control = control;
  body.limits = limits;
}

void World::PushVertices(BodyId id, std::span<const VertexForce<double>> forces) {
  if (forces.empty()) return;
  Body& body = Write(id);
  WakeUp(body);
  const auto comesBefore = [](BodyId wanted, const Push& push) { return wanted < push.body; };
  for (const VertexForce<double>& force : forces) {
    assert(force.vertex < BlueprintOf(body).rest.size() && force.force.allFinite());
    m_pushes.insert(std::upper_bound(m_pushes.begin(), m_pushes.end(), id, comesBefore), {id, force});
  }
  // Room, so that the step need not make it.
  m_engine->ReservePushes(static_cast<std::size_t>(&body - m_bodies.data()), PushesOn(id).size() + m_drives.size());
}

std::span<const World::Push> World::PushesOn(BodyId id) const {
  const auto begin = std::lower_bound(m_pushes.begin(), m_pushes.end(), id,
                                      [](const Push& push, BodyId wanted) { return push.body < wanted; });
  const auto end =
      std::upper_bound(begin, m_pushes.end(), id, [](BodyId wanted, const Push& push) { return wanted < push.body; });
  return {begin, end};
}

void World::WakeNeighboursOf(BodyId id) {
  const auto wake = [&](const auto& workspace) {
    for (const auto* pairs : {&workspace.pairs, &workspace.restingPairs}) {
      for (const auto& pair : *pairs) {
        if (pair.Has(id)) WakeUp(Write(pair.first == id ? pair.second : pair.first));
      }
    }
  };
  wake(std::get<Workspace<float>>(m_engine->workspaces));
  wake(std::get<Workspace<double>>(m_engine->workspaces));
}

void World::DropPairsOf(BodyId id) {
  const auto drop = [&](auto& workspace) {
    for (auto* pairs : {&workspace.pairs, &workspace.restingPairs}) {
      std::erase_if(*pairs, [&](const auto& pair) {
        if (!pair.Has(id)) return false;
        WakeUp(Write(pair.first == id ? pair.second : pair.first));  // it may have rested on the one that goes
        return true;
      });
    }
  };
  drop(std::get<Workspace<float>>(m_engine->workspaces));
  drop(std::get<Workspace<double>>(m_engine->workspaces));
}

Vector3d World::FindCentre(const Body& body) const {
  return std::visit([&](const auto& state) { return physics::FindCentre(m_blueprints[body.blueprint], state); },
                    body.state);
}

void World::ListTouching(BodyId id, std::vector<BodyId>& touching) const {
  touching.clear();
  const auto list = [&](const auto& workspace) {
    for (const auto* pairs : {&workspace.pairs, &workspace.restingPairs}) {
      for (const auto& pair : *pairs) {
        if (pair.Has(id) && pair.IsTouching()) touching.push_back(pair.first == id ? pair.second : pair.first);
      }
    }
  };
  list(std::get<Workspace<float>>(m_engine->workspaces));
  list(std::get<Workspace<double>>(m_engine->workspaces));
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
