// Bodies are finished island by island, each by the thread that stepped it.
#include "server/physics/world_finish.h"

#include <algorithm>

#include "server/physics/shapes/tear.h"

namespace wobble::physics {
namespace {

// A lattice may stay folded for as long as something heavy lies on it.
constexpr int kMostTicksInARow = 1 << 20;

// A place near `place` where the body's rest shape is clear of obstacles, if there is room. A body is lost where
// something crushes it, and its rest shape put there would stick in what crushed it.
template <class Real>
Vector3d FindFreePlace(std::span<const Obstacle> obstacles, const Member<Real>& member, const Vector3d& place) {
  Vector3d free = place;
  for (const Obstacle& obstacle : obstacles) {
    const SurfacePoint<double> point = FindSurfacePoint(MakeSurface<double>(obstacle, Vector3d::Zero()), free);
    const double missing = member.blueprint->reach - point.distance;
    if (missing > 0) free += missing * point.normal;
  }
  return free;
}

// Returns the number of springs that tore.
template <class Real>
std::size_t TearSprings(const Member<Real>& member, Body& body) {
  State<Real>& state = *member.state;
  if (state.torn.empty()) return 0;
  const std::size_t torn = FindTorn<Real>(member.blueprint->template Read<Real>(), state.positions, state.torn);
  if (torn > 0 || body.tornTicks > 0) ++body.tornTicks;
  if (torn > 0) WakeUp(body);
  return torn;
}

template <class Real>
Outcome FinishBody(const Surroundings& surroundings, const BlueprintSlot& slot, double allowedError,
                   const Member<Real>& member, const IslandOutcome& steps, Body& body) {
  State<Real>& state = *member.state;
  body.invertedTicks = member.insideOut ? std::min(body.invertedTicks, kMostTicksInARow) + 1 : 0;
  body.lostTicks = member.hasLostShape ? std::min(body.lostTicks, kMostTicksInARow) + 1 : 0;
  const bool staysInverted = body.invertedTicks * surroundings.settings.tickDuration > kInvertedTime;
  Outcome outcome{.steps = steps,
                  .health = member.health,
                  .inverted = member.insideOut && member.health != Health::kNonFinite,
                  .reset = member.lost || staysInverted};
  body.touchesBody = false;  // until FinishContactPair finds a contact
  if (outcome.reset) {
    const Vector3d& centre = member.survey.bulk.centre;  // no number if the tick began so; the origin is near it
    const Vector3d place = centre.allFinite() ? Vector3d(state.origin + centre) : state.origin;
    PutBackToRest(*member.blueprint, FindFreePlace(surroundings.obstacles, member, place), state);
    body.steps = {};
    body.invertedTicks = 0;
    body.lostTicks = 0;
    body.selfRoom = 0;
    WakeUp(body);
  } else {
    body.steps.Record(member.error, steps.substeps, allowedError);
    NoteMotion(member, FindStiffnessRule(surroundings.settings, slot).Find(1), body);
    outcome.torn = TearSprings(member, body);
    Recentre(*member.blueprint, member.after.centre, state);
  }
  return outcome;
}

// Notes which bodies touch. A body that was reset has left the bodies that it touched.
template <class Real>
void FinishContactPair(const ContactPair<Real>& contactPair, std::span<const std::uint32_t> places,
                       std::span<const Outcome> outcomes, std::span<Body> bodies) {
  const std::uint32_t a = places[contactPair.members[0]];
  const std::uint32_t b = places[contactPair.members[1]];
  for (std::vector<BodyContact<Real>>* contacts : contactPair.sides) {
    if (outcomes[a].reset || outcomes[b].reset) contacts->clear();
    const bool touch = std::any_of(contacts->begin(), contacts->end(),
                                   [](const auto& each) { return each.phase == ContactPhase::kTouching; });
    bodies[a].touchesBody |= touch;
    bodies[b].touchesBody |= touch;
  }
  if (outcomes[a].reset || outcomes[b].reset) {
    contactPair.edges->clear();
    *contactPair.core = {};
    *contactPair.tangle = {};
  }
  if (a == b) return;
  const bool touch = std::any_of(contactPair.edges->begin(), contactPair.edges->end(),
                                 [](const auto& each) { return each.phase == EdgePhase::kTouching; });
  bodies[a].touchesBody |= touch;
  bodies[b].touchesBody |= touch;
}

}  // namespace

template <class Real>
void FinishIsland(const Surroundings& surroundings, std::span<const BlueprintSlot> slots, double allowedError,
                  std::uint32_t island, const IslandOutcome& steps, std::span<Body> bodies, Workspace<Real>& work) {
  const std::span<const std::uint32_t> places = work.islands.islands.MembersOf(island);
  for (const std::uint32_t place : places) {
    Body& body = bodies[place];
    work.outcomes[place] =
        FinishBody(surroundings, slots[body.blueprint], allowedError, work.members[place], steps, body);
  }
  for (const ContactPair<Real>& contactPair : work.islands.ContactPairsOf(island)) {
    FinishContactPair<Real>(contactPair, places, work.outcomes, bodies);
  }
}

template <class Real>
void LetFallAsleep(double tickDuration, std::span<Body> bodies, Roster& roster, PairSearch<Real>& search,
                   Workspace<Real>& work) {
  FindQuietIslands(tickDuration, work.islands.islands, bodies, work.falling);
  if (work.falling.empty()) return;
  for (const std::uint32_t place : work.falling) {
    Member<Real>& member = work.members[place];
    State<Real>& state = *member.state;
    FallAsleep<Real>(bodies[place], state);
    member.survey = MakeSurvey<Real>(member.blueprint->template Read<Real>().masses, state.positions, state.velocities);
  }
  roster.LetSleep(work.falling, work.boxes);
  search.LetPairsRest();
}

StepReport MakeReport(std::span<const std::uint32_t> stepped, std::span<const Body> bodies,
                      std::span<const Outcome> outcomes) {
  StepReport report;
  report.awake = static_cast<std::uint32_t>(stepped.size());
  for (const std::uint32_t place : stepped) {
    const Outcome& outcome = outcomes[place];
    report.substeps += static_cast<std::uint64_t>(outcome.steps.substeps);
    report.allSubsteps += static_cast<std::uint64_t>(outcome.steps.allSubsteps);
    report.nonFinite += outcome.health == Health::kNonFinite ? 1 : 0;
    report.inverted += outcome.inverted ? 1 : 0;
    const bool quarantined = outcome.health != Health::kGood || outcome.reset;
    report.quarantined += quarantined ? 1 : 0;
    report.reset += outcome.reset ? 1 : 0;
    report.torn += static_cast<std::uint32_t>(outcome.torn);
    if (report.firstQuarantined == 0 && quarantined) report.firstQuarantined = bodies[place].id;
  }
  return report;
}

template void FinishIsland<float>(const Surroundings&, std::span<const BlueprintSlot>, double, std::uint32_t,
                                  const IslandOutcome&, std::span<Body>, Workspace<float>&);
template void FinishIsland<double>(const Surroundings&, std::span<const BlueprintSlot>, double, std::uint32_t,
                                   const IslandOutcome&, std::span<Body>, Workspace<double>&);
template void LetFallAsleep<float>(double, std::span<Body>, Roster&, PairSearch<float>&, Workspace<float>&);
template void LetFallAsleep<double>(double, std::span<Body>, Roster&, PairSearch<double>&, Workspace<double>&);

}  // namespace wobble::physics
