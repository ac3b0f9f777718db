// A tick, phase by phase: Prepare (control, static contacts), Meet (who is near whom, and with which vertices), Wake
// (whoever sleeps and is touched), Island (bodies that hang together by contacts), Step (each island by itself), Finish
// (health, origin, sleep).
//
// Every phase runs in parallel over things that do not see each other: bodies, pairs, islands. Each is worked on by one
// thread from beginning to end and nothing is summed across threads, so the result cannot depend on how many there are.
// A island too large for one thread is stepped by all, body by body.
#include <algorithm>
#include <array>

#include "server/physics/pair_search.h"
#include "server/physics/shapes/tear.h"
#include "server/physics/step/control.h"
#include "server/physics/step/island_step.h"
#include "server/physics/step/substeps.h"
#include "server/physics/world_engine.h"

namespace wobble::physics {
namespace {

// Vertices from which on a island is stepped by all threads: below, they would wait for one another longer than they
// work.
constexpr std::size_t kLargeIsland = 2000;

// Bodies of several islands that are stepped together at most: their packs should stay in a core's own cache.
constexpr std::size_t kMostTogether = 32;

}  // namespace

// One tick in one precision.
template <class Real>
class World::Stepper {
 public:
  explicit Stepper(World& world)
      : m_world(world),
        m_bodies(world.m_bodies),
        m_roster(world.m_engine->roster),
        m_stepped(world.m_engine->stepped),
        m_threads(world.m_engine->threads),
        m_work(std::get<Workspace<Real>>(world.m_engine->workspaces)),
        m_duration(world.m_settings.tickDuration),
        m_rules{m_duration, m_duration * world.m_settings.errorTarget, world.m_settings.maxSubsteps},
        m_kernels(FindSweepKernels<Real>(world.m_settings.widestPack)),
        m_search({m_bodies, world.m_blueprints, m_roster}, m_duration, m_kernels.back(), m_threads, m_work) {}

  StepReport Step() {
    PrepareAll();
    m_search.FindPairs();
    m_search.MeetAll();
    WakeTouched();
    m_search.DropPairsApart();
    NoteStepped();
    FindAllIslands();
    StepAll();
    LetFallAsleep();
    return Report();
  }

 private:
  State<Real>& StateOf(std::size_t body) { return std::get<State<Real>>(m_bodies[body].state); }

  void PrepareAll() {
    const std::size_t count = m_bodies.size();
    m_work.members.resize(count);
    m_work.boxes.resize(count);
    m_work.outcomes.resize(count);
    m_work.falling.reserve(count);
    const std::span<const std::uint32_t> awake = m_roster.FindAwake();
    m_threads.ForEach(awake.size(), [&](std::size_t i) { Prepare(awake[i]); });
  }

  void Prepare(std::size_t i) {
    Body& body = m_bodies[i];
    Member<Real>& member = m_work.members[i];
    State<Real>& state = StateOf(i);
    member.blueprint = &m_world.m_blueprints[body.blueprint];
    member.state = &state;
    member.load =
        ApplyControl(*member.blueprint, m_world.m_settings.gravity, m_world.FindStiffnessRule(body), body, state);
    member.load.wind = m_world.m_settings.wind.template cast<Real>();
    AddDrives(body, member);
    member.substepsForError = body.steps.Substeps();
    member.health = Health::kGood;
    member.lost = false;
    member.surfaces.clear();
    for (const Obstacle& obstacle : m_world.m_obstacles) {
      member.surfaces.push_back(MakeSurface<Real>(obstacle, state.origin));
    }
    const Coefficients<Real>& coefficients = member.blueprint->template Read<Real>();
    member.survey = MakeSurvey<Real>(coefficients.masses, state.positions, state.velocities);
    FindContacts<Real>({.surfaces = member.surfaces,
                        .x = state.positions,
                        .v = state.velocities,
                        .survey = member.survey,
                        .range = coefficients.contact.range,
                        .duration = static_cast<Real>(m_duration)},
                       state.contacts, m_work.scratch.local().contacts);
    member.demands = FindSurfaceDemands<Real>(*member.blueprint, member.surfaces, state,
                                              double{member.survey.agitation}, m_duration);
    const Bounds<Real>& bounds = member.survey.bounds;
    const double fat = kNearMargin + m_duration * double{bounds.speed};
    m_work.boxes[i] = {state.origin + bounds.low.template cast<double>() - Vector3d::Constant(fat),
                       state.origin + bounds.high.template cast<double>() + Vector3d::Constant(fat)};
  }

