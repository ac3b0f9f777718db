// A server's tick with the step chosen by hand: contacts are listed and the origin is moved every 1/60 s; in between,
// equal steps by integrator_step.h use the forces of forces.h, and anchors are updated after each step. Steps need not
// divide a tick; a step belongs to the tick in which it begins. Several bodies take turns tick by tick, as in a world,
// so that the caches hold the same data as there.
#include "tests/bench/accuracy/fixed_steps.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/physics/methods/integrator_step.h"
#include "server/physics/model/state.h"
#include "server/physics/model/survey.h"
#include "server/physics/packs/batch_step.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kTick = 1.0 / 60;

// Names of each integrator, in the order of the enumeration.
struct Words {
  const char* name;
  const char* title;
};
constexpr Words kWords[] = {
    {"rk4", "RK4"},
    {"explicit_euler", "explicit Euler"},
    {"semi_implicit_euler", "semi-implicit Euler"},
    {"velocity_verlet", "velocity Verlet"},
    {"leap_frog", "leap-frog"},
    {"position_verlet", "position Verlet"},
    {"implicit_euler", "implicit Euler"},
};
static_assert(std::size(kWords) == kIntegrators.size());

// The system that StepOnce integrates.
template <class Real>
class LoneBody {
 public:
  LoneBody(const Problem& problem, const Blueprint& blueprint)
      : m_equations(problem.equations), m_blueprint(blueprint) {
    m_load.acceleration = m_equations.gravity.cast<Real>();
    m_load.wind = m_equations.wind.cast<Real>();
    for (const Vector3d& x : problem.x) m_state.origin += x / static_cast<double>(problem.x.size());
    for (const Vector3d& x : problem.x) m_state.positions.push_back((x - m_state.origin).template cast<Real>());
    for (const Vector3d& v : problem.v) m_state.velocities.push_back(v.cast<Real>());
  }

  void Accelerate(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> a,
                  bool springs) const {
    ++m_evaluations;
    Load<Real> load = m_load;
    if (!springs) load.stiffnessFactor = 0;
    ComputeAccelerations<Real>(m_blueprint.Read<Real>(), load, m_surfaces, m_state.contacts, x, v, a);
  }
  [[nodiscard]] std::size_t CountBodies() const { return 1; }
  [[nodiscard]] SteppedBody<Real> ReadBody(std::size_t) const {
    return {&m_blueprint, &m_load, m_surfaces, m_state.contacts, m_state.torn, 0};
  }

  void BeginTick() {
    Recentre(m_blueprint, FindCentre(m_blueprint, m_state) - m_state.origin, m_state);
    if (m_equations.obstacles.empty()) return;
    m_surfaces.clear();
    for (const Obstacle& each : m_equations.obstacles) m_surfaces.push_back(MakeSurface<Real>(each, m_state.origin));
    const Coefficients<Real>& coefficients = m_blueprint.Read<Real>();
    FindContacts<Real>({.surfaces = m_surfaces,
                        .x = m_state.positions,
                        .v = m_state.velocities,
                        .survey = MakeSurvey<Real>(coefficients.masses, m_state.positions, m_state.velocities),
                        .range = coefficients.contact.range,
                        .duration = static_cast<Real>(kTick)},
                       m_state.contacts, m_contactScratch);
  }
  void Step(Integrator integrator, double h, IntegratorScratch<Real>& scratch) {
    StepOnce<Real>(integrator, static_cast<Real>(h), *this, std::span(m_state.positions), std::span(m_state.velocities),
                   scratch);
    UpdateAnchors<Real>(m_blueprint.Read<Real>().contact, m_surfaces, m_state.contacts, static_cast<Real>(h),
                        m_state.positions, m_state.velocities);
  }

  [[nodiscard]] bool IsAway() const {
    return std::any_of(m_state.positions.begin(), m_state.positions.end(),
                       [](const Vector3<Real>& x) { return !(x.norm() < static_cast<Real>(kFarAway)); });
  }
  [[nodiscard]] Motion Read() const {
    Motion motion;
    for (const Vector3<Real>& x : m_state.positions) motion.x.push_back(m_state.origin + x.template cast<double>());
    for (const Vector3<Real>& v : m_state.velocities) motion.v.push_back(v.template cast<double>());
    return motion;
  }
  [[nodiscard]] std::int64_t CountEvaluations() const { return m_evaluations; }

