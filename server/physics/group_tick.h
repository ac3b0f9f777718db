// The tries of one tick of a group: how many substeps to begin with, and whether what they made of it will do.
//
// Whoever integrates does so between FindSubsteps and Judge: group_step.cpp the members as one system, pack_step.cpp
// bodies that touch nobody in lanes.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/physics/group.h"
#include "server/physics/group_health.h"
#include "server/physics/stability.h"
#include "server/physics/step_choice.h"

namespace wobble::physics {

// Times that a tick which missed its error is stepped again: the first guess from a bad tick may fall short.
inline constexpr int kMaxRedos = 2;
// Times that a tick which left a body in a state that cannot be is stepped again, each in twice the substeps.
inline constexpr int kMaxRescues = 4;

template <class Real>
[[nodiscard]] double FindRms(std::span<const Vector3<Real>> values) {
  double sum = 0;
  for (const Vector3<Real>& value : values) sum += double{value.squaredNorm()};
  return std::sqrt(sum / static_cast<double>(values.size()));
}

template <class Real>
[[nodiscard]] double FindRmsOfDifference(std::span<const Vector3<Real>> a, std::span<const Vector3<Real>> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{(a[i] - b[i]).squaredNorm()};
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// Bodies that touch are stepped as one. Where they ask for different methods none of those is right for all, and what
// they have in common is the default.
template <class Real>
[[nodiscard]] Integrator FindIntegrator(std::span<Member<Real>* const> members) {
  const Integrator first = members[0]->blueprint->integrator;
  const auto isFirst = [first](const Member<Real>* member) { return member->blueprint->integrator == first; };
  return std::all_of(members.begin(), members.end(), isFirst) ? first : Integrator::kRungeKutta4;
}

// Energy from nowhere is looked for where there is an account of it: the other methods are there to show what they do,
// magnets have a potential that nobody adds up, and wind is a source.
template <class Real>
[[nodiscard]] bool HasEnergyAccount(Integrator integrator, std::span<Member<Real>* const> members) {
  const auto adds = [](const Member<Real>* member) {
    const Coefficients<double>& body = member->blueprint->full;
    return body.contact.law != ContactLaw::kMagnetic && (!(body.drag > 0) || member->load.wind.isZero(0));
  };
  return integrator == Integrator::kRungeKutta4 && std::all_of(members.begin(), members.end(), adds);
}

// For the first try of a member's tick: what stability and what the error of its last ticks ask. fromBodies: what
// contacts with other members add.
template <class Real>
[[nodiscard]] int FindSubstepsOf(const Member<Real>& member, Integrator integrator, const ContactRates& fromBodies,
                                 const StepRules& rules) {
  const int forStability = ChooseSubsteps<Real>(integrator, *member.blueprint, member.load, member.surfaces,
                                                *member.state, fromBodies, rules.duration);
  return std::max({1, forStability, std::min(member.substepsForError, rules.maxSubsteps)});
}

template <class Real>
class GroupTick {
 public:
  GroupTick(Group<Real>& group, const StepRules& rules)
      : m_group(group),
        m_rules(rules),
        m_scratch(group.Scratch()),
        m_integrator(FindIntegrator(group.Members())),
        m_checkEnergy(HasEnergyAccount(m_integrator, group.Members())) {}

  [[nodiscard]] Integrator Method() const { return m_integrator; }

  // For the first try.
  [[nodiscard]] int FindSubsteps() {
    m_scratch.loads.assign(m_scratch.positions.size(), {});
    int most = AddAllContactLoads();
    for (std::size_t i = 0; i < m_group.CountBodies(); ++i) {
      const Member<Real>& member = *m_group.Members()[i];
      ContactRates rates;
      for (std::size_t vertex = 0; const VertexLoad& load : m_group.PartOf(m_scratch.loads, i)) {
        const double mass = member.blueprint->full.masses[vertex++];
        rates.squareFrequency = std::max(rates.squareFrequency, load.stiffness / mass);
        rates.dampingRate = std::max(rates.dampingRate, load.damping / mass);
      }
      most = std::max(most, FindSubstepsOf<Real>(member, m_integrator, rates, m_rules));
    }
    return most;
  }

  // Of a try in so many substeps, which noted each member's error: those of the next try, for which the group stands
  // where the tick began, or 0 when there is to be none.
  [[nodiscard]] int Judge(int substeps) {
    m_outcome.substeps = substeps;
    m_outcome.allSubsteps += substeps;
    const int next = FindNext(substeps);
    if (next > 0) m_group.StartAgain();
    return next;
  }

  // After the last try.
  GroupOutcome Finish() {
    MeasureMotion();
    m_group.Scatter();
    return m_outcome;
  }

 private:
  // What has become of the bodies in a try that is not to count says nothing of them.
  int FindNext(int substeps) {
    const int finer = m_redos++ < kMaxRedos ? FindFinerSubsteps(substeps) : 0;
    if (finer > 0 || !FindBadMembers(m_group, m_checkEnergy)) return finer;
    return m_rescues++ < kMaxRescues && !BlameThoseWhoBeganBad(m_group) ? 2 * substeps : 0;
  }

  int AddAllContactLoads() {
    int most = 1;
    const std::span<VertexLoad> loads(m_scratch.loads);
    for (const Encounter<Real>& encounter : m_group.Encounters()) {
      for (std::size_t side = 0; side < 2; ++side) {
        const Meeting<Real> meeting = m_group.Meet(encounter, side, m_scratch.positions, m_scratch.velocities);
        most = std::max(most, AddContactLoads<Real>(encounter.parameters, meeting, *encounter.sides[side],
                                                    m_rules.duration, m_group.PartOf(loads, encounter.members[side]),
                                                    m_group.PartOf(loads, encounter.members[1 - side])));
      }
    }
    return most;
  }

  // More substeps for a tick that missed its error by far; 0 when none did, or none are to be had.
  int FindFinerSubsteps(int substeps) const {
    int wanted = 0;
    for (const Member<Real>* member : m_group.Members()) {
      if (!(member->error > kRedoFactor * m_rules.allowedError)) continue;  // nor what is no number: a case for health
      wanted = std::max(wanted, FindSubstepsForError(member->error, substeps, m_rules.allowedError));
    }
    wanted = std::min(wanted, m_rules.maxSubsteps);
    return wanted > substeps ? wanted : 0;
  }

  void MeasureMotion() const {
    for (std::size_t i = 0; i < m_group.CountBodies(); ++i) {
      Member<Real>& member = *m_group.Members()[i];
      const auto velocities = m_group.PartOf(m_scratch.velocities, i);
      member.speed = FindRms<Real>(velocities);
      member.acceleration = FindRmsOfDifference<Real>(velocities, member.state->velocities) / m_rules.duration;
    }
  }

  Group<Real>& m_group;
  const StepRules& m_rules;
  GroupScratch<Real>& m_scratch;
  Integrator m_integrator;
  bool m_checkEnergy;
  GroupOutcome m_outcome;
  int m_redos = 0;
  int m_rescues = 0;
};

}  // namespace wobble::physics
