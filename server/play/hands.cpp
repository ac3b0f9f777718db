// A grip is a critically damped spring between each held vertex and its place beside the target, evaluated once a tick
// at the tick's beginning:
//   f = m (ω² (target + offset − x) − 2 ω v)
// with the vertex's own mass m, so that a heavy body hangs low and a light cloth follows at once. The force is constant
// through the tick: it lags by half a tick, and it is stable as long as ω h < 1 (a discrete oscillator with zero-order
// hold, h the tick), so ω is at most 0.5/h. A spring inside the integrator's stages was rejected: it would be one more
// stiffness to bound in every kernel, and feels the same.
//
// Hands of a body (a reach above 0) obey action and reaction: the opposite force pulls at their owner, who thus hangs
// from a curtain that is held, and cannot fly by lifting the body underneath.
#include "server/play/hands.h"

#include <algorithm>
#include <cmath>

namespace wobble::server {
namespace {

using physics::Vector3d;

constexpr double kGripFrequency = 30;  // ω, 1/s
constexpr double kMostPerTick = 0.5;   // largest ω h
constexpr double kSlip = 1.5;          // a grip slips beyond this many times the reach
constexpr double kShoveTime = 0.1;     // duration of a shove, s: a shorter one would only dent the body
constexpr double kShovePause = 0.3;    // from one shove to the next, s
constexpr double kShoveShare = 0.5;    // radius of a shove as a share of the body's reach
constexpr double kLongestBlade = 4;    // m
constexpr double kFarthestEye = 200;   // m

template <class Visit>
void VisitMotion(const physics::Body& body, Visit&& visit) {
  std::visit(
      [&](const auto& state) {
        for (std::size_t i = 0; i < state.positions.size(); ++i) {
          visit(i, Vector3d(state.origin + state.positions[i].template cast<double>()),
                Vector3d(state.velocities[i].template cast<double>()));
        }
      },
      body.state);
}

Vector3d FindVertex(const physics::Body& body, std::size_t vertex) {
  return std::visit(
      [&](const auto& state) -> Vector3d { return state.origin + state.positions[vertex].template cast<double>(); },
      body.state);
}

std::vector<std::uint16_t> FindRound(const physics::Body& body, const Vector3d& place, double radius) {
  std::vector<std::uint16_t> found;
  physics::VisitVertices(body, [&](std::size_t i, const Vector3d& x) {
    if ((x - place).norm() <= radius) found.push_back(static_cast<std::uint16_t>(i));
  });
  return found;
}

}  // namespace

bool Hands::IsWithin(double reach, physics::BodyId own, const Vector3d& place, const physics::World& world) {
  if (reach == 0) return true;
  const physics::Body* body = world.FindBody(own);
  return body != nullptr && (world.FindCentre(*body) - place).norm() <= reach;
}

void Hands::Hold(const Actor& actor, const std::optional<HandCommand>& command, const physics::World& world) {
  if (!command || !m_rules.grab || actor.body == 0) {
    m_memory.grips.erase(actor.client);
    return;
  }
  const auto [found, isNew] = m_memory.grips.try_emplace(actor.client);
  Grip& grip = found->second;
  const bool closes = isNew || grip.command.grip != command->grip;
  grip.command = *command;
  grip.own = actor.body;
  if (closes) Close(actor, grip, world);
}

void Hands::Close(const Actor& actor, Grip& grip, const physics::World& world) const {
  grip.vertices.clear();
  grip.offsets.clear();
  const physics::Body* body = world.FindBody(grip.command.body);
  if (body == nullptr || body->id == actor.body) return;
  if (grip.command.vertex >= world.BlueprintOf(*body).rest.size()) return;
  const Vector3d place = FindVertex(*body, grip.command.vertex);
  if (!IsWithin(m_rules.reach, actor.body, place, world)) return;
  grip.vertices = FindRound(*body, place, m_rules.radius);
  for (const std::uint16_t vertex : grip.vertices) grip.offsets.emplace_back(FindVertex(*body, vertex) - place);
}

std::string Hands::StartShove(const Actor& actor, const ShoveCommand& command, const physics::World& world) {
  if (!m_rules.push || actor.body == 0) return "pushing is not allowed here";
  const physics::Body* body = world.FindBody(command.body);
  const double length = command.direction.norm();
  if (body == nullptr || command.vertex >= world.BlueprintOf(*body).rest.size() || !(length > 0)) return "";
  const Vector3d place = FindVertex(*body, command.vertex);
  if (!IsWithin(m_rules.reach, actor.body, place, world)) return "too far away to push";
  Shove& shove = m_memory.shoves[actor.client];
  if (shove.ticksToRest > 0) return "";
  shove.command = command;
  shove.command.direction /= length;
  shove.own = actor.body;
  shove.vertices = FindRound(*body, place, std::max(m_rules.radius, kShoveShare * world.BlueprintOf(*body).reach));
  shove.ticksLeft = std::max(1, static_cast<int>(std::lround(kShoveTime / m_tickDuration)));
  shove.ticksToRest = std::max(1, static_cast<int>(std::lround(kShovePause / m_tickDuration)));
  return "";
}

std::optional<physics::Blade> Hands::FindBlade(const Actor& actor, const CutCommand& command,
                                               const physics::World& world, std::string& refusal) const {
  const Vector3d middle = (command.from + command.to) / 2;
  if (!m_rules.cut || actor.body == 0) {
    refusal = "cutting is not allowed here";
  } else if (!IsWithin(m_rules.reach, actor.body, middle, world)) {
    refusal = "too far away to cut";
  } else if (world.FindBody(command.body) != nullptr && (command.from - command.to).norm() <= kLongestBlade &&
             (command.eye - middle).norm() <= kFarthestEye) {
    return physics::Blade{command.eye, command.from, command.to};
  }
  return {};
}

void Hands::Forget(ClientId client) {
  m_memory.grips.erase(client);
  m_memory.shoves.erase(client);
}

void Hands::Right(ClientId client, const physics::World& world) {
  const auto found = m_memory.grips.find(client);
  const physics::Body* body = found == m_memory.grips.end() ? nullptr : world.FindBody(found->second.command.body);
  if (body == nullptr) return;
  Grip& grip = found->second;
  const std::vector<Vector3d>& rest = world.BlueprintOf(*body).rest;
  if (grip.command.vertex >= rest.size()) return;
  for (std::size_t i = 0; i < grip.vertices.size(); ++i) {
    if (grip.vertices[i] < rest.size()) grip.offsets[i] = rest[grip.vertices[i]] - rest[grip.command.vertex];
  }
}

void Hands::Open(ClientId client) {
  const auto found = m_memory.grips.find(client);
  if (found != m_memory.grips.end()) found->second.vertices.clear();
}

void Hands::LetGo(physics::BodyId body) {
  for (auto& [client, grip] : m_memory.grips) {
    if (grip.command.body == body) grip.vertices.clear();
  }
  for (auto& [client, shove] : m_memory.shoves) {
    if (shove.command.body == body) shove.ticksLeft = 0;
  }
}

bool Hands::Write(const Memory& memory, const physics::World& world) {
  const auto areOf = [&](physics::BodyId id, const std::vector<std::uint16_t>& vertices) {
    const physics::Body* body = world.FindBody(id);
    if (body == nullptr || vertices.empty()) return true;
    return std::ranges::is_sorted(vertices, std::ranges::less_equal()) &&
           vertices.back() < world.BlueprintOf(*body).rest.size();
  };
  const auto isGrip = [&](const auto& entry) {
    const Grip& grip = entry.second;
    const physics::Body* body = world.FindBody(grip.command.body);
    const bool holds = body != nullptr && !grip.vertices.empty();
    const bool areOffsets = grip.offsets.size() == grip.vertices.size() &&
                            std::ranges::all_of(grip.offsets, [](const Vector3d& x) { return x.allFinite(); });
    return areOf(grip.command.body, grip.vertices) && areOffsets && grip.command.target.allFinite() &&
           (!holds || grip.command.vertex < world.BlueprintOf(*body).rest.size());
  };
  const auto isShove = [&](const auto& entry) {
    return areOf(entry.second.command.body, entry.second.vertices) && entry.second.command.direction.allFinite();
  };
  if (!std::ranges::all_of(memory.grips, isGrip) || !std::ranges::all_of(memory.shoves, isShove)) return false;
  m_memory = memory;
  return true;
}

void Hands::Act(physics::World& world) {
  for (auto& [client, grip] : m_memory.grips) {
    if (!grip.vertices.empty()) Drag(grip, world);
  }
  for (auto& [client, shove] : m_memory.shoves) {
    if (shove.ticksLeft > 0) Deal(shove, world);
    if (shove.ticksToRest > 0) --shove.ticksToRest;
  }
}

void Hands::Drag(Grip& grip, physics::World& world) {
  const physics::Body* body = world.FindBody(grip.command.body);
  // A client may name another body or vertex without closing its hand anew.
  const bool holds = body != nullptr && grip.command.vertex < world.BlueprintOf(*body).rest.size() &&
                     IsWithin(kSlip * m_rules.reach, grip.own, FindVertex(*body, grip.command.vertex), world);
  if (!holds) {
    grip.vertices.clear();
    return;
  }
  const double omega = std::min(kGripFrequency, kMostPerTick / m_tickDuration);
  const std::vector<double>& masses = world.BlueprintOf(*body).full.masses;
  m_forces.clear();
  double total = 0;
  std::size_t next = 0;
  VisitMotion(*body, [&](std::size_t i, const Vector3d& x, const Vector3d& v) {
    if (next == grip.vertices.size() || grip.vertices[next] != i) return;
    const Vector3d away = grip.command.target + grip.offsets[next] - x;
    ++next;
    const Vector3d force = masses[i] * (omega * omega * away - 2 * omega * v);
    total += force.norm();
    m_forces.push_back({static_cast<std::uint16_t>(i), force});
  });
  const double share = total > m_rules.strength ? m_rules.strength / total : 1;
  Vector3d sum = Vector3d::Zero();
  for (auto& each : m_forces) {
    each.force *= share;
    sum += each.force;
  }
  world.PushVertices(body->id, m_forces);
  PushBack(grip.own, -sum, world);
}

void Hands::Deal(Shove& shove, physics::World& world) {
  --shove.ticksLeft;
  const physics::Body* body = world.FindBody(shove.command.body);
  if (body == nullptr) return;
  const Vector3d force = m_rules.impulse / kShoveTime * shove.command.direction;
  m_forces.clear();
  for (const std::uint16_t vertex : shove.vertices) {
    m_forces.push_back({vertex, force / static_cast<double>(shove.vertices.size())});
  }
  world.PushVertices(body->id, m_forces);
  if (body->id != shove.own) PushBack(shove.own, -force, world);
}

// The force is spread by mass, so that it moves the body without denting it.
void Hands::PushBack(physics::BodyId own, const Vector3d& force, physics::World& world) {
  const physics::Body* body = world.FindBody(own);
  if (m_rules.reach == 0 || body == nullptr) return;
  const physics::Blueprint& blueprint = world.BlueprintOf(*body);
  m_forces.clear();
  for (std::size_t i = 0; i < blueprint.full.masses.size(); ++i) {
    m_forces.push_back({static_cast<std::uint16_t>(i), blueprint.full.masses[i] / blueprint.totalMass * force});
  }
  world.PushVertices(own, m_forces);
}

}  // namespace wobble::server