  void AddDrives(const Body& body, Member<Real>& member) const {
    member.pushes.clear();
    for (const Drive& drive : m_world.m_drives) {
      if ((drive.body != 0 && drive.body != body.id) || !IsOn(drive, (m_world.m_tick - 1.0) * m_duration)) continue;
      member.load.wind += drive.wind.template cast<Real>();
      member.load.gasFactor *= static_cast<Real>(drive.gasFactor);
      const Vector3d share = drive.force / std::max(1.0, static_cast<double>(drive.vertices.size()));
      for (const std::uint16_t vertex : drive.vertices) member.pushes.push_back({vertex, share.template cast<Real>()});
    }
    for (const Push& push : m_world.PushesOn(body.id)) {
      member.pushes.push_back({push.force.vertex, push.force.force.template cast<Real>()});
    }
    member.load.pushes = member.pushes;
  }

  void WakeTouched() {
    while (m_search.WakeTouched()) {
      m_threads.ForEach(m_work.woken.size(), [this](std::size_t i) { Prepare(m_work.woken[i]); });
      m_search.MeetAll();
    }
  }

  // Whoever is awake from here on is stepped.
  void NoteStepped() {
    const std::span<const std::uint32_t> awake = m_roster.FindAwake();
    m_stepped.assign(awake.begin(), awake.end());
  }

  // Of those awake: bodies that hang together all sleep, or none.
  void FindAllIslands() {
    m_work.islands.Find(m_stepped, m_work.pairIndices);
    m_work.placeOf.resize(m_bodies.size());
    m_work.awakeIslands.clear();
    m_work.awakeIslands.reserve(m_bodies.size());
    for (std::uint32_t island = 0; island < m_work.islands.Count(); ++island) {
      const auto members = m_work.islands.MembersOf(island);
      for (std::uint32_t place = 0; place < members.size(); ++place) m_work.placeOf[members[place]] = place;
      m_work.awakeIslands.push_back(Describe(island));
    }
    FindContactPairs();
  }

  AwakeIsland Describe(std::uint32_t island) {
    const auto members = m_work.islands.MembersOf(island);
    std::size_t vertices = 0;
    bool inLanes = true;
    for (const std::uint32_t body : members) {
      const std::size_t own = m_work.members[body].state->positions.size();
      vertices += own;
      m_mostVertices = std::max(m_mostVertices, own);
      inLanes = inLanes && CanGoInPack<Real>(*m_work.members[body].blueprint);
    }
    m_allVertices += vertices;
    AwakeIsland described;
    described.island = island;
    described.vertices = vertices;
    if (inLanes) described.way = members.size() > 1 ? AwakeIsland::Way::kTogether : AwakeIsland::Way::kAlone;
    if (described.way == AwakeIsland::Way::kAlone) described.blueprint = m_bodies[members[0]].blueprint;
    return described;
  }

  // Pairs by island, in their order.
  void FindContactPairs() {
    std::vector<std::size_t>& begins = m_work.contactPairBegins;
    begins.assign(m_work.islands.Count() + 1, 0);
    const auto islandOf = [this](std::size_t pair) { return m_work.islands.IslandOf(m_work.pairIndices[pair][0]); };
    for (std::size_t i = 0; i < m_work.pairs.size(); ++i) ++begins[islandOf(i) + 1U];
    for (std::size_t island = 0; island + 1 < begins.size(); ++island) begins[island + 1] += begins[island];
    m_work.contactPairs.resize(m_work.pairs.size());
    for (std::size_t i = m_work.pairs.size(); i-- > 0;) {
      const auto [a, b] = m_work.pairIndices[i];
      const auto& ofA = m_work.members[a].blueprint->template Read<Real>().contact;
      const auto& ofB = m_work.members[b].blueprint->template Read<Real>().contact;
      m_work.contactPairs[--begins[islandOf(i) + 1U]] = {{m_work.placeOf[a], m_work.placeOf[b]},
                                                         Combine(ofA, ofB),
                                                         {&m_work.pairs[i].sides[0], &m_work.pairs[i].sides[1]}};
    }
    // Each island's end has been counted down to its begin: one step to the left, and they are begins again.
    begins.erase(begins.begin());
    begins.push_back(m_work.pairs.size());
  }