 private:
  const Equations& m_equations;
  const Blueprint& m_blueprint;
  Load<Real> m_load;
  State<Real> m_state;
  std::vector<Surface<Real>> m_surfaces;
  std::vector<Contact<Real>> m_contactScratch;
  mutable std::int64_t m_evaluations = 0;
};

template <class Real>
SolvedMotion Solve(const Problem& problem, const Blueprint& blueprint, const FixedSteps& how) {
  const double h = problem.duration / static_cast<double>(how.steps);
  const auto ticks = static_cast<std::int64_t>(std::ceil(problem.duration / kTick - 1e-9));
  IntegratorScratch<Real> scratch;
  if (how.isTimed) {
    LoneBody<Real> before(problem, blueprint);
    before.BeginTick();
    before.Step(how.integrator, h, scratch);
  }
  std::vector<LoneBody<Real>> bodies(how.bodies, LoneBody<Real>(problem, blueprint));
  SolvedMotion solved;
  const auto look = [&](std::int64_t steps) {
    if (!how.isSampled) return;
    const Motion now = bodies[0].Read();
    solved.energies.push_back({static_cast<double>(steps) * h, FindEnergy(problem.equations, now.x, now.v)});
  };
  look(0);
  std::int64_t done = 0;
  for (std::int64_t tick = 0; tick < ticks && !solved.blewUp; ++tick) {
    const std::int64_t end = how.steps * (tick + 1) / ticks;
    const double began = ReadThreadTime();
    for (LoneBody<Real>& body : bodies) {
      body.BeginTick();
      for (std::int64_t step = done; step < end; ++step) body.Step(how.integrator, h, scratch);
    }
    solved.time += ReadThreadTime() - began;
    if (end > done) look(end);
    done = end;
    solved.blewUp = bodies[0].IsAway();
  }
  solved.end = bodies[0].Read();
  solved.evaluations = bodies[0].CountEvaluations();
  return solved;
}

template <class Real>
SolvedMotion SolveSideBySide(const Problem& problem, const FixedSteps& how) {
  const auto kernels = FindSweepKernels<Real>(kWidestPack);
  std::vector<State<Real>> states(how.bodies, MakeState<Real>(*problem.blueprint, Vector3d::Zero(), Vector3d::Zero()));
  std::vector<Member<Real>> members(how.bodies);
  std::vector<Member<Real>*> pointers;
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t vertex = 0; vertex < problem.x.size(); ++vertex) {
      states[i].positions[vertex] = problem.x[vertex].cast<Real>();
      states[i].velocities[vertex] = problem.v[vertex].cast<Real>();
    }
    members[i].blueprint = problem.blueprint.get();
    members[i].state = &states[i];
    members[i].load.acceleration = problem.equations.gravity.cast<Real>();
    pointers.push_back(&members[i]);
  }
  static thread_local BatchScratch<Real> scratch;  // warm from the second call on
  SolvedMotion solved;
  const double began = ReadThreadTime();
  for (std::size_t begin = 0; begin < pointers.size(); begin += kernels.back().width) {
    const std::size_t count = std::min<std::size_t>(kernels.back().width, pointers.size() - begin);
    IntegrateBatch<Real>(std::span(pointers).subspan(begin, count), problem.duration, static_cast<int>(how.steps),
                         kernels, scratch);
  }
  solved.time = ReadThreadTime() - began;
  solved.evaluations = 4 * how.steps;
  for (std::size_t vertex = 0; vertex < problem.x.size(); ++vertex) {
    solved.end.x.push_back(states[0].positions[vertex].template cast<double>());
    solved.end.v.push_back(states[0].velocities[vertex].template cast<double>());
  }
  return solved;
}

}  // namespace

SolvedMotion SolveInLanes(const Problem& problem, const FixedSteps& how) {
  return how.isSingle ? SolveSideBySide<float>(problem, how) : SolveSideBySide<double>(problem, how);
}

SolvedMotion SolveInSteps(const Problem& problem, const FixedSteps& how) {
  Blueprint blueprint = *problem.blueprint;
  SetIntegrator(blueprint, how.integrator);
  return how.isSingle ? Solve<float>(problem, blueprint, how) : Solve<double>(problem, blueprint, how);
}

const char* FindName(Integrator integrator) { return kWords[static_cast<std::size_t>(integrator)].name; }

const char* FindTitle(Integrator integrator) { return kWords[static_cast<std::size_t>(integrator)].title; }

}  // namespace wobble::bench
