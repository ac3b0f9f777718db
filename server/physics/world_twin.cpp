// A copy of a world, in any precision, that goes on from the same state: the laboratory compares what was played with
// the same ticks in finer steps. Positions and velocities alone would not do: friction pulls towards where a contact
// began, and contacts with faces remember their face from tick to tick.
//
// A twin does not copy boxes and surfaces of sleeping bodies, which live in the workspace only. Hence all its bodies
// are awake, and those at rest fall asleep again.
#include <algorithm>
#include <cmath>

#include "server/physics/methods/stability.h"
#include "server/physics/world_engine.h"

namespace wobble::physics {
namespace {

template <class To, class From>
Vector3<To> Convert(const Vector3<From>& from) {
  return from.template cast<To>();
}

template <class To, class From>
std::vector<Vector3<To>> Convert(const std::vector<Vector3<From>>& from) {
  std::vector<Vector3<To>> to;
  to.reserve(from.size());
  for (const Vector3<From>& each : from) to.push_back(Convert<To>(each));
  return to;
}

// The structured binding names every field, so that a field that is added later and forgotten here does not compile.
template <class To, class From>
Contact<To> Convert(const Contact<From>& from) {
  const auto& [surface, vertex, touching, buried, anchor, slip, side] = from;
  return {.surface = surface,
          .vertex = vertex,
          .touching = touching,
          .buried = buried,
          .anchor = Convert<To>(anchor),
          .slip = Convert<To>(slip),
          .side = Convert<To>(side)};
}

template <class To, class From>
BodyContact<To> Convert(const BodyContact<From>& from) {
  const auto& [vertex, face, phase, side, maxDepth, depth, leap, foot, slip, outward] = from;
  return {vertex,
          face,
          phase,
          side,
          static_cast<To>(maxDepth),
          static_cast<To>(depth),
          static_cast<To>(leap),
          Convert<To>(foot),
          Convert<To>(slip),
          Convert<To>(outward)};
}

template <class To, class From>
EdgeContact<To> Convert(const EdgeContact<From>& from) {
  const auto& [first, second, phase, depth, leap, s, t, normal, slip] = from;
  return {.first = first,
          .second = second,
          .phase = phase,
          .depth = static_cast<To>(depth),
          .leap = static_cast<To>(leap),
          .s = static_cast<To>(s),
          .t = static_cast<To>(t),
          .normal = Convert<To>(normal),
          .slip = Convert<To>(slip)};
}

template <class To, class From>
State<To> Convert(const State<From>& from) {
  const auto& [origin, positions, velocities, contacts, torn] = from;
  State<To> to{.origin = origin,
               .positions = Convert<To>(positions),
               .velocities = Convert<To>(velocities),
               .contacts = {},
               .torn = torn};
  for (const Contact<From>& contact : contacts) to.contacts.push_back(Convert<To>(contact));
  return to;
}

template <class To, class From>
void CopyPairs(const PairLists<From>& from, PairLists<To>& to) {
  for (const auto* pairs : {&from.awake, &from.resting}) {
    for (const BodyPair<From>& pair : *pairs) {
      BodyPair<To>& copy = to.awake.emplace_back();
      copy.first = pair.first;
      copy.second = pair.second;
      copy.core = pair.core;
      copy.gap = pair.gap;
      copy.tangle = pair.tangle;
      for (std::size_t side = 0; side < 2; ++side) {
        for (const auto& contact : pair.sides[side]) copy.sides[side].push_back(Convert<To>(contact));
      }
      for (const auto& contact : pair.edges) copy.edges.push_back(Convert<To>(contact));
    }
  }
  std::sort(to.awake.begin(), to.awake.end(), ComesBefore<To>);
}

}  // namespace

World::World(const World& other, const WorldSettings& settings)
    : m_settings(settings),
      m_blueprints(other.m_blueprints),
      m_slots(other.m_slots),
      m_recipes(other.m_recipes),
      m_blueprintRevision(other.m_blueprintRevision),
      m_obstacles(other.m_obstacles),
      m_bodies(other.m_bodies),
      m_tearing(other.m_tearing),
      m_drives(other.m_drives),
      m_stepForces(other.m_stepForces),
      m_engine(std::make_unique<Engine>(settings)),
      m_nextId(other.m_nextId),
      // Drives go by the time, so the twin counts as many of its own ticks as that time holds.
      m_tick(static_cast<std::uint32_t>(
          std::lround(other.m_tick * other.m_settings.tickDuration / settings.tickDuration))) {
  for (std::size_t i = 0; i < m_slots.size(); ++i) {
    m_slots[i].stiffnessBound = FindStiffnessBound(m_blueprints[i], settings.tickDuration);
  }
  for (Body& body : m_bodies) {
    physics::WakeUp(body);
    m_engine->roster.Add();
    if (settings.precision == other.m_settings.precision) continue;
    if (settings.precision == Precision::kSingle) {
      body.state = Convert<float>(std::get<State<double>>(body.state));
    } else {
      body.state = Convert<double>(std::get<State<float>>(body.state));
    }
  }
  std::visit([](const auto& from, auto& to) { CopyPairs(from.pairs, to.pairs); }, other.m_engine->workspace,
             m_engine->workspace);
}

}  // namespace wobble::physics