  std::span<const ContactPair<Real>> ContactPairsOf(std::uint32_t island) const {
    const std::size_t begin = m_work.contactPairBegins[island];
    return std::span(m_work.contactPairs).subspan(begin, m_work.contactPairBegins[island + 1U] - begin);
  }

  void StepAll() {
    std::vector<AwakeIsland>& islands = m_work.awakeIslands;
    m_threads.ForEach(islands.size(), [&](std::size_t i) {
      const std::span<Member<Real>* const> members = Collect({&islands[i], 1});
      Scratch<Real>& scratch = m_work.scratch.local();
      islands[i].substeps =
          FindFirstSubsteps<Real>(members, scratch.contactPairs, m_rules, scratch.loads, scratch.begins);
      if (FindIntegrator(members) != Integrator::kRungeKutta4) islands[i].way = AwakeIsland::Way::kPlain;
    });
    FindLarge();
    std::sort(islands.begin(), islands.end());
    FindBatches();
    const auto batch = [&](std::size_t i) {
      const std::size_t begin = m_work.batchBegins[i];
      return std::span<const AwakeIsland>(islands).subspan(begin, m_work.batchBegins[i + 1] - begin);
    };
    const std::size_t count = m_work.batchBegins.size() - 1;
    std::size_t small = count;
    while (small > 0 && batch(small - 1)[0].isLarge) StepOne(batch(--small), &m_threads);
    // Those that ask for most substeps first: whoever is done takes from the others what is left.
    m_threads.ForEach(small, [&](std::size_t i) { StepOne(batch(small - 1 - i), nullptr); });
  }

  // A island is stepped by all threads where it is more than one's share of the work: threads that step different
  // islands need not wait for one another before every stage.
  void FindLarge() {
    const auto work = [](const AwakeIsland& island) {
      return island.vertices * static_cast<std::size_t>(island.substeps);
    };
    std::size_t all = 0;
    for (const AwakeIsland& island : m_work.awakeIslands) all += work(island);
    const auto threads = static_cast<std::size_t>(m_world.m_settings.threads);
    for (AwakeIsland& island : m_work.awakeIslands) {
      island.isLarge = m_work.islands.MembersOf(island.island).size() > 1 && island.vertices >= kLargeIsland &&
                       work(island) * threads > all;
    }
  }

  // What goes in one batch asks for equal substeps. Bodies alone fill one pack; islands of several, which are stepped
  // stage by stage, come together until their packs have few lanes to spare.
  void FindBatches() {
    using Way = AwakeIsland::Way;
    const std::vector<AwakeIsland>& islands = m_work.awakeIslands;
    const auto lanes = static_cast<std::size_t>(m_kernels.back().width);
    std::vector<std::size_t>& begins = m_work.batchBegins;
    begins.clear();
    begins.reserve(islands.size() + 1);
    std::size_t bodies = 0;
    for (std::size_t i = 0; i < islands.size(); ++i) {
      const AwakeIsland& island = islands[i];
      const std::size_t own = m_work.islands.MembersOf(island.island).size();
      const bool fits = i > 0 && island.way != Way::kPlain && !island.isLarge && island.way == islands[i - 1].way &&
                        island.blueprint == islands[i - 1].blueprint && island.substeps == islands[i - 1].substeps &&
                        bodies + own <= (island.way == Way::kAlone ? lanes : kMostTogether);
      if (!fits) {
        begins.push_back(i);
        bodies = 0;
      }
      bodies += own;
    }
    begins.push_back(islands.size());
  }

