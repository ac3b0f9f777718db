// Balls on the ground, stepped through one tick again and again by fixed steps: no step choice and no checks.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <type_traits>
#include <vector>

#include "server/physics/packs/batch_step.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {

inline constexpr double kBallsTick = 1.0 / 60;  // s

// Sixteen balls, five seconds after they were dropped.
template <class Real>
[[nodiscard]] std::shared_ptr<const physics::World> MakeBallsAtRest() {
  constexpr int kTicksToRest = 300;
  physics::WorldSettings settings;
  settings.precision = std::is_same_v<Real, float> ? physics::Precision::kSingle : physics::Precision::kDouble;
  return MakeBallsApart(physics::kWidestPack, settings, kTicksToRest);
}

struct BallsSetting {
  std::size_t bodies = 16;
  int steps = 32;  // per tick
  bool isOnGround = true;
};

template <class Real>
class Balls {
 public:
  // Takes the first bodies of `world`, which has precision Real, a floor, and bodies of one blueprint.
  Balls(std::shared_ptr<const physics::World> world, const BallsSetting& setting)
      : m_steps(setting.steps), m_world(std::move(world)) {
    const std::size_t count = setting.bodies;
    m_blueprint = &m_world->Blueprints()[0];
    for (const physics::Body& body : m_world->Bodies().first(count))
      m_beginning.push_back(std::get<physics::State<Real>>(body.state));
    m_states = m_beginning;
    m_members.resize(count);
    std::vector<physics::Contact<Real>> spare;
    for (std::size_t i = 0; i < count; ++i) {
      physics::Member<Real>& member = m_members[i];
      physics::State<Real>& state = m_beginning[i];
      member.blueprint = m_blueprint;
      member.state = &m_states[i];
      member.load.acceleration = m_world->Settings().gravity.cast<Real>();
      member.survey = physics::MakeSurvey<Real>(m_blueprint->Read<Real>().masses, state.positions, state.velocities);
      if (!setting.isOnGround) state.contacts.clear();
      if (!setting.isOnGround) continue;
      member.surfaces.push_back(physics::MakeSurface<Real>(m_world->Obstacles()[0], state.origin));
      physics::FindContacts<Real>({.surfaces = member.surfaces,
                                   .x = state.positions,
                                   .v = state.velocities,
                                   .survey = member.survey,
                                   .range = m_blueprint->Read<Real>().contact.range,
                                   .duration = static_cast<Real>(kBallsTick)},
                                  state.contacts, spare);
    }
    m_stages.Reserve(m_blueprint->rest.size());
    Reset();
  }

  // Back to the beginning of the tick.
  void Reset() { m_states = m_beginning; }

  void StepInLanes(int widest) {
    const auto kernels = physics::FindSweepKernels<Real>(widest);
    const auto width = static_cast<std::size_t>(kernels.back().width);
    std::array<physics::Member<Real>*, physics::kWidestPack> pack;
    for (std::size_t begin = 0; begin < m_members.size(); begin += width) {
      const std::size_t count = std::min(width, m_members.size() - begin);
      for (std::size_t i = 0; i < count; ++i) pack[i] = &m_members[begin + i];
      physics::IntegrateBatch<Real>(std::span(pack).first(count), kBallsTick, m_steps, kernels, m_scratch);
    }
  }

  void StepPlainly() {
    for (physics::Member<Real>& member : m_members) {
      physics::State<Real>& state = *member.state;
      const physics::Coefficients<Real>& body = m_blueprint->Read<Real>();
      const auto accelerate = [&](std::span<const physics::Vector3<Real>> x, std::span<const physics::Vector3<Real>> v,
                                  std::span<physics::Vector3<Real>> a) {
        physics::ComputeAccelerations<Real>(body, member.load, member.surfaces, state.contacts, x, v, a);
      };
      const auto h = static_cast<Real>(kBallsTick / m_steps);
      for (int step = 0; step < m_steps; ++step) {
        physics::StepRungeKutta<Real>(physics::kClassicRungeKutta, h, accelerate, std::span(state.positions),
                                      std::span(state.velocities), m_stages);
        physics::UpdateAnchors<Real>(body.contact, member.surfaces, state.contacts, h, state.positions,
                                     state.velocities);
      }
    }
  }

  // Time per vertex and step when all of it took `time`, s.
  [[nodiscard]] double FindShare(double time) const {
    return time / static_cast<double>(m_members.size() * m_blueprint->rest.size()) / m_steps;
  }
  [[nodiscard]] double CountContacts() const {
    std::size_t count = 0;
    for (const physics::State<Real>& state : m_beginning) count += state.contacts.size();
    return static_cast<double>(count) / static_cast<double>(m_beginning.size());
  }

 private:
  int m_steps;
  std::shared_ptr<const physics::World> m_world;
  const physics::Blueprint* m_blueprint = nullptr;
  std::vector<physics::State<Real>> m_beginning;
  std::vector<physics::State<Real>> m_states;
  std::vector<physics::Member<Real>> m_members;
  physics::BatchScratch<Real> m_scratch;
  physics::StageBuffers<Real, 4> m_stages;
};

}  // namespace wobble::bench
