// Solves a problem with the engine's own integrators in equal steps: any method, either precision. The step choice,
// sleep and rescue of the server are left out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/physics/model/integrator.h"
#include "tests/bench/accuracy/problem.h"

namespace wobble::bench {

struct FixedSteps {
  physics::Integrator integrator = physics::Integrator::kRungeKutta4;
  std::int64_t steps = 1;  // over the whole duration of the problem
  bool isSingle = false;   // float in body-local coordinates, as on a server; otherwise double
  int bodies = 1;          // that many identical bodies; results are those of the first
  bool isSampled = false;  // record the energy at each tick of 1/60 s
  bool isTimed = false;  // take one step first, so that allocation and the symbolic analysis of a matrix are not timed
};

// A solution with a vertex this far from the origin counts as blown up, m.
inline constexpr double kFarAway = 1000;

struct SolvedMotion {
  Motion end;                                   // of the first body; its last state if it blew up
  bool blewUp = false;                          // non-finite or beyond kFarAway; the solution stops there
  std::int64_t evaluations = 0;                 // of the forces, per body
  double time = 0;                              // thread time for all bodies, s; energy sampling excluded
  std::vector<std::array<double, 2>> energies;  // time, s, and FindEnergy, J
};

[[nodiscard]] SolvedMotion SolveInSteps(const Problem& problem, const FixedSteps& how);

// RK4 with the bodies side by side in SIMD lanes, as the server steps bodies without contact pairs. The problem has no
// obstacles; energies are not sampled.
[[nodiscard]] SolvedMotion SolveInLanes(const Problem& problem, const FixedSteps& how);

// FindName gives the name used in rows ("explicit_euler"), FindTitle the one used in plots ("explicit Euler").
[[nodiscard]] const char* FindName(physics::Integrator integrator);
[[nodiscard]] const char* FindTitle(physics::Integrator integrator);
// All integrators, RK4 first.
inline constexpr std::array kIntegrators = {
    physics::Integrator::kRungeKutta4,    physics::Integrator::kVelocityVerlet,    physics::Integrator::kLeapFrog,
    physics::Integrator::kPositionVerlet, physics::Integrator::kSemiImplicitEuler, physics::Integrator::kExplicitEuler,
    physics::Integrator::kImplicitEuler};

}  // namespace wobble::bench