  // Members, contact pairs and ranges of these islands, in this thread's scratch.
  std::span<Member<Real>* const> Collect(std::span<const AwakeIsland> islands) {
    Scratch<Real>& scratch = m_work.scratch.local();
    scratch.Reserve(m_allVertices, m_bodies.size());
    scratch.members.clear();
    scratch.contactPairs.clear();
    scratch.islands.clear();
    for (const AwakeIsland& each : islands) {
      Island island{.memberBegin = scratch.members.size(), .contactPairBegin = scratch.contactPairs.size()};
      for (ContactPair<Real> contactPair : ContactPairsOf(each.island)) {
        for (std::uint32_t& member : contactPair.members) member += static_cast<std::uint32_t>(island.memberBegin);
        scratch.contactPairs.push_back(contactPair);
      }
      for (const std::uint32_t body : m_work.islands.MembersOf(each.island)) {
        scratch.members.push_back(&m_work.members[body]);
      }
      island.memberEnd = scratch.members.size();
      island.contactPairEnd = scratch.contactPairs.size();
      scratch.islands.push_back(island);
    }
    scratch.outcomes.assign(islands.size(), {});
    return scratch.members;
  }

  void StepOne(std::span<const AwakeIsland> islands, Threads* threads) {
    const std::span<Member<Real>* const> members = Collect(islands);
    Scratch<Real>& scratch = m_work.scratch.local();
    scratch.batch.Reserve(m_mostVertices, m_allVertices, m_bodies.size());
    const int substeps = islands[0].substeps;
    if (islands[0].way == AwakeIsland::Way::kPlain) {
      scratch.outcomes[0] =
          StepIsland<Real>(members, scratch.contactPairs, substeps, m_rules, threads, scratch.batch.system);
    } else {
      StepBatch<Real>(members, scratch.contactPairs, scratch.islands, substeps, m_rules, m_kernels, threads,
                      scratch.batch, scratch.outcomes);
    }
    for (std::size_t i = 0; i < islands.size(); ++i) {
      const auto bodies = m_work.islands.MembersOf(islands[i].island);
      for (const std::uint32_t body : bodies) Finish(body, scratch.outcomes[i]);
      for (const ContactPair<Real>& contactPair : ContactPairsOf(islands[i].island)) Finish(contactPair, bodies);
    }
  }

  void Finish(std::uint32_t i, const IslandOutcome& steps) {
    Body& body = m_bodies[i];
    const Member<Real>& member = m_work.members[i];
    State<Real>& state = *member.state;
    m_work.outcomes[i] = {steps, member.health, member.lost};
    body.touchesBody = false;
    if (member.lost) {
      PutBackToRest(*member.blueprint, FindFreePlace(member, state.origin + member.survey.bulk.centre), state);
      body.steps = {};
      physics::WakeUp(body);
    } else {
      body.steps.Record(member.error, steps.substeps, m_rules.allowedError);
      NoteMotion(member, m_world.FindStiffnessRule(body).Find(1), body);
      Tear(i);
      Recentre(*member.blueprint, member.after.centre, state);
    }
  }

  void Tear(std::uint32_t i) {
    State<Real>& state = *m_work.members[i].state;
    if (state.torn.empty()) return;
    Outcome& outcome = m_work.outcomes[i];
    outcome.torn = FindTorn<Real>(m_work.members[i].blueprint->template Read<Real>(), state.positions, state.torn);
    Body& body = m_bodies[i];
    if (outcome.torn > 0 || body.tornTicks > 0) ++body.tornTicks;
    if (outcome.torn > 0) physics::WakeUp(body);
  }

