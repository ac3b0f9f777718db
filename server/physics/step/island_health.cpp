#include "server/physics/step/island_health.h"

#include <algorithm>

namespace wobble::physics {
namespace {

// Acceleration that the energy check takes for the least in its M g R, m/s²: without gravity a body at rest would have
// no energy to compare with.
constexpr double kLeastGravity = 1;

struct ElasticChange {
  double before = 0;  // what springs and contacts held, J
  double gain = 0;    // of that and of the gas, J
};

template <class Real>
ElasticChange FindElasticChange(const Island<Real>& island, const Part& part) {
  IslandScratch<Real>& scratch = island.Scratch();
  ElasticChange change;
  for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
    const Member<Real>& member = *island.Members()[i];
    const ElasticEnergy after =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, member.state->contacts,
                                   island.PartOf(scratch.positions, i), scratch.places);
    const ElasticEnergy before =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, island.ContactsBefore(i),
                                   member.state->positions, scratch.places);
    change.before += before.stored;
    change.gain += after.stored - before.stored + after.gas - before.gas;
  }
  for (std::size_t side = 2 * part.contactPairBegin; side < 2 * part.contactPairEnd; ++side) {
    const ContactPair<Real>& contactPair = island.ContactPairs()[side / 2];
    const Member<Real>& vertices = *island.Members()[contactPair.members[side % 2]];
    const Member<Real>& faces = *island.Members()[contactPair.members[1 - side % 2]];
    const Meeting<Real> meetingAfter = island.Meet(contactPair, side % 2, scratch.positions, scratch.velocities);
    const double before = ComputeBodyContactEnergy<Real>(contactPair.parameters, MakeMeeting<Real>(vertices, faces),
                                                         island.BodyContactsBefore(side));
    change.before += before;
    change.gain +=
        ComputeBodyContactEnergy<Real>(contactPair.parameters, meetingAfter, *contactPair.sides[side % 2]) - before;
  }
  return change;
}

// The member that gained most when the island as a whole has gained energy from nowhere; null when it has not. Forces
// that are constant through the tick have a potential, everything else conserves or dissipates. Elastic energies are
// looked at only where motion has gained so much, so that a quiet tick costs two sums over its vertices.
template <class Real>
Member<Real>* FindRunaway(const Island<Real>& island, const Part& part) {
  const IslandScratch<Real>& scratch = island.Scratch();
  Member<Real>* greatest = nullptr;
  double largest = 0;
  double gained = 0;
  double has = 0;
  for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
    Member<Real>& member = *island.Members()[i];
    const Blueprint& blueprint = *member.blueprint;
    const double gain =
        ComputeMotionEnergy<Real>(blueprint, member.load, member.after, island.PartOf(scratch.positions, i)) -
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
  const ElasticChange elastic = FindElasticChange(island, part);
  return gained + elastic.gain > kRunawayShare * (has + elastic.before) ? greatest : nullptr;
}

}  // namespace

template <class Real>
bool FindBadMembers(const Island<Real>& island, const Part& part, bool checkEnergy) {
  bool anyBad = false;
  for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
    Member<Real>& member = *island.Members()[i];
    member.after = FindBulkMotion<Real>(member.blueprint->template Read<Real>().masses,
                                        island.PartOf(island.Positions(), i), island.PartOf(island.Velocities(), i));
    const Health health = FindHealth(member.after, member.insideOut);
    member.health = std::max(member.health, health);
    member.lost = health != Health::kGood;
    anyBad |= member.lost;
  }
  if (anyBad || !checkEnergy) return anyBad;
  Member<Real>* runaway = FindRunaway(island, part);
  if (runaway == nullptr) return false;
  runaway->health = std::max(runaway->health, Health::kRunaway);
  runaway->lost = true;
  return true;
}

template <class Real>
bool BlameThoseWhoBeganBad(const Island<Real>& island, const Part& part) {
  const auto beganBad = [](const Member<Real>* member) {
    const bool insideOut =
        IsInsideOut<Real>(member->blueprint->template Read<Real>(), std::span(member->state->positions));
    return FindHealth(member->survey.bulk, insideOut) != Health::kGood;
  };
  const auto members = island.MembersOf(part);
  if (std::none_of(members.begin(), members.end(), beganBad)) return false;
  island.StartAgain(part);
  for (Member<Real>* member : members) {
    member->lost = beganBad(member);
    if (!member->lost) member->health = Health::kGood;
  }
  return true;
}

template bool FindBadMembers<float>(const Island<float>&, const Part&, bool);
template bool FindBadMembers<double>(const Island<double>&, const Part&, bool);
template bool BlameThoseWhoBeganBad<float>(const Island<float>&, const Part&);
template bool BlameThoseWhoBeganBad<double>(const Island<double>&, const Part&);

}  // namespace wobble::physics
