#include "server/physics/step/group_health.h"

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
ElasticChange FindElasticChange(const Group<Real>& group, const Part& part) {
  GroupScratch<Real>& scratch = group.Scratch();
  ElasticChange change;
  for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
    const Member<Real>& member = *group.Members()[i];
    const ElasticEnergy after =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, member.state->contacts,
                                   group.PartOf(scratch.positions, i), scratch.places);
    const ElasticEnergy before =
        ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, group.ContactsBefore(i),
                                   member.state->positions, scratch.places);
    change.before += before.stored;
    change.gain += after.stored - before.stored + after.gas - before.gas;
  }
  for (std::size_t side = 2 * part.encounterBegin; side < 2 * part.encounterEnd; ++side) {
    const Encounter<Real>& encounter = group.Encounters()[side / 2];
    const Member<Real>& vertices = *group.Members()[encounter.members[side % 2]];
    const Member<Real>& faces = *group.Members()[encounter.members[1 - side % 2]];
    const Meeting<Real> meetingAfter = group.Meet(encounter, side % 2, scratch.positions, scratch.velocities);
    const double before = ComputeBodyContactEnergy<Real>(encounter.parameters, MakeMeeting<Real>(vertices, faces),
                                                         group.BodyContactsBefore(side));
    change.before += before;
    change.gain +=
        ComputeBodyContactEnergy<Real>(encounter.parameters, meetingAfter, *encounter.sides[side % 2]) - before;
  }
  return change;
}

// The member that gained most when the group as a whole has gained energy from nowhere; null when it has not. Forces
// that are constant through the tick have a potential, everything else conserves or dissipates. Elastic energies are
// looked at only where motion has gained so much, so that a quiet tick costs two sums over its vertices.
template <class Real>
Member<Real>* FindRunaway(const Group<Real>& group, const Part& part) {
  const GroupScratch<Real>& scratch = group.Scratch();
  Member<Real>* greatest = nullptr;
  double largest = 0;
  double gained = 0;
  double has = 0;
  for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
    Member<Real>& member = *group.Members()[i];
    const Blueprint& blueprint = *member.blueprint;
    const double gain =
        ComputeMotionEnergy<Real>(blueprint, member.load, member.after, group.PartOf(scratch.positions, i)) -
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
  const ElasticChange elastic = FindElasticChange(group, part);
  return gained + elastic.gain > kRunawayShare * (has + elastic.before) ? greatest : nullptr;
}

}  // namespace

template <class Real>
bool FindBadMembers(const Group<Real>& group, const Part& part, bool checkEnergy) {
  bool anyBad = false;
  for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
    Member<Real>& member = *group.Members()[i];
    member.after = FindBulkMotion<Real>(member.blueprint->template Read<Real>().masses,
                                        group.PartOf(group.Positions(), i), group.PartOf(group.Velocities(), i));
    const Health health = FindHealth(member.after, member.insideOut);
    member.health = std::max(member.health, health);
    member.lost = health != Health::kGood;
    anyBad |= member.lost;
  }
  if (anyBad || !checkEnergy) return anyBad;
  Member<Real>* runaway = FindRunaway(group, part);
  if (runaway == nullptr) return false;
  runaway->health = std::max(runaway->health, Health::kRunaway);
  runaway->lost = true;
  return true;
}

template <class Real>
bool BlameThoseWhoBeganBad(const Group<Real>& group, const Part& part) {
  const auto beganBad = [](const Member<Real>* member) {
    const bool insideOut =
        IsInsideOut<Real>(member->blueprint->template Read<Real>(), std::span(member->state->positions));
    return FindHealth(member->survey.bulk, insideOut) != Health::kGood;
  };
  const auto members = group.MembersOf(part);
  if (std::none_of(members.begin(), members.end(), beganBad)) return false;
  group.StartAgain(part);
  for (Member<Real>* member : members) {
    member->lost = beganBad(member);
    if (!member->lost) member->health = Health::kGood;
  }
  return true;
}

template bool FindBadMembers<float>(const Group<float>&, const Part&, bool);
template bool FindBadMembers<double>(const Group<double>&, const Part&, bool);
template bool BlameThoseWhoBeganBad<float>(const Group<float>&, const Part&);
template bool BlameThoseWhoBeganBad<double>(const Group<double>&, const Part&);

}  // namespace wobble::physics
