// The reference: SUNDIALS' CVODE with the variable-order Adams–Moulton methods and functional iteration. No problem is
// stiff at this accuracy, which keeps the steps far below the stability limit; order 12 with about two evaluations per
// step is then the cheapest choice, and needs no Jacobian.
//
// The state is all positions, then all velocities, so that the equations read CVODE's memory directly.
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tests/bench/accuracy/problem.h"

namespace wobble::bench {
namespace {

constexpr long kMaxSteps = 100'000'000;
// Absolute tolerance as a share of the relative one, in m and m/s: coordinates that pass through zero then need no more
// digits.
constexpr double kAbsoluteShare = 0.01;

static_assert(sizeof(Vector3d) == 3 * sizeof(realtype));

// Ends the process: nothing can be measured against a reference that failed.
void Require(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "wobble_lab: the reference cannot be solved: %s failed\n", what);
  std::exit(1);
}

std::span<Vector3d> ReadVectors(N_Vector vector) {
  return {reinterpret_cast<Vector3d*>(N_VGetArrayPointer(vector)), static_cast<std::size_t>(N_VGetLength(vector)) / 3};
}

int FindRate(realtype, N_Vector state, N_Vector rate, void* data) {
  const auto& equations = *static_cast<const Equations*>(data);
  const std::size_t count = equations.CountVertices();
  const std::span<Vector3d> y = ReadVectors(state);
  const std::span<Vector3d> f = ReadVectors(rate);
  std::ranges::copy(y.subspan(count), f.begin());
  FindAccelerations(equations, y.first(count), y.subspan(count), f.subspan(count));
  return 0;
}

// CVODE's objects, created and destroyed in the order that CVODE requires.
struct Solver {
  Solver(const Problem& problem, double tolerance);
  ~Solver();
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  Equations equations;
  SUNContext context = nullptr;
  N_Vector state = nullptr;
  SUNNonlinearSolver iteration = nullptr;
  void* memory = nullptr;
};

Solver::Solver(const Problem& problem, double tolerance) : equations(problem.equations) {
  const std::size_t count = problem.x.size();
  Require(SUNContext_Create(nullptr, &context) == 0, "SUNContext_Create");
  state = N_VNew_Serial(static_cast<sunindextype>(6 * count), context);
  Require(state != nullptr, "N_VNew_Serial");
  std::ranges::copy(problem.x, ReadVectors(state).begin());
  std::ranges::copy(problem.v, ReadVectors(state).subspan(count).begin());
  memory = CVodeCreate(CV_ADAMS, context);
  Require(memory != nullptr, "CVodeCreate");
  Require(CVodeInit(memory, &FindRate, 0, state) == CV_SUCCESS, "CVodeInit");
  Require(CVodeSetUserData(memory, &equations) == CV_SUCCESS, "CVodeSetUserData");
  Require(CVodeSStolerances(memory, tolerance, kAbsoluteShare * tolerance) == CV_SUCCESS, "CVodeSStolerances");
  Require(CVodeSetMaxNumSteps(memory, kMaxSteps) == CV_SUCCESS, "CVodeSetMaxNumSteps");
  iteration = SUNNonlinSol_FixedPoint(state, 0, context);
  Require(iteration != nullptr, "SUNNonlinSol_FixedPoint");
  Require(CVodeSetNonlinearSolver(memory, iteration) == CV_SUCCESS, "CVodeSetNonlinearSolver");
  // Stop exactly at the end: the motion is not interpolated.
  Require(CVodeSetStopTime(memory, problem.duration) == CV_SUCCESS, "CVodeSetStopTime");
}

Solver::~Solver() {
  CVodeFree(&memory);
  SUNNonlinSolFree(iteration);
  N_VDestroy(state);
  SUNContext_Free(&context);
}

}  // namespace

Solution SolveByCvode(const Problem& problem, double tolerance) {
  Solver solver(problem, tolerance);
  realtype reached = 0;
  const int code = CVode(solver.memory, problem.duration, solver.state, &reached, CV_NORMAL);
  Require(code == CV_SUCCESS || code == CV_TSTOP_RETURN, "CVode");
  Solution solution;
  Require(CVodeGetNumSteps(solver.memory, &solution.steps) == CV_SUCCESS, "CVodeGetNumSteps");
  Require(CVodeGetNumRhsEvals(solver.memory, &solution.evaluations) == CV_SUCCESS, "CVodeGetNumRhsEvals");
  const std::span<const Vector3d> y = ReadVectors(solver.state);
  const auto half = y.begin() + static_cast<std::ptrdiff_t>(problem.x.size());
  solution.motion = {{y.begin(), half}, {half, y.end()}};
  return solution;
}

Motion SolveReference(const Problem& problem) { return SolveByCvode(problem, kReferenceTolerance).motion; }

}  // namespace wobble::bench
