// A tick, phase by phase: Prepare (control, static contacts), Meet (who is near whom, and with which vertices), Group
// (bodies that hang together by contacts), Step (each group by itself), Finish (health, origin).
//
// Every phase runs in parallel over things that do not see each other: bodies, pairs, groups. Each is worked on by one
// thread from beginning to end and nothing is summed across threads, so the result cannot depend on how many there are.
#include "server/physics/world.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "server/physics/broad_phase.h"
#include "server/physics/control.h"
#include "server/physics/group_step.h"
#include "server/physics/parallel.h"

namespace wobble::physics {
namespace {

// How near bodies are looked at beyond the way they go in the tick, m: what gravity and springs may add.
constexpr double kMargin = 0.02;

// Room for so many contacts is made when two bodies meet: more seldom come, and a list that is full grows.
constexpr std::size_t kLikelyContacts = 128;

// Two bodies near one another, and what lives on of their contacts from tick to tick. first < second.
template <class Real>
struct BodyPair {
  BodyId first = 0;
  BodyId second = 0;
  std::array<std::vector<BodyContact<Real>>, 2> sides;  // as in Encounter
};

template <class Real>
bool ComesBefore(const BodyPair<Real>& a, const BodyPair<Real>& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

struct Outcome {
  int substeps = 0;
  bool nonFinite = false;
  bool inverted = false;
};

template <class Real>
struct Scratch {
  GroupScratch<Real> group;
  std::vector<Contact<Real>> contacts;
  std::vector<BodyContact<Real>> bodyContacts;
  std::vector<Member<Real>*> members;
};

// What Step works with, kept to save allocations; only `pairs` carries anything from one tick to the next.
template <class Real>
struct Workspace {
  std::vector<BodyPair<Real>> pairs;  // ascending
  std::vector<BodyPair<Real>> pairsBefore;
  std::vector<std::vector<BodyContact<Real>>> spareLists;  // of pairs that have parted
  std::vector<IndexPair> pairIndices;                      // the bodies of `pairs`, by their places in the world
  std::vector<Member<Real>> members;                       // of all bodies
  std::vector<Box> boxes;
  BroadPhase broadPhase;
  std::vector<Vector3d> safePlaces;
  Groups groups;
  std::vector<std::uint32_t> placeOf;       // of each body in its group
  std::vector<Encounter<Real>> encounters;  // those of group g from encounterBegins[g] up to encounterBegins[g + 1]
  std::vector<std::size_t> encounterBegins;
  std::vector<Outcome> outcomes;
  tbb::enumerable_thread_specific<Scratch<Real>> scratch;
};

}  // namespace

struct World::Engine {
  explicit Engine(int threadCount) : threads(threadCount) {}
  Threads threads;
  std::tuple<Workspace<float>, Workspace<double>> workspaces;  // the world's precision uses one
};

// One tick in one precision.
template <class Real>
class World::Stepper {
 public:
  explicit Stepper(World& world)
      : m_world(world),
        m_threads(world.m_engine->threads),
        m_work(std::get<Workspace<Real>>(world.m_engine->workspaces)) {}

  StepReport Step() {
    PrepareAll();
    MeetAll();
    FindAllGroups();
    StepAll();
    return Report();
  }

 private:
  State<Real>& StateOf(std::size_t body) { return std::get<State<Real>>(m_world.m_bodies[body].state); }

  void PrepareAll() {
    const std::size_t count = m_world.m_bodies.size();
    m_work.members.resize(count);
    m_work.boxes.resize(count);
    m_work.safePlaces.resize(count);
    m_work.outcomes.assign(count, {});
    m_threads.ForEach(count, [this](std::size_t i) { Prepare(i); });
  }

