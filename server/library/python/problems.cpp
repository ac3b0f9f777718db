// The laboratory's problems (tests/bench/accuracy), and the engine's methods in fixed steps on them.
#include <algorithm>
#include <cstring>

#include "server/library/python/binding.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/accuracy/problem.h"

namespace wobble::python {
namespace {

using bench::Problem;
using physics::Vector3d;

// 100 s of computing on the ball; nothing interrupts it.
constexpr std::int64_t kMostSteps = 10'000'000;

py::array_t<double> Copy(const std::vector<Vector3d>& vectors) {
  return CopyRows(vectors.empty() ? nullptr : vectors.front().data(), static_cast<py::ssize_t>(vectors.size()));
}

std::vector<Vector3d> ReadVectors(const char* name, const Numbers& numbers, std::size_t count) {
  CheckVectors(name, numbers, static_cast<py::ssize_t>(count));
  std::vector<Vector3d> vectors(count);
  for (std::size_t i = 0; i < count; ++i) std::copy_n(numbers.data() + 3 * i, 3, vectors[i].data());
  return vectors;
}

bench::SolvedMotion Solve(const Problem& problem, std::int64_t steps, const std::string& method, bool single) {
  const auto found =
      std::ranges::find_if(bench::kIntegrators, [&](auto each) { return method == bench::FindName(each); });
  if (found == bench::kIntegrators.end()) {
    std::string names;
    for (const auto each : bench::kIntegrators)
      names += (names.empty() ? "" : ", ") + std::string(bench::FindName(each));
    throw py::value_error("method = '" + method + "'; it must be one of " + names);
  }
  if (steps < 1 || steps > kMostSteps) {
    throw py::value_error("steps = " + std::to_string(steps) + "; it must be from 1 to " + std::to_string(kMostSteps));
  }
  const py::gil_scoped_release released;
  return SolveInSteps(problem, {.integrator = *found, .steps = steps, .isSingle = single, .isTimed = true});
}

}  // namespace

void DefineProblems(py::module_& module) {
  using bench::SolvedMotion;
  py::class_<SolvedMotion>(module, "Solution", "Where a problem's body ends, and what it took to find out.")
      .def_property_readonly(
          "positions", [](const SolvedMotion& solved) { return Copy(solved.end.x); }, "float64 (n, 3), m, world.")
      .def_property_readonly(
          "velocities", [](const SolvedMotion& solved) { return Copy(solved.end.v); }, "float64 (n, 3), m/s.")
      .def_readonly("evaluations", &SolvedMotion::evaluations, "How often the forces were computed.")
      .def_readonly("seconds", &SolvedMotion::time, "Processor time.")
      .def_readonly("blew_up", &SolvedMotion::blewUp, "It became non-finite or went beyond 1 km, and ended there.");

  py::class_<Problem>(module, "Problem", "One body with a motion that can be computed as exactly as one likes.")
      .def("__repr__", [](const Problem& problem) { return "<wobble.Problem '" + problem.name + "'>"; })
      .def_readonly("name", &Problem::name)
      .def_readonly("duration", &Problem::duration, "s.")
      .def_readonly("is_conservative", &Problem::isConservative, "Whether its energy stays the same.")
      .def_property_readonly(
          "positions", [](const Problem& problem) { return Copy(problem.x); }, "At the beginning, float64 (n, 3), m.")
      .def_property_readonly(
          "velocities", [](const Problem& problem) { return Copy(problem.v); }, "At the beginning, m/s.")
      .def("solve", &Solve, py::arg("steps"), py::kw_only(), py::arg("method") = "rk4", py::arg("single") = false,
           R"(Solves it by the engine's own method in so many equal steps, and in double precision unless single=True.

method: rk4, velocity_verlet, leap_frog, position_verlet, semi_implicit_euler, explicit_euler, implicit_euler.

>>> ball = wobble.problems()[0]
>>> exact = ball.solve(4000).positions
>>> errors = [abs(ball.solve(n).positions - exact).max() for n in (100, 200)]
>>> 14 < errors[0] / errors[1] < 18  # fourth order: half the step, a sixteenth of the error
True
)")
      .def(
          "energy",
          [](const Problem& problem, const Numbers& positions, const Numbers& velocities) {
            return FindEnergy(problem.equations, ReadVectors("positions", positions, problem.x.size()),
                              ReadVectors("velocities", velocities, problem.x.size()));
          },
          py::arg("positions"), py::arg("velocities"), "J, up to a constant.");
  module.def("problems", &bench::MakeProblems, R"(The laboratory's problems, as wobble_lab accuracy solves them.

>>> wobble.problems()[0].name
'ball, 20 % stretch, 0.25 s'
)");
}

}  // namespace wobble::python
