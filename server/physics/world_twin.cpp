// A world that goes on from where another one is, in whatever precision: so that what was played can be compared with
// what would have come of it in finer steps. Positions and velocities alone would not do: friction pulls towards where
// a contact began, and a face is followed from tick to tick.
//
// What a twin is without: boxes and surfaces of sleepers, which live in the workspace only. Hence it is awake, and what
// does not move falls asleep in it once more.
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

// Each field by its name: one that is added later and forgotten here does not compile.
template <class To, class From>
Contact<To> Convert(const Contact<From>& from) {
  const auto& [surface, vertex, touching, buried, anchor, slip, side] = from;
  return {surface, vertex, touching, buried, Convert<To>(anchor), Convert<To>(slip), Convert<To>(side)};
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
State<To> Convert(const State<From>& from) {
  const auto& [origin, positions, velocities, contacts, torn] = from;
  State<To> to{origin, Convert<To>(positions), Convert<To>(velocities), {}, torn};
  for (const Contact<From>& contact : contacts) to.contacts.push_back(Convert<To>(contact));
  return to;
}

template <class To, class From>
void CopyPairs(const Workspace<From>& from, Workspace<To>& to) {
  for (const auto* pairs : {&from.pairs, &from.restingPairs}) {
    for (const BodyPair<From>& pair : *pairs) {
      to.pairs.push_back({pair.first, pair.second, {}, {}});
      for (std::size_t side = 0; side < 2; ++side) {
        for (const auto& contact : pair.sides[side]) to.pairs.back().sides[side].push_back(Convert<To>(contact));
      }
    }
  }
  std::sort(to.pairs.begin(), to.pairs.end(), ComesBefore<To>);
}

}  // namespace

World::World(const World& other, const WorldSettings& settings)
    : m_settings(settings),
      m_blueprints(other.m_blueprints),
      m_slots(other.m_slots),
      m_blueprintRevision(other.m_blueprintRevision),
      m_obstacles(other.m_obstacles),
      m_bodies(other.m_bodies),
      m_tearing(other.m_tearing),
      m_drives(other.m_drives),
      m_pushes(other.m_pushes),
      m_engine(std::make_unique<Engine>(settings.threads)),
      m_nextId(other.m_nextId),
      // Drives go by the time, which is counted in ticks.
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
  const auto copy = [&](const auto& from) {
    if (settings.precision == Precision::kSingle) {
      CopyPairs(from, std::get<Workspace<float>>(m_engine->workspaces));
    } else {
      CopyPairs(from, std::get<Workspace<double>>(m_engine->workspaces));
    }
  };
  if (other.m_settings.precision == Precision::kSingle) {
    copy(std::get<Workspace<float>>(other.m_engine->workspaces));
  } else {
    copy(std::get<Workspace<double>>(other.m_engine->workspaces));
  }
}

}  // namespace wobble::physics
