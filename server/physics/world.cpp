// A tick of a body is: control, contacts that may come, substeps, RK4, health. Bodies do not see each other here, so
// they are stepped in parallel, each by one thread from beginning to end: nothing is summed across threads, and the
// result cannot depend on how many there are.
#include "server/physics/world.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/physics/runge_kutta.h"
#include "server/physics/stability.h"

#ifdef __SANITIZE_THREAD__
extern "C" {  // of the sanitizer's runtime
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}
#endif

namespace wobble::physics {
namespace {

// Share of the way that puffing and stiffening go each tick: 0.1 s to 95 %, slow enough that the change of energy is
// the player's work and no shock.
constexpr double kFactorApproach = 0.4;

// Speed error that moving answers with full acceleration, as a share of the top speed.
constexpr double kSpeedBand = 0.25;

template <class Real>
struct KernelScratch {
  StageBuffers<Real, 4> stages;
  std::vector<Surface<Real>> surfaces;
  std::vector<Contact<Real>> contacts;
};

// Horizontal acceleration towards the speed asked for. Without a request the body is left to friction.
Vector3d FindMoveAcceleration(const Control& control, const ControlLimits& limits, const Vector3d& velocity) {
  const Vector3d wanted(control.moveX, control.moveY, 0);
  if (wanted.isZero(0) || !(limits.speed > 0)) return Vector3d::Zero();
  Vector3d missing = wanted * limits.speed - velocity;
  missing.z() = 0;
  const Vector3d share = missing / (kSpeedBand * limits.speed);
  return limits.acceleration * share / std::max(1.0, share.norm());
}

template <class Real>
bool IsTouching(const State<Real>& state) {
  return std::any_of(state.contacts.begin(), state.contacts.end(), [](const Contact<Real>& c) { return c.touching; });
}

// Applies a jump at once and returns what else acts through the tick.
template <class Real>
Load<Real> ApplyControl(const Blueprint& blueprint, const Vector3d& gravity, Body& body, State<Real>& state) {
  const Control& control = body.control;
  const ControlLimits& limits = body.limits;
  if (control.jump && !body.jumpHeld && IsTouching(state)) {
    for (Vector3<Real>& v : state.velocities) v.z() += static_cast<Real>(limits.jumpSpeed);
  }
  body.jumpHeld = control.jump;
  body.gasFactor += kFactorApproach * ((control.puff ? limits.puffFactor : 1.0) - body.gasFactor);
  body.stiffnessFactor += kFactorApproach * ((control.stiffen ? limits.stiffenFactor : 1.0) - body.stiffnessFactor);

  Load<Real> load;
  const Vector3d push = FindMoveAcceleration(control, limits, FindMeanVelocity(blueprint, state));
  load.acceleration = (gravity + push).cast<Real>();
  load.gasFactor = static_cast<Real>(body.gasFactor);
  load.stiffnessFactor = static_cast<Real>(body.stiffnessFactor);
  return load;
}

// What a parallel loop guarantees, told to ThreadSanitizer: the loop's body runs after the fork and before the join. It
// cannot see that itself, since Debian's oneTBB is not built with it. Races between bodies are still found.
struct ForkJoin {
#ifdef __SANITIZE_THREAD__
  void Fork() { __tsan_release(&m_fork); }
  void Begin() { __tsan_acquire(&m_fork); }
  void End() { __tsan_release(&m_join); }
  void Join() { __tsan_acquire(&m_join); }
  char m_fork = 0;
  char m_join = 0;
#else
  void Fork() {}
  void Begin() {}
  void End() {}
  void Join() {}
#endif
};

}  // namespace

struct World::Scratch {
  KernelScratch<float> single;
  KernelScratch<double> full;

  template <class Real>
  KernelScratch<Real>& Of() {
    if constexpr (std::is_same_v<Real, float>) {
      return single;
    } else {
      return full;
    }
  }
};

struct World::Threads {
  explicit Threads(int count)
      : limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)), arena(count) {}
  tbb::global_control limit;  // also lets there be more threads than cores, for tests
  tbb::task_arena arena;
  tbb::enumerable_thread_specific<Scratch> scratch;
};

struct World::Outcome {
  int substeps = 0;
  bool nonFinite = false;
  bool inverted = false;
};

World::World(const WorldSettings& settings)
    : m_settings(settings), m_threads(std::make_unique<Threads>(settings.threads)) {
  assert(settings.threads >= 1 && settings.tickDuration > 0);
}

World::~World() = default;

std::uint8_t World::AddBlueprint(Blueprint blueprint) {
  assert(m_bodies.empty() && m_blueprints.size() < 255);
  m_blueprints.push_back(std::move(blueprint));
  return static_cast<std::uint8_t>(m_blueprints.size() - 1);
}

void World::AddObstacle(const Obstacle& obstacle) {
  assert(m_bodies.empty());
  m_obstacles.push_back(obstacle);
}

BodyId World::AddBody(std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity) {
  assert(blueprint < m_blueprints.size());
  Body body;
  body.id = m_nextId++;
  body.blueprint = blueprint;
  if (m_settings.precision == Precision::kSingle) {
    body.state = MakeState<float>(m_blueprints[blueprint], position, velocity);
  } else {
    body.state = MakeState<double>(m_blueprints[blueprint], position, velocity);
  }
  m_bodies.push_back(std::move(body));
  return m_bodies.back().id;
}

