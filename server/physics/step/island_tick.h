// The tries of one tick of an island: judges each try and says with how many substeps the next one is made.
//
// Integration happens outside, between one Judge and the next: island_step.cpp does it in plain code, batch_step.cpp in
// lanes. After each try the first line that holds decides:
//   - error far above what is allowed, at most kMaxRedos times: again, in the substeps that the error asks for
//   - every member in a possible state: finished
//   - a member that began the tick in an impossible state: finished, it is lost and the others are put back
//   - at most kMaxRescues times: again, in twice the substeps
//   - finished, the bad members are lost
#pragma once

#include <algorithm>
#include <cmath>

#include "server/physics/methods/substeps_for_error.h"
#include "server/physics/step/body_system.h"
#include "server/physics/step/first_substeps.h"
#include "server/physics/step/island_health.h"

namespace wobble::physics {

// Most tries again for the error. More than one, since the guess from a bad tick may fall short.
inline constexpr int kMaxRedos = 2;
// Most tries again for a member in an impossible state, each in twice the substeps of the one before.
inline constexpr int kMaxRescues = 4;

// Root of the mean square distance between a and b, which are equally long.
template <class Real>
[[nodiscard]] double FindRmsOfDifference(std::span<const Vector3<Real>> a, std::span<const Vector3<Real>> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{(a[i] - b[i]).squaredNorm()};
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// Whether every energy of these members is accounted for, so that a gain means a fault. Not so with other methods than
// RK4, which are there to show what they do, with magnetic contacts, whose potential is not computed, and with drag in
// wind, which is a source of energy.
template <class Real>
[[nodiscard]] bool HasEnergyAccount(std::span<Member<Real>* const> members) {
  const auto adds = [](const Member<Real>* member) {
    const Coefficients<double>& body = member->blueprint->full;
    return body.contact.law != ContactLaw::kMagnetic && (!(body.drag > 0) || member->load.wind.isZero(0));
  };
  return FindIntegrator(members) == Integrator::kRungeKutta4 && std::all_of(members.begin(), members.end(), adds);
}

template <class Real>
class IslandTick {
 public:
  IslandTick(std::span<Member<Real>* const> members, const StepRules& rules)
      : m_members(members), m_rules(rules), m_checkEnergy(HasEnergyAccount(members)) {}

  // Judges a try in so many substeps that has left its result in the system and each member's error. Returns the
  // substeps of the next try, for which the island has been put back to the tick's begin; 0: the tick is finished.
  [[nodiscard]] int Judge(const BodySystem<Real>& system, const Island& island, int substeps) {
    m_outcome.substeps = substeps;
    m_outcome.allSubsteps += substeps;
    const int next = FindNext(system, island, substeps);
    if (next > 0) system.StartAgain(island);
    return next;
  }

  // Call once after the last try: writes the speed of the members and copies the result to their states.
  IslandOutcome Finish(const BodySystem<Real>& system, const Island& island) const {
    for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
      Member<Real>& member = *system.Members()[i];
      member.speed = std::sqrt(2 * member.after.kineticEnergy / member.blueprint->totalMass);
    }
    system.Scatter(island);
    return m_outcome;
  }

 private:
  // The error comes first: a try that misses it is thrown away, so the health it ended with says nothing.
  int FindNext(const BodySystem<Real>& system, const Island& island, int substeps) {
    const int finer = m_redos++ < kMaxRedos ? FindFinerSubsteps(substeps) : 0;
    if (finer > 0 || !FindBadMembers(system, island, m_checkEnergy)) return finer;
    return m_rescues++ < kMaxRescues && !BlameMembersBadFromStart(system, island) ? 2 * substeps : 0;
  }

  // The substeps for a tick that missed its error by far; 0 when none did or there are no more to be had.
  int FindFinerSubsteps(int substeps) const {
    int wanted = 0;
    for (const Member<Real>* member : m_members) {
      if (!(member->error > kRedoFactor * m_rules.allowedError)) continue;  // false for NaN: left to health
      wanted = std::max(wanted, FindSubstepsForError(member->error, substeps, m_rules.allowedError));
    }
    wanted = std::min(wanted, m_rules.maxSubsteps);
    return wanted > substeps ? wanted : 0;
  }

  std::span<Member<Real>* const> m_members;
  const StepRules& m_rules;
  bool m_checkEnergy;
  IslandOutcome m_outcome;
  int m_redos = 0;
  int m_rescues = 0;
};

}  // namespace wobble::physics
