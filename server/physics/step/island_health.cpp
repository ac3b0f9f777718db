// Energy is judged for the island as a whole, since contacts pass it from body to body; the body that gained most is
// blamed.
#include "server/physics/step/island_health.h"

#include <algorithm>

namespace wobble::physics {
namespace {

// Least acceleration g in the scale M g R that the energy check compares a gain with, m/s²: without gravity a body at
// rest would have no energy to compare with.
constexpr double kLeastGravity = 1;

struct ElasticChange {
  double before = 0;  // energy of springs and contacts at the tick's begin, J
  double gain = 0;    // of springs, contacts and gas in the tick, J
};

template <class Real>
ElasticChange FindElasticChange(const BodySystem<Real>& system, const Island& island) {
  SystemScratch<Real>& scratch = system.Scratch();
  ElasticChange change;
  for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
    const Member<Real>& member = *system.Members()[i];
    const ElasticEnergy after =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, member.state->contacts,
                                   system.SliceOf(scratch.positions, i), scratch.places);
    const ElasticEnergy before =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, system.ContactsBefore(i),
                                   member.state->positions, scratch.places);
    change.before += before.stored;
    change.gain += after.stored - before.stored + after.gas - before.gas;
  }
  for (std::size_t side = 2 * island.contactPairBegin; side < 2 * island.contactPairEnd; ++side) {
    const ContactPair<Real>& contactPair = system.ContactPairs()[side / 2];
    const Member<Real>& vertices = *system.Members()[contactPair.members[side % 2]];
    const Member<Real>& faces = *system.Members()[contactPair.members[1 - side % 2]];
    const Meeting<Real> meetingAfter = system.Meet(contactPair, side % 2, scratch.positions, scratch.velocities);
    const double before = ComputeBodyContactEnergy<Real>(
        contactPair.parameters, MakeMeeting<Real>(vertices, faces, contactPair.gap), system.BodyContactsBefore(side));
    change.before += before;
    change.gain +=
        ComputeBodyContactEnergy<Real>(contactPair.parameters, meetingAfter, *contactPair.sides[side % 2]) - before;
  }
  for (std::size_t pair = island.contactPairBegin; pair < island.contactPairEnd; ++pair) {
    const ContactPair<Real>& contactPair = system.ContactPairs()[pair];
    const Member<Real>& first = *system.Members()[contactPair.members[0]];
    const Member<Real>& second = *system.Members()[contactPair.members[1]];
    if (contactPair.core != nullptr && contactPair.core->MayAct()) {
      const double before = FindCoreEnergy(*contactPair.core, FindApart(first, second));
      change.before += before;
      change.gain += FindCoreEnergy(*contactPair.core, FindApartAfter(first, second)) - before;
    }
    const std::span<const EdgeContact<Real>> contactsBefore = system.EdgeContactsBefore(pair);
    if (contactsBefore.empty()) continue;
    const double before = ComputeEdgeContactEnergy<Real>(
        contactPair.parameters, MakeEdgeMeeting<Real>(first, second, contactPair.gap), contactsBefore);
    const double after = ComputeEdgeContactEnergy<Real>(
        contactPair.parameters, system.MeetEdges(contactPair, scratch.positions, scratch.velocities),
        *contactPair.edges);
    change.before += before;
    change.gain += after - before;
  }
  return change;
}

// The member that gained most when the island as a whole has gained energy without a source; null when it has not.
// Forces that are constant through the tick have a potential, all others conserve or dissipate energy. Elastic energies
// are computed only when the energy of motion alone has gained too much, so that a quiet tick costs two sums over its
// vertices.
template <class Real>
Member<Real>* FindRunaway(const BodySystem<Real>& system, const Island& island) {
  const SystemScratch<Real>& scratch = system.Scratch();
  Member<Real>* greatest = nullptr;
  double largest = 0;
  double gained = 0;
  double has = 0;
  for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
    Member<Real>& member = *system.Members()[i];
    const Blueprint& blueprint = *member.blueprint;
    const double gain =
        ComputeMotionEnergy<Real>(blueprint, member.load, member.after, system.SliceOf(scratch.positions, i)) -
        ComputeMotionEnergy<Real>(blueprint, member.load, member.survey.bulk, member.state->positions);
    gained += gain;
    if (gain > largest) {
      largest = gain;
      greatest = &member;
    }
    const double gravity = std::max(kLeastGravity, double{member.load.acceleration.norm()});
    has += blueprint.totalMass * gravity * blueprint.reach + member.survey.bulk.kineticEnergy;
  }
  if (greatest == nullptr || gained <= kRunawayShare * has) return nullptr;
  const ElasticChange elastic = FindElasticChange(system, island);
  return gained + elastic.gain > kRunawayShare * (has + elastic.before) ? greatest : nullptr;
}

}  // namespace

template <class Real>
bool FindBadMembers(const BodySystem<Real>& system, const Island& island, bool checkEnergy) {
  bool anyBad = false;
  for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
    Member<Real>& member = *system.Members()[i];
    member.after = FindBulkMotion<Real>(member.blueprint->template Read<Real>().masses,
                                        system.SliceOf(system.Positions(), i), system.SliceOf(system.Velocities(), i));
    const Health health = FindHealth(member.after);
    member.health = std::max(member.health, health);
    member.lost = health != Health::kGood;
    anyBad |= member.lost;
  }
  if (anyBad || !checkEnergy) return anyBad;
  Member<Real>* runaway = FindRunaway(system, island);
  if (runaway == nullptr) return false;
  runaway->health = std::max(runaway->health, Health::kRunaway);
  runaway->lost = true;
  return true;
}

template <class Real>
bool BlameMembersBadFromStart(const BodySystem<Real>& system, const Island& island) {
  const auto beganBad = [](const Member<Real>* member) { return FindHealth(member->survey.bulk) != Health::kGood; };
  const auto members = system.MembersOf(island);
  if (std::none_of(members.begin(), members.end(), beganBad)) return false;
  system.StartAgain(island);
  for (Member<Real>* member : members) {
    member->lost = beganBad(member);
    if (!member->lost) member->health = Health::kGood;
  }
  return true;
}

template bool FindBadMembers<float>(const BodySystem<float>&, const Island&, bool);
template bool FindBadMembers<double>(const BodySystem<double>&, const Island&, bool);
template bool BlameMembersBadFromStart<float>(const BodySystem<float>&, const Island&);
template bool BlameMembersBadFromStart<double>(const BodySystem<double>&, const Island&);

}  // namespace wobble::physics
