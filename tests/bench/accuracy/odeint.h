// Solves the same problems with Boost.odeint, the usual off-the-shelf ODE solver for C++.
#pragma once

#include "tests/bench/accuracy/fixed_steps.h"

namespace wobble::bench {

struct OdeintSteps {
  enum class Method {
    kRungeKutta4,    // runge_kutta4, equal steps
    kDormandPrince,  // runge_kutta_dopri5, adaptive steps
  };
  Method method = Method::kRungeKutta4;
  std::int64_t steps = 1;   // for kRungeKutta4
  double tolerance = 1e-6;  // for kDormandPrince: per step, absolute and relative
  int bodies = 1;           // that many identical bodies in one state vector
  bool asksEngine = false;  // forces from the engine (without obstacles); otherwise from equations.h
};

// The result has no energies.
[[nodiscard]] SolvedMotion SolveByOdeint(const Problem& problem, const OdeintSteps& how);

// FindName: "odeint_rk4", "odeint_dopri5". FindTitle: "odeint RK4", "odeint Dormand–Prince".
[[nodiscard]] const char* FindName(OdeintSteps::Method method);
[[nodiscard]] const char* FindTitle(OdeintSteps::Method method);

}  // namespace wobble::bench
