#include "server/physics/step/group_step.h"

#include <algorithm>

#include "server/physics/lanes/kernels.h"
#include "server/physics/step/group_tick.h"

namespace wobble::physics {
namespace {

template <class Real>
class Stepping {
 public:
  Stepping(Group<Real>& group, const StepRules& rules)
      : m_group(group),
        m_rules(rules),
        m_scratch(group.Scratch()),
        m_integrator(FindIntegrator(group.Members())),
        m_tick(group.Members(), rules) {}

  GroupOutcome Step(int substeps) {
    const Part whole = m_group.Whole();
    m_group.Gather(whole);
    for (; substeps > 0; substeps = m_tick.Judge(m_group, whole, substeps)) Integrate(substeps);
    return m_tick.Finish(m_group, whole);
  }

 private:
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
    for (std::size_t i = 0; i < m_group.CountBodies(); ++i) {
      Member<Real>& member = *m_group.Members()[i];
      member.error *= kErrorShare / substeps;
      member.insideOut =
          IsInsideOut<Real>(member.blueprint->template Read<Real>(), m_group.PartOf(m_scratch.positions, i));
    }
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
    m_group.UpdateAllBodyContacts(m_scratch.positions, m_scratch.velocities, h);
  }

  Group<Real>& m_group;
  const StepRules& m_rules;
  GroupScratch<Real>& m_scratch;
  Integrator m_integrator;
  GroupTick<Real> m_tick;
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
                       int substeps, const StepRules& rules, Threads* threads, GroupScratch<Real>& scratch) {
  Group<Real> group(members, encounters, threads, FindSweepKernels<Real>(kWidestPack).back(), scratch);
  return Stepping<Real>(group, rules).Step(substeps);
}

#define WOBBLE_INSTANTIATE(Real)                                                                               \
  template Meeting<Real> MakeMeeting<Real>(const Member<Real>&, std::span<const Vector3<Real>>,                \
                                           std::span<const Vector3<Real>>, const Member<Real>&,                \
                                           std::span<const Vector3<Real>>, std::span<const Vector3<Real>>);    \
  template GroupOutcome StepGroup<Real>(std::span<Member<Real>* const>, std::span<const Encounter<Real>>, int, \
                                        const StepRules&, Threads*, GroupScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
