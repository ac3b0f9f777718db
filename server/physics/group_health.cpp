#include "server/physics/group_health.h"

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
ElasticChange FindElasticChange(const Group<Real>& group) {
  GroupScratch<Real>& scratch = group.Scratch();
  ElasticChange change;
  auto contactsBefore = std::span<const Contact<Real>>(scratch.contacts);
  for (std::size_t i = 0; i < group.CountBodies(); ++i) {
    const Member<Real>& member = *group.Members()[i];
    const std::size_t count = member.state->contacts.size();
    const ElasticEnergy after =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, member.state->contacts,
                                   group.PartOf(scratch.positions, i), scratch.places);
    const ElasticEnergy before =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, contactsBefore.first(count),
                                   member.state->positions, scratch.places);
    change.before += before.stored;
    change.gain += after.stored - before.stored + after.gas - before.gas;
    contactsBefore = contactsBefore.subspan(count);
  }
  auto bodyContactsBefore = std::span<const BodyContact<Real>>(scratch.bodyContacts);
  for (const Encounter<Real>& encounter : group.Encounters()) {
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t count = encounter.sides[side]->size();
      const Member<Real>& vertices = *group.Members()[encounter.members[side]];
      const Member<Real>& faces = *group.Members()[encounter.members[1 - side]];
      const Meeting<Real> meetingBefore =
          MakeMeeting<Real>(vertices, vertices.state->positions, vertices.state->velocities, faces,
                            faces.state->positions, faces.state->velocities);
      const Meeting<Real> meetingAfter = group.Meet(encounter, side, scratch.positions, scratch.velocities);
      const double before =
          ComputeBodyContactEnergy<Real>(encounter.parameters, meetingBefore, bodyContactsBefore.first(count));
      change.before += before;
      change.gain +=
          ComputeBodyContactEnergy<Real>(encounter.parameters, meetingAfter, *encounter.sides[side]) - before;
      bodyContactsBefore = bodyContactsBefore.subspan(count);
    }
  }
  return change;
}

// The member that gained most when the group as a whole has gained energy from nowhere; null when it has not. Forces
// that are constant through the tick have a potential, everything else conserves or dissipates. Elastic energies are
// looked at only where motion has gained so much, so that a quiet tick costs two sums over its vertices.
template <class Real>
Member<Real>* FindRunaway(const Group<Real>& group) {
  const GroupScratch<Real>& scratch = group.Scratch();
  Member<Real>* greatest = nullptr;
  double largest = 0;
  double gained = 0;
  double has = 0;
  for (std::size_t i = 0; i < group.CountBodies(); ++i) {
    Member<Real>& member = *group.Members()[i];
    const Blueprint& blueprint = *member.blueprint;
    const State<Real>& before = *member.state;
    const double gain = ComputeMotionEnergy<Real>(blueprint, member.load, group.PartOf(scratch.positions, i),
                                                  group.PartOf(scratch.velocities, i)) -
                        ComputeMotionEnergy<Real>(blueprint, member.load, before.positions, before.velocities);
    gained += gain;
    if (gain > largest) {
      largest = gain;
      greatest = &member;
    }
    const double gravity = std::max(kLeastGravity, double{member.load.acceleration.norm()});
    has += blueprint.totalMass * gravity * blueprint.reach +
           ComputeMotionEnergy<Real>(blueprint, {}, before.positions, before.velocities);
  }
  if (greatest == nullptr || gained <= kRunawayShare * has) return nullptr;
  const ElasticChange elastic = FindElasticChange(group);
  return gained + elastic.gain > kRunawayShare * (has + elastic.before) ? greatest : nullptr;
}

}  // namespace

template <class Real>
bool FindBadMembers(const Group<Real>& group, bool checkEnergy) {
  bool anyBad = false;
  for (std::size_t i = 0; i < group.CountBodies(); ++i) {
    Member<Real>& member = *group.Members()[i];
    const Health health =
        FindHealth<Real>(member.blueprint->template Read<Real>(), group.PartOf(group.Scratch().positions, i),
                         group.PartOf(group.Scratch().velocities, i));
    member.health = std::max(member.health, health);
    member.lost = health != Health::kGood;
    anyBad |= member.lost;
  }
  if (anyBad || !checkEnergy) return anyBad;
  Member<Real>* runaway = FindRunaway(group);
  if (runaway == nullptr) return false;
  runaway->health = std::max(runaway->health, Health::kRunaway);
  runaway->lost = true;
  return true;
}

template <class Real>
bool BlameThoseWhoBeganBad(Group<Real>& group) {
  const auto beganBad = [](const Member<Real>* member) {
    const Coefficients<Real>& body = member->blueprint->template Read<Real>();
    return FindHealth<Real>(body, member->state->positions, member->state->velocities) != Health::kGood;
  };
  if (std::none_of(group.Members().begin(), group.Members().end(), beganBad)) return false;
  group.StartAgain();
  for (Member<Real>* member : group.Members()) {
    member->lost = beganBad(member);
    if (!member->lost) member->health = Health::kGood;
  }
  return true;
}

template bool FindBadMembers<float>(const Group<float>&, bool);
template bool FindBadMembers<double>(const Group<double>&, bool);
template bool BlameThoseWhoBeganBad<float>(Group<float>&);
template bool BlameThoseWhoBeganBad<double>(Group<double>&);

}  // namespace wobble::physics