  void Prepare(std::size_t i) {
    const double duration = m_world.m_settings.tickDuration;
    Body& body = m_world.m_bodies[i];
    State<Real>& state = StateOf(i);
    Member<Real>& member = m_work.members[i];
    member.blueprint = &m_world.m_blueprints[body.blueprint];
    member.state = &state;
    m_work.safePlaces[i] = physics::FindCentre(*member.blueprint, state);
    member.load = ApplyControl(*member.blueprint, m_world.m_settings.gravity, body, state);
    member.surfaces.clear();
    for (const Obstacle& obstacle : m_world.m_obstacles) {
      member.surfaces.push_back(MakeSurface<Real>(obstacle, state.origin));
    }
    member.bounds = FindBounds<Real>(state.positions, state.velocities);
    const Real range = member.blueprint->template Read<Real>().contact.range;
    FindContacts<Real>(member.surfaces, range, member.bounds, state.positions, state.velocities,
                       static_cast<Real>(duration), state.contacts, m_work.scratch.local().contacts);
    const double fat = kMargin + duration * double{member.bounds.speed};
    m_work.boxes[i] = {state.origin + member.bounds.low.template cast<double>() - Vector3d::Constant(fat),
                       state.origin + member.bounds.high.template cast<double>() + Vector3d::Constant(fat)};
  }

  void MeetAll() {
    m_work.pairs.swap(m_work.pairsBefore);
    m_work.pairs.clear();
    m_work.pairIndices.clear();
    auto before = m_work.pairsBefore.begin();
    for (const auto& [a, b] : m_work.broadPhase.FindOverlaps(m_work.boxes)) {
      if (HasNoFaces(a) || HasNoFaces(b)) continue;
      BodyPair<Real> pair{m_world.m_bodies[a].id, m_world.m_bodies[b].id, {}};
      for (; before != m_work.pairsBefore.end() && ComesBefore(*before, pair); ++before) Recycle(*before);
      const bool known = before != m_work.pairsBefore.end() && !ComesBefore(pair, *before);
      for (std::size_t side = 0; side < 2; ++side) {
        pair.sides[side] = known ? std::move(before->sides[side]) : TakeSpareList();
      }
      if (known) ++before;
      m_work.pairs.push_back(std::move(pair));
      m_work.pairIndices.push_back({a, b});
    }
    for (; before != m_work.pairsBefore.end(); ++before) Recycle(*before);
    m_threads.ForEach(m_work.pairs.size(), [this](std::size_t i) { Meet(i); });
    DropPairsApart();
  }

  void Recycle(BodyPair<Real>& pair) {
    for (auto& side : pair.sides) m_work.spareLists.push_back(std::move(side));
  }

  std::vector<BodyContact<Real>> TakeSpareList() {
    std::vector<BodyContact<Real>> list;
    if (!m_work.spareLists.empty()) {
      list = std::move(m_work.spareLists.back());
      m_work.spareLists.pop_back();
    }
    list.clear();
    list.reserve(kLikelyContacts);
    return list;
  }

  bool HasNoFaces(std::uint32_t body) const { return m_work.members[body].blueprint->full.faces.empty(); }

  void Meet(std::size_t i) {
    const double duration = m_world.m_settings.tickDuration;
    for (std::size_t side = 0; side < 2; ++side) {
      const Member<Real>& vertices = m_work.members[m_work.pairIndices[i][side]];
      const Member<Real>& faces = m_work.members[m_work.pairIndices[i][1 - side]];
      const Meeting<Real> meeting = MakeMeeting<Real>(vertices, vertices.state->positions, vertices.state->velocities,
                                                      faces, faces.state->positions, faces.state->velocities);
      Bounds<Real> near = faces.bounds;
      near.speed += vertices.bounds.speed;
      const Real fat = static_cast<Real>(kMargin) + near.speed * static_cast<Real>(duration);
      near.low.array() -= fat;
      near.high.array() += fat;
      FindBodyContacts<Real>(meeting, vertices.blueprint->topology.vertices, near, static_cast<Real>(kMargin),
                             static_cast<Real>(duration), m_work.pairs[i].sides[side],
                             m_work.scratch.local().bodyContacts);
    }
  }

