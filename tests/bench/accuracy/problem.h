// The problems whose solutions are known closely enough to measure errors by.
//
// Only well-posed ones. A ball stretched by 20 % and left to vibrate for 10 s without damping is not: two solutions in
// double precision, each right to twelve digits a step, end 87 % of a radius apart, because neighbouring motions part
// exponentially. Hence as large for a short while, as long with a small stretch, or as both with damping.
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

// A ball of 162 vertices, 20 % longer along z and thinner across, for 0.25 s without damping: the one that methods are
// compared on.
[[nodiscard]] Problem MakeStretchedBall();
// All of them, that one first.
[[nodiscard]] std::vector<Problem> MakeProblems();

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
