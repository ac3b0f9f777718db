// The tries of one tick of bodies that hang together by contacts: whether what a try made of them will do.
//
// Whoever integrates does so between one Judge and the next: island_step.cpp in plain code, batch_step.cpp in lanes.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/methods/step_choice.h"
#include "server/physics/step/body_system.h"
#include "server/physics/step/island_health.h"
#include "server/physics/step/sleep.h"
#include "server/physics/step/substeps.h"

namespace wobble::physics {

// Times that a tick which missed its error is stepped again: the first guess from a bad tick may fall short.
inline constexpr int kMaxRedos = 2;
// Times that a tick which left a body in a state that cannot be is stepped again, each in twice the substeps.
inline constexpr int kMaxRescues = 4;

template <class Real>
[[nodiscard]] double FindRmsOfDifference(std::span<const Vector3<Real>> a, std::span<const Vector3<Real>> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{(a[i] - b[i]).squaredNorm()};
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// Energy from nowhere is looked for where there is an account of it: the other methods are there to show what they do,
// magnets have a potential that nobody adds up, and wind is a source.
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

  // Of a try in so many substeps, which noted each member's error: those of the next try, for which the members stand
  // where the tick began, or 0 when there is to be none. part: the members in that system.
  [[nodiscard]] int Judge(const BodySystem<Real>& system, const Island& island, int substeps) {
    m_outcome.substeps = substeps;
    m_outcome.allSubsteps += substeps;
    const int next = FindNext(system, island, substeps);
    if (next > 0) system.StartAgain(island);
    return next;
  }

  // After the last try.
  IslandOutcome Finish(const BodySystem<Real>& system, const Island& island) const {
    for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
      Member<Real>& member = *system.Members()[i];
      member.speed = std::sqrt(2 * member.after.kineticEnergy / member.blueprint->totalMass);
      member.acceleration =
          member.speed < kQuietSpeed
              ? FindRmsOfDifference<Real>(system.SliceOf(system.Velocities(), i), member.state->velocities) /
                    m_rules.duration
              : std::numeric_limits<double>::infinity();
    }
    system.Scatter(island);
    return m_outcome;
  }

 private:
  // What has become of the bodies in a try that is not to count says nothing of them.
  int FindNext(const BodySystem<Real>& system, const Island& island, int substeps) {
    const int finer = m_redos++ < kMaxRedos ? FindFinerSubsteps(substeps) : 0;
    if (finer > 0 || !FindBadMembers(system, island, m_checkEnergy)) return finer;
    return m_rescues++ < kMaxRescues && !BlameThoseWhoBeganBad(system, island) ? 2 * substeps : 0;
  }

  // More substeps for a tick that missed its error by far; 0 when none did, or none are to be had.
  int FindFinerSubsteps(int substeps) const {
    int wanted = 0;
    for (const Member<Real>* member : m_members) {
      if (!(member->error > kRedoFactor * m_rules.allowedError)) continue;  // nor what is no number: a case for health
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