  // Boxes that overlap without a vertex near a face bind nothing together.
  void DropPairsApart() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < m_work.pairs.size(); ++i) {
      if (m_work.pairs[i].sides[0].empty() && m_work.pairs[i].sides[1].empty()) {
        Recycle(m_work.pairs[i]);
        continue;
      }
      if (kept != i) {
        m_work.pairs[kept] = std::move(m_work.pairs[i]);
        m_work.pairIndices[kept] = m_work.pairIndices[i];
      }
      ++kept;
    }
    m_work.pairs.resize(kept);
    m_work.pairIndices.resize(kept);
  }

  void FindAllGroups() {
    const std::size_t count = m_world.m_bodies.size();
    m_work.groups.Find(count, m_work.pairIndices);
    m_work.placeOf.resize(count);
    for (std::uint32_t group = 0; group < m_work.groups.Count(); ++group) {
      const auto members = m_work.groups.MembersOf(group);
      for (std::uint32_t place = 0; place < members.size(); ++place) m_work.placeOf[members[place]] = place;
    }
    FindEncounters();
  }

  // Pairs by group, in their order.
  void FindEncounters() {
    std::vector<std::size_t>& begins = m_work.encounterBegins;
    begins.assign(m_work.groups.Count() + 1, 0);
    const auto groupOf = [this](std::size_t pair) { return m_work.groups.GroupOf(m_work.pairIndices[pair][0]); };
    for (std::size_t i = 0; i < m_work.pairs.size(); ++i) ++begins[groupOf(i) + 1U];
    for (std::size_t group = 0; group + 1 < begins.size(); ++group) begins[group + 1] += begins[group];
    m_work.encounters.resize(m_work.pairs.size());
    for (std::size_t i = m_work.pairs.size(); i-- > 0;) {
      const auto [a, b] = m_work.pairIndices[i];
      const auto& ofA = m_work.members[a].blueprint->template Read<Real>().contact;
      const auto& ofB = m_work.members[b].blueprint->template Read<Real>().contact;
      m_work.encounters[--begins[groupOf(i) + 1U]] = {{m_work.placeOf[a], m_work.placeOf[b]},
                                                      Combine(ofA, ofB),
                                                      {&m_work.pairs[i].sides[0], &m_work.pairs[i].sides[1]}};
    }
    // Each group's end has been counted down to its begin: one step to the left, and they are begins again.
    begins.erase(begins.begin());
    begins.push_back(m_work.pairs.size());
  }

  void StepAll() {
    std::size_t vertices = 0;
    for (const Member<Real>& member : m_work.members) vertices += member.state->positions.size();
    m_threads.ForEach(m_work.groups.Count(), [this, vertices](std::size_t group) {
      Scratch<Real>& scratch = m_work.scratch.local();
      scratch.group.Reserve(vertices, m_work.members.size());
      scratch.members.reserve(m_work.members.size());
      const auto bodies = m_work.groups.MembersOf(group);
      scratch.members.clear();
      for (const std::uint32_t body : bodies) scratch.members.push_back(&m_work.members[body]);
      const std::size_t begin = m_work.encounterBegins[group];
      const auto encounters =
          std::span<const Encounter<Real>>(m_work.encounters).subspan(begin, m_work.encounterBegins[group + 1] - begin);
      const int substeps = StepGroup<Real>(scratch.members, encounters, m_world.m_settings.tickDuration, scratch.group);
      for (const std::uint32_t body : bodies) Finish(body, substeps);
      for (const Encounter<Real>& encounter : encounters) Finish(encounter, bodies);
    });
  }

  void Finish(std::uint32_t i, int substeps) {
    State<Real>& state = StateOf(i);
    const Blueprint& blueprint = *m_work.members[i].blueprint;
    const Coefficients<Real>& coefficients = blueprint.template Read<Real>();
    m_world.m_bodies[i].touchesBody = false;
    Outcome& outcome = m_work.outcomes[i];
    outcome.substeps = substeps;
    outcome.nonFinite = !IsFinite(state);
    outcome.inverted = !outcome.nonFinite && coefficients.gas > Real(0) &&
                       !(ComputeVolume<Real>(coefficients.faces, state.positions) > Real(0));
    if (outcome.nonFinite || outcome.inverted) {
      state = MakeState<Real>(blueprint, m_work.safePlaces[i], Vector3d::Zero());
    } else {
      Recentre(blueprint, state);
    }
  }

