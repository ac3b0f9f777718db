#include "server/physics/group_step.h"

#include <algorithm>
#include <cmath>

#include "server/physics/backtracking.h"
#include "server/physics/group.h"
#include "server/physics/group_health.h"
#include "server/physics/stability.h"
#include "server/physics/step_choice.h"

namespace wobble::physics {
namespace {

// Times that a tick which missed its error is stepped again: the first guess from a bad tick may fall short.
constexpr int kMaxRedos = 2;
// Times that a tick which left a body in a state that cannot be is stepped again, each in twice the substeps.
constexpr int kMaxRescues = 4;

template <class Real>
double FindRms(std::span<const Vector3<Real>> values) {
  double sum = 0;
  for (const Vector3<Real>& value : values) sum += double{value.squaredNorm()};
  return std::sqrt(sum / static_cast<double>(values.size()));
}

template <class Real>
double FindRmsOfDifference(std::span<const Vector3<Real>> a, std::span<const Vector3<Real>> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{(a[i] - b[i]).squaredNorm()};
  return std::sqrt(sum / static_cast<double>(a.size()));
}

template <class Real>
bool Backtracks(const Member<Real>& member) {
  return member.blueprint->full.contact.law == ContactLaw::kBacktracking && !member.state->contacts.empty();
}

// Bodies that touch are stepped as one. Where they ask for different methods none of those is right for all, and what
// they have in common is the default.
template <class Real>
Integrator FindIntegrator(std::span<Member<Real>* const> members) {
  const Integrator first = members[0]->blueprint->integrator;
  const auto isFirst = [first](const Member<Real>* member) { return member->blueprint->integrator == first; };
  return std::all_of(members.begin(), members.end(), isFirst) ? first : Integrator::kRungeKutta4;
}

// Energy from nowhere is looked for where there is an account of it: the other methods are there to show what they do,
// magnets have a potential that nobody adds up, and wind is a source.
template <class Real>
bool HasEnergyAccount(Integrator integrator, std::span<Member<Real>* const> members) {
  const auto adds = [](const Member<Real>* member) {
    const Coefficients<double>& body = member->blueprint->full;
    return body.contact.law != ContactLaw::kMagnetic && (!(body.drag > 0) || member->load.wind.isZero(0));
  };
  return integrator == Integrator::kRungeKutta4 && std::all_of(members.begin(), members.end(), adds);
}

template <class Real>
class Stepping {
 public:
  Stepping(Group<Real>& group, const StepRules& rules)
      : m_group(group), m_rules(rules), m_scratch(group.Scratch()), m_integrator(FindIntegrator(group.Members())) {}

  GroupOutcome Step() {
    const bool checkEnergy = HasEnergyAccount(m_integrator, m_group.Members());
    GroupOutcome outcome;
    int redos = 0;
    int rescues = 0;
    for (int next = FindSubsteps(); next > 0;) {
      if (outcome.substeps > 0) m_group.StartAgain();
      Integrate(next);
      outcome.substeps = next;
      outcome.allSubsteps += next;
      if (!FindBadMembers(m_group, checkEnergy)) {
        next = redos++ < kMaxRedos ? FindFinerSubsteps(outcome.substeps) : 0;
      } else {
        next = rescues++ < kMaxRescues && !BlameThoseWhoBeganBad(m_group) ? 2 * outcome.substeps : 0;
      }
    }
    MeasureMotion();
    m_group.Scatter();
    return outcome;
  }

 private:
  int FindSubsteps() {
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
      const int forStability = ChooseSubsteps<Real>(m_integrator, *member.blueprint, member.load, member.surfaces,
                                                    *member.state, rates, m_rules.duration);
      most = std::max({most, forStability, std::min(member.substepsForError, m_rules.maxSubsteps)});
    }
    return most;
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

  void Integrate(int substeps) {
    const double step = m_rules.duration / substeps;
    for (Member<Real>* member : m_group.Members()) member->error = 0;
    for (int substep = 0; substep < substeps; ++substep) {
      KeepBefore();
      if (m_integrator == Integrator::kRungeKutta4) {
        StepRungeKutta(step, substep > 0, m_rules.duration - substep * step);
      } else {
        StepOnce<Real>(m_integrator, static_cast<Real>(step), m_group, m_group.Positions(), m_group.Velocities(),
                       m_scratch.integrator);
      }
      UpdateContacts(static_cast<Real>(step));
    }
    for (Member<Real>* member : m_group.Members()) member->error *= kErrorShare / substeps;
  }

