// All members go through each stage together: first the forces of every body by itself, then the contacts between them,
// then the sum and division by mass (BodySystem::Accelerate). RK4 is written out here member by member rather than
// taken from methods/runge_kutta.h, so that threads share the members out and each member's error is estimated from its
// own stages.
#include "server/physics/step/island_step.h"

#include <algorithm>

#include "server/physics/kernels/kernels.h"
#include "server/physics/step/island_tick.h"

namespace wobble::physics {
namespace {

template <class Real>
class PlainStepping {
 public:
  PlainStepping(BodySystem<Real>& system, const StepRules& rules)
      : m_system(system),
        m_rules(rules),
        m_scratch(system.Scratch()),
        m_integrator(FindIntegrator(system.Members())),
        m_tick(system.Members(), rules) {}

  IslandOutcome Step(int substeps) {
    const Island whole = m_system.All();
    m_system.Gather(whole);
    for (; substeps > 0; substeps = m_tick.Judge(m_system, whole, substeps)) Integrate(substeps);
    return m_tick.Finish(m_system, whole);
  }

 private:
  void Integrate(int substeps) {
    const double step = m_rules.duration / substeps;
    for (Member<Real>* member : m_system.Members()) member->error = 0;
    for (int substep = 0; substep < substeps; ++substep) {
      KeepBefore();
      if (m_integrator == Integrator::kRungeKutta4) {
        StepRungeKutta(step, substep > 0, m_rules.duration - substep * step);
      } else {
        StepOnce<Real>(m_integrator, static_cast<Real>(step), m_system, m_system.Positions(), m_system.Velocities(),
                       m_scratch.integrator);
      }
      UpdateContacts(static_cast<Real>(step));
    }
    for (std::size_t i = 0; i < m_system.CountBodies(); ++i) {
      Member<Real>& member = *m_system.Members()[i];
      member.error *= kErrorShare / substeps;
      member.insideOut =
          IsInsideOut<Real>(member.blueprint->template Read<Real>(), m_system.SliceOf(m_scratch.positions, i));
    }
  }

  // The same step as runge_kutta.h's, with each member's error estimated by substeps_for_error.h's formula. step: s;
  // timeLeft: of the tick at the step's begin, s; hasBefore: this is not the tick's first step.
  void StepRungeKutta(double step, bool hasBefore, double timeLeft) {
    const auto h = static_cast<Real>(step);
    auto& stages = m_scratch.integrator.stages;
    stages.Resize(m_scratch.positions.size());
    for (std::size_t stage = 0; stage < 4; ++stage) {
      m_system.Accelerate(stages.positions, stages.velocities[stage], stages.accelerations[stage], true,
                          [&](std::size_t i) {
                            CombineStage<Real>(kClassicRungeKutta, stage, h, m_scratch.positions, m_scratch.velocities,
                                               m_scratch.begins[i], m_scratch.begins[i + 1], stages);
                          });
      if (stage == 0 && hasBefore) AddAccelerationErrors(step, timeLeft);
    }
    m_system.ForEach(m_system.CountBodies(), [&](std::size_t i) {
      AddIncrements<Real>(kClassicRungeKutta, h, m_scratch.begins[i], m_scratch.begins[i + 1], stages,
                          m_scratch.positions, m_scratch.velocities);
      m_system.Members()[i]->error += step / 6 *
                                      FindRmsOfDifference<Real>(m_system.SliceOf(stages.velocities[3], i),
                                                                m_system.SliceOf(m_scratch.velocities, i));
    });
  }

  // The buffer of stage 3 still holds a₄ of the substep before when stage 0 of this one has been computed.
  void AddAccelerationErrors(double step, double timeLeft) {
    const auto& accelerations = m_scratch.integrator.stages.accelerations;
    m_system.ForEach(m_system.CountBodies(), [&](std::size_t i) {
      const double jump =
          FindRmsOfDifference<Real>(m_system.SliceOf(accelerations[3], i), m_system.SliceOf(accelerations[0], i));
      m_system.Members()[i]->error += step / 6 * jump * timeLeft;
    });
  }

  // Backtracking compares each substep's end with its begin.
  void KeepBefore() {
    const auto members = m_system.Members();
    if (std::none_of(members.begin(), members.end(), [](const auto* member) { return Backtracks(*member); })) return;
    m_scratch.positionsBefore = m_scratch.positions;
    m_scratch.velocitiesBefore = m_scratch.velocities;
  }

  void UpdateContacts(Real h) {
    m_system.ForEach(m_system.CountBodies(), [&](std::size_t i) {
      const Member<Real>& member = *m_system.Members()[i];
      const Coefficients<Real>& body = member.blueprint->template Read<Real>();
      const auto x = m_system.SliceOf(m_system.Positions(), i);
      if (Backtracks(member)) {
        PutBack<Real>(body, h, member.surfaces, m_system.SliceOf(m_scratch.positionsBefore, i),
                      m_system.SliceOf(m_scratch.velocitiesBefore, i), member.state->contacts, x,
                      m_system.SliceOf(m_system.Velocities(), i));
      }
      UpdateAnchors<Real>(body.contact, member.surfaces, member.state->contacts, h, x,
                          m_system.SliceOf(m_system.Velocities(), i));
    });
    m_system.UpdateAllBodyContacts(m_scratch.positions, m_scratch.velocities, h);
  }

  BodySystem<Real>& m_system;
  const StepRules& m_rules;
  SystemScratch<Real>& m_scratch;
  Integrator m_integrator;
  IslandTick<Real> m_tick;
};

}  // namespace

template <class Real>
IslandOutcome StepIsland(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
                         int substeps, const StepRules& rules, Threads* threads, SystemScratch<Real>& scratch) {
  BodySystem<Real> system(members, contactPairs, threads, FindSweepKernels<Real>(kWidestPack).back(), scratch);
  return PlainStepping<Real>(system, rules).Step(substeps);
}

#define WOBBLE_INSTANTIATE(Real)                                                                                   \
  template IslandOutcome StepIsland<Real>(std::span<Member<Real>* const>, std::span<const ContactPair<Real>>, int, \
                                          const StepRules&, Threads*, SystemScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
