// Boost.odeint, the solver that a program in C++ would take from the shelf, on the same problems.
#pragma once

#include "tests/bench/accuracy/fixed_steps.h"

namespace wobble::bench {

struct OdeintSteps {
  enum class Method {
    kRungeKutta4,    // runge_kutta4, in equal steps
    kDormandPrince,  // runge_kutta_dopri5, which chooses its steps by their error
  };
  Method method = Method::kRungeKutta4;
  std::int64_t steps = 1;   // equal ones
  double tolerance = 1e-6;  // else: of a step, absolute and relative
  int bodies = 1;           // that many alike, in one state vector
  bool asksEngine = false;  // for the forces, which does without surfaces; else equations.h is asked
};

// Without energies.
[[nodiscard]] SolvedMotion SolveByOdeint(const Problem& problem, const OdeintSteps& how);

// "odeint_rk4", "odeint_dopri5"; "odeint RK4", "odeint Dormand–Prince".
[[nodiscard]] const char* FindName(OdeintSteps::Method method);
[[nodiscard]] const char* FindTitle(OdeintSteps::Method method);

}  // namespace wobble::bench