Body& World::FindBody(BodyId id) {
  const auto found = std::lower_bound(m_bodies.begin(), m_bodies.end(), id,
                                      [](const Body& body, BodyId wanted) { return body.id < wanted; });
  assert(found != m_bodies.end() && found->id == id);
  return *found;
}

const Body& World::ReadBody(BodyId id) const { return const_cast<World*>(this)->FindBody(id); }

void World::RemoveBody(BodyId id) { m_bodies.erase(m_bodies.begin() + (&FindBody(id) - m_bodies.data())); }

void World::PlaceBody(BodyId id, const Vector3d& position) {
  Body& body = FindBody(id);
  std::visit(
      [&]<class Real>(State<Real>& state) {
        state = MakeState<Real>(m_blueprints[body.blueprint], position, Vector3d::Zero());
      },
      body.state);
}

void World::SetControl(BodyId id, const Control& control, const ControlLimits& limits) {
  assert(control.moveX * control.moveX + control.moveY * control.moveY <= 1.0001);
  Body& body = FindBody(id);
  body.control = control;
  body.limits = limits;
}

template <class Real>
World::Outcome World::StepState(Body& body, State<Real>& state, Scratch& scratch) const {
  const Blueprint& blueprint = m_blueprints[body.blueprint];
  const Coefficients<Real>& coefficients = blueprint.Read<Real>();
  KernelScratch<Real>& kernel = scratch.Of<Real>();
  const Vector3d safePlace = physics::FindCentre(blueprint, state);

  const Load<Real> load = ApplyControl(blueprint, m_settings.gravity, body, state);
  kernel.surfaces.clear();
  for (const Obstacle& obstacle : m_obstacles) kernel.surfaces.push_back(MakeSurface<Real>(obstacle, state.origin));
  const std::span<const Surface<Real>> surfaces = kernel.surfaces;
  FindContacts<Real>(surfaces, state.positions, state.velocities, static_cast<Real>(m_settings.tickDuration),
                     state.contacts, kernel.contacts);

  Outcome outcome;
  outcome.substeps = ChooseSubsteps<Real>(blueprint, load, surfaces, state, m_settings.tickDuration);
  const auto h = static_cast<Real>(m_settings.tickDuration / outcome.substeps);
  const auto accelerate = [&](std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                              std::span<Vector3<Real>> a) {
    ComputeAccelerations<Real>(coefficients, load, surfaces, state.contacts, x, v, a);
  };
  for (int substep = 0; substep < outcome.substeps; ++substep) {
    StepRungeKutta<Real>(kClassicRungeKutta, h, accelerate, std::span(state.positions), std::span(state.velocities),
                         kernel.stages);
    UpdateAnchors<Real>(coefficients.contact, surfaces, state.contacts, state.positions);
  }

  outcome.nonFinite = !IsFinite(state);
  outcome.inverted = !outcome.nonFinite && coefficients.gas > Real(0) &&
                     !(ComputeVolume<Real>(coefficients.faces, state.positions) > Real(0));
  if (outcome.nonFinite || outcome.inverted) {
    state = MakeState<Real>(blueprint, safePlace, Vector3d::Zero());
  } else {
    Recentre(blueprint, state);
  }
  return outcome;
}

World::Outcome World::StepBody(Body& body, Scratch& scratch) const {
  return std::visit([&]<class Real>(State<Real>& state) { return StepState<Real>(body, state, scratch); }, body.state);
}

void World::StepAll(std::vector<Outcome>& outcomes) {
  ForkJoin forkJoin;
  const auto stepRange = [&](const tbb::blocked_range<std::size_t>& range) {
    forkJoin.Begin();
    Scratch& scratch = m_threads->scratch.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) outcomes[i] = StepBody(m_bodies[i], scratch);
    forkJoin.End();
  };
  forkJoin.Fork();
  const tbb::blocked_range<std::size_t> all(0, m_bodies.size());
  if (m_settings.threads == 1) {
    stepRange(all);
  } else {
    m_threads->arena.execute([&] { tbb::parallel_for(all, stepRange); });
  }
  forkJoin.Join();
}

StepReport World::Step() {
  m_outcomes.assign(m_bodies.size(), Outcome{});
  StepAll(m_outcomes);
  ++m_tick;
  StepReport report;
  report.awake = static_cast<std::uint32_t>(m_bodies.size());
  for (const Outcome& outcome : m_outcomes) {
    report.substeps += static_cast<std::uint64_t>(outcome.substeps);
    report.nonFinite += outcome.nonFinite ? 1 : 0;
    report.inverted += outcome.inverted ? 1 : 0;
  }
  return report;
}

Vector3d World::FindCentre(const Body& body) const {
  return std::visit([&](const auto& state) { return physics::FindCentre(m_blueprints[body.blueprint], state); },
                    body.state);
}

std::uint64_t World::Hash() const {
  std::uint64_t hash = kHashSeed;
  for (const Body& body : m_bodies) {
    hash = HashBytes(std::as_bytes(std::span(&body.id, 1)), hash);
    hash = std::visit([&](const auto& state) { return HashState(state, hash); }, body.state);
  }
  return hash;
}

}  // namespace wobble::physics
