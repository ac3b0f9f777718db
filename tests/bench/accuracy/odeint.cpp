// Uses odeint as its manual shows: one flat std::vector<double>, positions of all bodies, then velocities, and a system
// that writes their derivative. The default algebra is kept: more than nine tenths of a step are spent in the forces.
// This is the only file that includes odeint, because its headers are slow to compile.
#include "tests/bench/accuracy/odeint.h"

#include <algorithm>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/integrate/integrate_n_steps.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <utility>

#include "server/physics/methods/forces.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

using namespace physics;
namespace odeint = boost::numeric::odeint;

using FlatState = std::vector<double>;

static_assert(sizeof(Vector3d) == 3 * sizeof(double) && alignof(Vector3d) == alignof(double));

// Views three consecutive doubles as a vector, because copies would be charged to odeint.
std::span<const Vector3d> ViewVectors(const FlatState& state, std::size_t begin, std::size_t count) {
  return {reinterpret_cast<const Vector3d*>(state.data()) + begin, count};
}
std::span<Vector3d> ViewVectors(FlatState& state, std::size_t begin, std::size_t count) {
  return {reinterpret_cast<Vector3d*>(state.data()) + begin, count};
}

class Derivative {
 public:
  Derivative(const Problem& problem, const OdeintSteps& how) : m_problem(problem), m_how(how) {
    m_load.acceleration = problem.equations.gravity;
    m_load.wind = problem.equations.wind;
  }

  void operator()(const FlatState& state, FlatState& derivative, double) {
    ++m_evaluations;
    const std::size_t half = state.size() / 2;
    std::copy(state.begin() + static_cast<std::ptrdiff_t>(half), state.end(), derivative.begin());
    const std::size_t vertices = m_problem.x.size();
    for (std::size_t begin = 0; begin < half / 3; begin += vertices) {
      Accelerate(ViewVectors(state, begin, vertices), ViewVectors(state, half / 3 + begin, vertices),
                 ViewVectors(derivative, half / 3 + begin, vertices));
    }
  }
  [[nodiscard]] std::int64_t CountEvaluations() const { return m_evaluations; }

 private:
  void Accelerate(std::span<const Vector3d> x, std::span<const Vector3d> v, std::span<Vector3d> a) const {
    if (m_how.asksEngine) {
      ComputeAccelerations<double>(m_problem.blueprint->full, m_load, {}, {}, x, v, a);
    } else {
      FindAccelerations(m_problem.equations, x, v, a);
    }
  }

  const Problem& m_problem;
  const OdeintSteps& m_how;
  Load<double> m_load;
  std::int64_t m_evaluations = 0;
};

void Integrate(Derivative& derivative, const OdeintSteps& how, double duration, FlatState& state) {
  // By reference: steppers copy the system, and the copy's evaluation counter would be lost.
  const auto system = [&](const FlatState& at, FlatState& change, double time) { derivative(at, change, time); };
  if (how.method == OdeintSteps::Method::kRungeKutta4) {
    odeint::integrate_n_steps(odeint::runge_kutta4<FlatState>(), system, state, 0.0,
                              duration / static_cast<double>(how.steps), static_cast<std::size_t>(how.steps));
    return;
  }
  constexpr double kFirstStep = 1.0 / 60;  // s; then adaptive
  odeint::integrate_adaptive(
      odeint::make_controlled(how.tolerance, how.tolerance, odeint::runge_kutta_dopri5<FlatState>()), system, state,
      0.0, duration, std::min(kFirstStep, duration));
}

}  // namespace

SolvedMotion SolveByOdeint(const Problem& problem, const OdeintSteps& how) {
  const std::size_t vertices = problem.x.size();
  FlatState state;
  for (const std::vector<Vector3d>* part : {&problem.x, &problem.v}) {
    for (int body = 0; body < how.bodies; ++body) {
      for (const Vector3d& each : *part) state.insert(state.end(), each.data(), each.data() + 3);
    }
  }
  Derivative derivative(problem, how);
  SolvedMotion solved;
  const double began = ReadThreadTime();
  Integrate(derivative, how, problem.duration, state);
  solved.time = ReadThreadTime() - began;
  solved.evaluations = derivative.CountEvaluations();
  const auto x = ViewVectors(std::as_const(state), 0, vertices);
  const auto v = ViewVectors(std::as_const(state), how.bodies * vertices, vertices);
  solved.end = {{x.begin(), x.end()}, {v.begin(), v.end()}};
  solved.blewUp = std::any_of(x.begin(), x.end(), [](const Vector3d& each) { return !(each.norm() < kFarAway); });
  return solved;
}

const char* FindName(OdeintSteps::Method method) {
  return method == OdeintSteps::Method::kRungeKutta4 ? "odeint_rk4" : "odeint_dopri5";
}

const char* FindTitle(OdeintSteps::Method method) {
  return method == OdeintSteps::Method::kRungeKutta4 ? "odeint RK4" : "odeint Dormand–Prince";
}

}  // namespace wobble::bench
