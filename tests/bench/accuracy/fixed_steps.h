// A problem solved by the engine's own code in equal steps: any of its methods, either precision, nothing of the choice
// of steps, of sleep or of rescue that a server has besides.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/physics/model/integrator.h"
#include "tests/bench/accuracy/problem.h"

namespace wobble::bench {

struct FixedSteps {
  physics::Integrator integrator = physics::Integrator::kRungeKutta4;
  std::int64_t steps = 1;  // from the problem's beginning to its end
  bool isSingle = false;   // float, in coordinates local to the body, as a server has it; else double
  int bodies = 1;          // that many alike, of which the first is looked at
  bool isSampled = false;  // whether its energy is looked at, each tick of 1/60 s
  bool isTimed = false;    // takes a step beforehand, so that memory and the analysis of a matrix do not count
};

// What has come this far has blown up, m.
inline constexpr double kFarAway = 1000;

struct SolvedMotion {
  Motion end;                                   // of the first body; what it had come to where it blew up
  bool blewUp = false;                          // no number, or far away: it was not followed to the end
  std::int64_t evaluations = 0;                 // of the forces, a body
  double time = 0;                              // of this thread, for all bodies, s; without looking at energies
  std::vector<std::array<double, 2>> energies;  // s, and by FindEnergy J
};

[[nodiscard]] SolvedMotion SolveInSteps(const Problem& problem, const FixedSteps& how);

// By RK4 with the bodies side by side in lanes, as the server steps those that touch no other; of a problem without
// obstacles. Not sampled.
[[nodiscard]] SolvedMotion SolveInLanes(const Problem& problem, const FixedSteps& how);

// As rows have it, "explicit_euler", and as plots do, "explicit Euler".
[[nodiscard]] const char* FindName(physics::Integrator integrator);
[[nodiscard]] const char* FindTitle(physics::Integrator integrator);
// All of them, RK4 first.
inline constexpr std::array kIntegrators = {
    physics::Integrator::kRungeKutta4,    physics::Integrator::kVelocityVerlet,    physics::Integrator::kLeapFrog,
    physics::Integrator::kPositionVerlet, physics::Integrator::kSemiImplicitEuler, physics::Integrator::kExplicitEuler,
    physics::Integrator::kImplicitEuler};

}  // namespace wobble::bench
