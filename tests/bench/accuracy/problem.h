// The problems whose solutions are known closely enough to measure errors by.
//
// Only well-posed ones: motions that begin side by side stay side by side. A skin does not keep to that where its
// springs go slack and it crumples. With little gas in it a ball that is stretched by 20 % does so at once, and without
// damping two solutions in double precision, each right to twelve digits a step, have nothing in common after 10 s; the
// laboratory draws how they part. Hence more gas, and a large stretch for a short while, a small one for a long while,
// or a large one with damping.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/bench/accuracy/equations.h"

namespace wobble::bench {

struct Problem {
  std::string name;  // as rows and plots have it
  std::shared_ptr<const physics::Blueprint> blueprint;
  Equations equations;          // of *blueprint
  std::vector<Vector3d> x;      // at the beginning, m
  std::vector<Vector3d> v;      // m/s
  double duration = 0;          // s
  bool isConservative = false;  // its energy stays what it is
  bool touches = false;         // a surface: the order of a method is not measured on it
};

// A body at rest, nothing acting on it; named by whoever shows it.
[[nodiscard]] Problem MakeProblem(physics::Blueprint blueprint, double duration);

// A ball of 162 vertices, 20 % longer along z and thinner across, for 0.25 s without damping: the one that methods are
// compared on.
[[nodiscard]] Problem MakeStretchedBall();
// All of them, that one first, then it at 2 % for 10 s, then at 20 % for 10 s with damping.
[[nodiscard]] std::vector<Problem> MakeProblems();
// Those that are not among them for the reason above: stretched by 20 % for 10 s without damping, with as much gas as
// the others, and with a quarter of it.
[[nodiscard]] Problem MakeUndampedBall();
[[nodiscard]] Problem MakeIllPosedBall();

// Where a motion is at the end.
struct Motion {
  std::vector<Vector3d> x;  // m
  std::vector<Vector3d> v;  // m/s
};

// By SUNDIALS' CVODE (variable-order Adams) with that relative tolerance of a step. A problem that it cannot solve ends
// the process with a line.
struct Solution {
  Motion motion;
  long steps = 0;
  long evaluations = 0;  // of the accelerations
};
[[nodiscard]] Solution SolveByCvode(const Problem& problem, double tolerance);
// With the tightest.
inline constexpr double kReferenceTolerance = 1e-12;
[[nodiscard]] Motion SolveReference(const Problem& problem);

// RMS over the vertices of how far they are apart, m.
[[nodiscard]] double FindDistance(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b);

}  // namespace wobble::bench