  // Near `place`, clear of obstacles where there is room: a body is lost where it is crushed, and its rest shape put
  // there would stick in what has crushed it.
  Vector3d FindFreePlace(const Member<Real>& member, const Vector3d& place) const {
    Vector3d free = place;
    for (const Obstacle& obstacle : m_world.m_obstacles) {
      const SurfacePoint<double> point = FindSurfacePoint(MakeSurface<double>(obstacle, Vector3d::Zero()), free);
      const double missing = member.blueprint->reach - point.distance;
      if (missing > 0) free += missing * point.normal;
    }
    return free;
  }

  // A body that was reset has left those that it touched.
  void Finish(const ContactPair<Real>& contactPair, std::span<const std::uint32_t> bodies) {
    for (std::size_t side = 0; side < 2; ++side) {
      std::vector<BodyContact<Real>>& contacts = *contactPair.sides[side];
      const std::uint32_t a = bodies[contactPair.members[0]];
      const std::uint32_t b = bodies[contactPair.members[1]];
      if (m_work.outcomes[a].reset || m_work.outcomes[b].reset) contacts.clear();
      const bool touch = std::any_of(contacts.begin(), contacts.end(), [](const auto& each) { return each.touching; });
      m_bodies[a].touchesBody |= touch;
      m_bodies[b].touchesBody |= touch;
    }
  }

  void LetFallAsleep() {
    const int patience = static_cast<int>(kQuietTime / m_duration);
    m_work.falling.clear();
    for (std::uint32_t island = 0; island < m_work.islands.Count(); ++island) {
      const auto members = m_work.islands.MembersOf(island);
      const auto isQuiet = [&](std::uint32_t body) { return m_bodies[body].quietTicks >= patience; };
      if (!std::all_of(members.begin(), members.end(), isQuiet)) continue;
      m_work.falling.insert(m_work.falling.end(), members.begin(), members.end());
    }
    if (m_work.falling.empty()) return;
    std::sort(m_work.falling.begin(), m_work.falling.end());
    for (const std::uint32_t body : m_work.falling) FallAsleep(body);
    m_roster.LetSleep(m_work.falling, m_work.boxes);
    m_search.LetPairsRest();
  }

  void FallAsleep(std::uint32_t i) {
    State<Real>& state = StateOf(i);
    Member<Real>& member = m_work.members[i];
    physics::FallAsleep<Real>(m_bodies[i], state);
    member.survey = MakeSurvey<Real>(member.blueprint->template Read<Real>().masses, state.positions, state.velocities);
  }

  StepReport Report() const {
    StepReport report;
    report.awake = static_cast<std::uint32_t>(m_stepped.size());
    for (const std::uint32_t i : m_stepped) {
      const Outcome& outcome = m_work.outcomes[i];
      report.substeps += static_cast<std::uint64_t>(outcome.steps.substeps);
      report.allSubsteps += static_cast<std::uint64_t>(outcome.steps.allSubsteps);
      report.nonFinite += outcome.health == Health::kNonFinite ? 1 : 0;
      report.inverted += outcome.health == Health::kInverted ? 1 : 0;
      report.quarantined += outcome.health != Health::kGood ? 1 : 0;
      report.reset += outcome.reset ? 1 : 0;
      report.torn += static_cast<std::uint32_t>(outcome.torn);
      if (report.firstQuarantined == 0 && outcome.health != Health::kGood) report.firstQuarantined = m_bodies[i].id;
    }
    return report;
  }

  World& m_world;
  std::vector<Body>& m_bodies;
  Roster& m_roster;
  std::vector<std::uint32_t>& m_stepped;
  Threads& m_threads;
  Workspace<Real>& m_work;
  double m_duration;
  StepRules m_rules;
  std::span<const SweepKernel<Real>> m_kernels;
  PairSearch<Real> m_search;
  std::size_t m_mostVertices = 0;  // of one body that is awake
  std::size_t m_allVertices = 0;   // of all those
};

StepReport World::Step() {
  ++m_tick;
  WakeTheDriven();
  m_engine->gravity = m_settings.gravity;
  const StepReport report =
      m_settings.precision == Precision::kSingle ? Stepper<float>(*this).Step() : Stepper<double>(*this).Step();
  m_pushes.clear();
  RebuildTorn();
  return report;
}

}  // namespace wobble::physics