  // A body that was reset has left those that it touched.
  void Finish(const Encounter<Real>& encounter, std::span<const std::uint32_t> bodies) {
    for (std::size_t side = 0; side < 2; ++side) {
      std::vector<BodyContact<Real>>& contacts = *encounter.sides[side];
      const std::uint32_t a = bodies[encounter.members[0]];
      const std::uint32_t b = bodies[encounter.members[1]];
      if (WasReset(a) || WasReset(b)) contacts.clear();
      const bool touch = std::any_of(contacts.begin(), contacts.end(), [](const auto& each) { return each.touching; });
      m_world.m_bodies[a].touchesBody |= touch;
      m_world.m_bodies[b].touchesBody |= touch;
    }
  }

  bool WasReset(std::uint32_t body) const { return m_work.outcomes[body].nonFinite || m_work.outcomes[body].inverted; }

  StepReport Report() const {
    StepReport report;
    report.awake = static_cast<std::uint32_t>(m_world.m_bodies.size());
    for (const Outcome& outcome : m_work.outcomes) {
      report.substeps += static_cast<std::uint64_t>(outcome.substeps);
      report.nonFinite += outcome.nonFinite ? 1 : 0;
      report.inverted += outcome.inverted ? 1 : 0;
    }
    return report;
  }

  World& m_world;
  Threads& m_threads;
  Workspace<Real>& m_work;
};

World::World(const WorldSettings& settings)
    : m_settings(settings), m_engine(std::make_unique<Engine>(settings.threads)) {
  assert(settings.threads >= 1 && settings.tickDuration > 0);
}

World::~World() = default;

std::uint8_t World::AddBlueprint(Blueprint blueprint) {
  assert(m_bodies.empty() && m_blueprints.size() < 255);
  m_blueprints.push_back(std::move(blueprint));
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
  if (m_settings.precision == Precision::kSingle) {
    body.state = MakeState<float>(m_blueprints[blueprint], position, velocity);
  } else {
    body.state = MakeState<double>(m_blueprints[blueprint], position, velocity);
  }
  m_bodies.push_back(std::move(body));
  return m_bodies.back().id;
}

Body& World::FindBody(BodyId id) {
  const auto found = std::lower_bound(m_bodies.begin(), m_bodies.end(), id,
                                      [](const Body& body, BodyId wanted) { return body.id < wanted; });
  assert(found != m_bodies.end() && found->id == id);
  return *found;
}

const Body& World::ReadBody(BodyId id) const { return const_cast<World*>(this)->FindBody(id); }

void World::RemoveBody(BodyId id) {
  DropPairsOf(id);
  m_bodies.erase(m_bodies.begin() + (&FindBody(id) - m_bodies.data()));
}

void World::PlaceBody(BodyId id, const Vector3d& position) {
  DropPairsOf(id);
  Body& body = FindBody(id);
  std::visit(
      [&]<class Real>(State<Real>& state) {
        state = MakeState<Real>(m_blueprints[body.blueprint], position, Vector3d::Zero());
      },
      body.state);
}

void World::SetControl(BodyId id, const Control& control, const ControlLimits& limits) {
  assert(control.moveX * control.moveX + control.moveY * control.moveY <= 1.0001);
  Body& body = FindBody(id);
  body.control = control;
  body.limits = limits;
}

void World::DropPairsOf(BodyId id) {
  const auto drop = [id](auto& workspace) {
    std::erase_if(workspace.pairs, [id](const auto& pair) { return pair.first == id || pair.second == id; });
  };
  drop(std::get<Workspace<float>>(m_engine->workspaces));
  drop(std::get<Workspace<double>>(m_engine->workspaces));
}

StepReport World::Step() {
  ++m_tick;
  return m_settings.precision == Precision::kSingle ? Stepper<float>(*this).Step() : Stepper<double>(*this).Step();
}

Vector3d World::FindCentre(const Body& body) const {
  return std::visit([&](const auto& state) { return physics::FindCentre(m_blueprints[body.blueprint], state); },
                    body.state);
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
