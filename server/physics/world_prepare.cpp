// Bodies are prepared one by one: nothing here looks at two of them.
#include "server/physics/world_prepare.h"

#include <algorithm>

#include "server/physics/methods/recovery.h"
#include "server/physics/pair_search.h"
#include "server/physics/step/control.h"
#include "server/physics/step/losses.h"

namespace wobble::physics {
namespace {

// Wind, gas and forces of the drives that are on, and the forces of this step.
template <class Real>
void AddDrives(const Surroundings& surroundings, BodyId body, Member<Real>& member) {
  member.pushes.clear();
  for (const Drive& drive : surroundings.drives) {
    if ((drive.body != 0 && drive.body != body) || !IsOn(drive, surroundings.time)) continue;
    member.load.wind += drive.wind.template cast<Real>();
    member.load.gasFactor *= static_cast<Real>(drive.gasFactor);
    const Vector3d share = drive.force / std::max(1.0, static_cast<double>(drive.vertices.size()));
    for (const std::uint16_t vertex : drive.vertices) member.pushes.push_back({vertex, share.template cast<Real>()});
  }
  for (const StepForce& each : FindForcesOn(body, surroundings.stepForces)) {
    member.pushes.push_back({each.force.vertex, each.force.force.template cast<Real>()});
  }
}

// Ticks between two looks at a body that was not folded at the last: a look at a lattice that is badly out of shape
// costs a fifth of its tick.
constexpr std::uint32_t kFoldLookTicks = 8;

// Of its own reach, that a body may go in a tick and still be looked for on its way: in 64 substeps, the most by
// default, it then passes whole bodies between two of them, and no step finds what it meets. At 10⁶ m/s one cloth was
// near all within 16 km: its tick took seconds, and all of their island were put back with it.
constexpr double kMostReachesPerTick = 64;

// Whether the body is to be brought back to its shape in this tick. A cell that is cut through has no volume to keep;
// which ones these are is known when the body has been rebuilt.
template <class Real>
bool IsToRecover(const Surroundings& surroundings, const Coefficients<Real>& coefficients, const Body& body,
                 const State<Real>& state) {
  // One tick in lostTicks may be World::SetMotion's.
  const bool isLookDue = coefficients.aim.afterInsideOut
                             ? body.invertedTicks > 0 || body.lostTicks > 1
                             : body.lostTicks > 0 || (surroundings.tick + body.id) % kFoldLookTicks == 0;
  if (!isLookDue || std::ranges::any_of(state.torn, [](std::uint8_t torn) { return torn != 0; })) return false;
  return HasLostShape<Real>(coefficients, state.positions);
}

// Contacts with obstacles, and what they demand. duration: of the tick, s.
template <class Real>
void MeetSurfaces(const Blueprint& blueprint, double duration, State<Real>& state, PrepareScratch<Real>& scratch,
                  Member<Real>& member) {
  const Coefficients<Real>& coefficients = blueprint.Read<Real>();
  const SurfaceSearch<Real> search{.surfaces = member.surfaces,
                                   .x = state.positions,
                                   .v = state.velocities,
                                   .survey = member.survey,
                                   .range = coefficients.contact.range,
                                   .duration = static_cast<Real>(duration)};
  const double agitation{member.survey.agitation};
  FindContacts<Real>(search, state.contacts, scratch.contacts);
  member.demands = FindSurfaceDemands<Real>(blueprint, member.surfaces, state, agitation, duration);
  FindNearRods<Real>(coefficients, state.torn, search, member.rods);
  member.load.rods = member.rods;
  if (member.rods.empty()) return;
  const RodDemands rods = FindRodDemands<Real>(coefficients, member.surfaces, member.rods, state.positions,
                                               state.velocities, agitation, duration, scratch.rates);
  member.demands.rods = rods.rates;
  member.demands.landing = std::max(member.demands.landing, rods.landing);
}

}  // namespace

std::span<const StepForce> FindForcesOn(BodyId body, std::span<const StepForce> stepForces) {
  const auto begin = std::lower_bound(stepForces.begin(), stepForces.end(), body,
                                      [](const StepForce& force, BodyId wanted) { return force.body < wanted; });
  const auto end = std::upper_bound(begin, stepForces.end(), body,
                                    [](BodyId wanted, const StepForce& force) { return wanted < force.body; });
  return {begin, end};
}

template <class Real>
void PrepareMember(const Surroundings& surroundings, const Blueprint& blueprint, const StiffnessRule& stiffness,
                   Body& body, PrepareScratch<Real>& scratch, Member<Real>& member) {
  const WorldSettings& settings = surroundings.settings;
  State<Real>& state = std::get<State<Real>>(body.state);
  member.blueprint = &blueprint;
  member.state = &state;
  member.load = ApplyControl(blueprint, settings.gravity, stiffness, body, state);
  member.load.wind = settings.wind.template cast<Real>();
  AddDrives(surroundings, body.id, member);
  member.substepsForError = body.steps.Substeps();
  member.health = Health::kGood;
  member.lost = false;
  member.surfaces.clear();
  for (const Obstacle& obstacle : surroundings.obstacles) {
    member.surfaces.push_back(MakeSurface<Real>(obstacle, state.origin, blueprint.rodRadius));
  }
  ApplyLosses<Real>(blueprint, member.surfaces, settings.tickDuration, scratch.gradient, state);
  const Coefficients<Real>& coefficients = blueprint.Read<Real>();
  member.hasLostShape = IsToRecover(surroundings, coefficients, body, state);
  if (member.hasLostShape) {
    const double lost = (body.lostTicks + 1) * settings.tickDuration;
    member.load.recovery =
        FindRecoveryFactors(coefficients, surroundings.time, lost, double{member.load.stiffnessFactor});
  }
  member.load.stiffening = FindStiffening<Real>(blueprint, state.positions);
  member.load.stiffnessFactor *=
      static_cast<Real>(FindSoftening(blueprint, member.load.stiffening, member.hasLostShape, settings.tickDuration));
  member.load.pushes = member.pushes;
  member.survey = MakeSurvey<Real>(coefficients.masses, state.positions, state.velocities);
  MeetSurfaces(blueprint, settings.tickDuration, state, scratch, member);
}

template <class Real>
Box FindTickBox(const Member<Real>& member, double duration) {
  const Bounds<Real>& bounds = member.survey.bounds;
  const Vector3d& origin = member.state->origin;
  const double way = duration * double{bounds.speed};
  const bool canMeet = way <= kMostReachesPerTick * member.blueprint->reach;
  const double margin = kNearMargin + member.blueprint->edgeRadius + (canMeet ? way : 0);
  return {origin + bounds.low.template cast<double>() - Vector3d::Constant(margin),
          origin + bounds.high.template cast<double>() + Vector3d::Constant(margin)};
}

template void PrepareMember<float>(const Surroundings&, const Blueprint&, const StiffnessRule&, Body&,
                                   PrepareScratch<float>&, Member<float>&);
template void PrepareMember<double>(const Surroundings&, const Blueprint&, const StiffnessRule&, Body&,
                                    PrepareScratch<double>&, Member<double>&);
template Box FindTickBox<float>(const Member<float>&, double);
template Box FindTickBox<double>(const Member<double>&, double);

}  // namespace wobble::physics