  // As runge_kutta.h does it, member by member, with each one's error estimated as step_choice.h says.
  void StepRungeKutta(double step, bool hasBefore, double timeLeft) {
    const auto h = static_cast<Real>(step);
    auto& stages = m_scratch.integrator.stages;
    stages.Resize(m_scratch.positions.size());
    for (std::size_t stage = 0; stage < 4; ++stage) {
      m_group.Accelerate(stages.positions, stages.velocities[stage], stages.accelerations[stage], true,
                         [&](std::size_t i) {
                           CombineStage<Real>(kClassicRungeKutta, stage, h, m_scratch.positions, m_scratch.velocities,
                                              m_scratch.begins[i], m_scratch.begins[i + 1], stages);
                         });
      if (stage == 0 && hasBefore) AddAccelerationErrors(step, timeLeft);
    }
    m_group.ForEach(m_group.CountBodies(), [&](std::size_t i) {
      AddIncrements<Real>(kClassicRungeKutta, h, m_scratch.begins[i], m_scratch.begins[i + 1], stages,
                          m_scratch.positions, m_scratch.velocities);
      m_group.Members()[i]->error +=
          step / 6 *
          FindRmsOfDifference<Real>(m_group.PartOf(stages.velocities[3], i), m_group.PartOf(m_scratch.velocities, i));
    });
  }

  // a₄ of the substep before still stands in its place when the first stage of the next one is known.
  void AddAccelerationErrors(double step, double timeLeft) {
    const auto& accelerations = m_scratch.integrator.stages.accelerations;
    m_group.ForEach(m_group.CountBodies(), [&](std::size_t i) {
      const double jump =
          FindRmsOfDifference<Real>(m_group.PartOf(accelerations[3], i), m_group.PartOf(accelerations[0], i));
      m_group.Members()[i]->error += step / 6 * jump * timeLeft;
    });
  }

  void KeepBefore() {
    const auto members = m_group.Members();
    if (std::none_of(members.begin(), members.end(), [](const auto* member) { return Backtracks(*member); })) return;
    m_scratch.positionsBefore = m_scratch.positions;
    m_scratch.velocitiesBefore = m_scratch.velocities;
  }

  void UpdateContacts(Real h) {
    m_group.ForEach(m_group.CountBodies(), [&](std::size_t i) {
      const Member<Real>& member = *m_group.Members()[i];
      const Coefficients<Real>& body = member.blueprint->template Read<Real>();
      const auto x = m_group.PartOf(m_group.Positions(), i);
      if (Backtracks(member)) {
        PutBack<Real>(body, h, member.surfaces, m_group.PartOf(m_scratch.positionsBefore, i),
                      m_group.PartOf(m_scratch.velocitiesBefore, i), member.state->contacts, x,
                      m_group.PartOf(m_group.Velocities(), i));
      }
      UpdateAnchors<Real>(body.contact, member.surfaces, member.state->contacts, x);
    });
    const auto encounters = m_group.Encounters();
    m_group.ForEach(2 * encounters.size(), [&](std::size_t i) {
      const Encounter<Real>& encounter = encounters[i / 2];
      const Meeting<Real> meeting = m_group.Meet(encounter, i % 2, m_scratch.positions, m_scratch.velocities);
      UpdateBodyContacts<Real>(encounter.parameters, meeting, h, *encounter.sides[i % 2]);
    });
  }

  // More substeps for a tick that missed its error by far; 0 when none did, or none are to be had.
  int FindFinerSubsteps(int substeps) const {
    int wanted = 0;
    for (const Member<Real>* member : m_group.Members()) {
      if (member->error <= kRedoFactor * m_rules.allowedError) continue;
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
};

}  // namespace

template <class Real>
Meeting<Real> MakeMeeting(const Member<Real>& ofVertices, std::span<const Vector3<Real>> x,
                          std::span<const Vector3<Real>> v, const Member<Real>& ofFaces,
                          std::span<const Vector3<Real>> shellX, std::span<const Vector3<Real>> shellV) {
  const Vector3d shift = ofVertices.state->origin - ofFaces.state->origin;
  return {x,
          v,
          ofVertices.blueprint->template Read<Real>().contactShares,
          {ofFaces.blueprint->template Read<Real>().faces, &ofFaces.blueprint->topology, shellX},
          shellV,
          shift.cast<Real>()};
}

template <class Real>
GroupOutcome StepGroup(std::span<Member<Real>* const> members, std::span<const Encounter<Real>> encounters,
                       const StepRules& rules, Threads* threads, GroupScratch<Real>& scratch) {
  Group<Real> group(members, encounters, threads, scratch);
  return Stepping<Real>(group, rules).Step();
}

#define WOBBLE_INSTANTIATE(Real)                                                                            \
  template Meeting<Real> MakeMeeting<Real>(const Member<Real>&, std::span<const Vector3<Real>>,             \
                                           std::span<const Vector3<Real>>, const Member<Real>&,             \
                                           std::span<const Vector3<Real>>, std::span<const Vector3<Real>>); \
  template GroupOutcome StepGroup<Real>(std::span<Member<Real>* const>, std::span<const Encounter<Real>>,   \
                                        const StepRules&, Threads*, GroupScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
