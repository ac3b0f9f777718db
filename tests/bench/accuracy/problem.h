// Test problems with solutions accurate enough to measure errors against.
//
// Only well-posed problems are used: motions that begin side by side stay side by side. A shell is ill-posed where its
// springs go slack and it crumples. With little gas, a ball stretched by 20 % crumples at once; without damping, two
// solutions in double precision, each accurate to twelve digits per step, have nothing in common after 10 s (the
// laboratory plots how they part). Hence the problems have more gas, and combine a large stretch with a short duration,
// a small stretch with a long one, or a large stretch with damping.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/bench/accuracy/equations.h"

namespace wobble::bench {

struct Problem {
  std::string name;  // in rows and plots
  std::shared_ptr<const physics::Blueprint> blueprint;
  Equations equations;          // of *blueprint
  std::vector<Vector3d> x;      // initial positions, m
  std::vector<Vector3d> v;      // m/s
  double duration = 0;          // s
  bool isConservative = false;  // energy is conserved
  bool touches = false;         // touches a surface: the order of a method is not measured on it
};

// A body at rest without external forces. The caller sets the name.
[[nodiscard]] Problem MakeProblem(physics::Blueprint blueprint, double duration);

// An undamped ball of 162 vertices, stretched by 20 % along z and thinner across, for 0.25 s: the problem on which
// methods are compared.
[[nodiscard]] Problem MakeStretchedBall();
// All problems: MakeStretchedBall() first, then that ball at 2 % for 10 s, then at 20 % for 10 s with damping, then the
// others.
[[nodiscard]] std::vector<Problem> MakeProblems();
// Problems left out of MakeProblems() because they are ill-posed (see above): stretched by 20 % for 10 s without
// damping, with as much gas as the others (MakeUndampedBall) and with a quarter of it (MakeIllPosedBall).
[[nodiscard]] Problem MakeUndampedBall();
[[nodiscard]] Problem MakeIllPosedBall();

// Final state of a motion.
struct Motion {
  std::vector<Vector3d> x;  // m
  std::vector<Vector3d> v;  // m/s
};

// Solves by SUNDIALS' CVODE (variable-order Adams) with that relative tolerance per step. Ends the process with an
// error line if CVODE fails.
struct Solution {
  Motion motion;
  long steps = 0;
  long evaluations = 0;  // of the accelerations
};
[[nodiscard]] Solution SolveByCvode(const Problem& problem, double tolerance);
// The tightest relative tolerance in use, and the solution with it.
inline constexpr double kReferenceTolerance = 1e-12;
[[nodiscard]] Motion SolveReference(const Problem& problem);

// RMS over the vertices of the distance between `a` and `b`, m.
[[nodiscard]] double FindDistance(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b);

}  // namespace wobble::bench
