// The order of convergence of each method. Each solves the stretched ball, undamped and with dashpots in its springs,
// with step counts that double; the order is the slope of the least-squares line through the logarithms of error over
// step.
//
// The step counts lie where that line is straight: the coarsest step is well within the stability limit and higher
// powers of it no longer matter; the finest error is well above that of the reference and of rounding. Double precision
// and no contact, because a contact has a kink in its second derivative.
//
// The two Verlet methods evaluate dashpots with a velocity that is half a step old (explicit_steps.h), which costs them
// one order: 2 without damping, 1 with it. Position Verlet solves other equations: its springs are rods. The ball
// begins with spring lengths that rods cannot have; the first step restores them, with a kick that is harder the
// shorter the step, so the error in its row grows. On the problem that the method is meant for, a weight on a rod, it
// has order 1.
#include <cmath>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/pair.h"
#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kDampingRatio = 0.2;  // of each spring between its two masses
constexpr int kDoublings = 3;          // one fewer in a quick run

struct OrderCase {
  const Problem* problem = nullptr;
  const Motion* exact = nullptr;
  Integrator integrator = Integrator::kRungeKutta4;
  double theory = 0;           // theoretical order; 0: none here
  std::int64_t steps = 0;      // of the coarsest solution
  std::vector<double> errors;  // of positions, over the body's size, at steps·2ⁱ
};

Problem AddDamping(const Problem& undamped) {
  Problem damped = undamped;
  auto blueprint = std::make_shared<Blueprint>(*undamped.blueprint);
  const std::vector<double>& masses = blueprint->full.masses;
  for (Spring<double>& spring : blueprint->full.springs) {
    const double mass = masses[spring.a] * masses[spring.b] / (masses[spring.a] + masses[spring.b]);
    spring.damping = kDampingRatio * 2 * std::sqrt(spring.stiffness * mass);
  }
  FinishBlueprint(*blueprint);
  damped.name += ", damped";
  damped.equations.blueprint = blueprint.get();
  damped.blueprint = std::move(blueprint);
  damped.isConservative = false;
  return damped;
}

constexpr double kRodLength = 1;     // m
constexpr double kSwing = 0.5;       // s
constexpr double kFirstAngle = 0.5;  // initial angle from the vertical, rad
constexpr double kPendulumGravity = 9.81;

// A weight on a stiff spring from a fixed point, released from the side.
Problem MakeRodPendulum() {
  Problem pendulum;
  pendulum.name = "weight on a rod, 0.5 s";
  auto blueprint = std::make_shared<Blueprint>(
      MakePair({.length = kRodLength, .direction = Vector3d(0, 0, -1), .firstIsFixed = true}));
  pendulum.equations.blueprint = blueprint.get();
  pendulum.equations.gravity = Vector3d(0, 0, -kPendulumGravity);
  pendulum.blueprint = std::move(blueprint);
  pendulum.x = {Vector3d::Zero(), kRodLength * Vector3d(std::sin(kFirstAngle), 0, -std::cos(kFirstAngle))};
  pendulum.v = {Vector3d::Zero(), Vector3d::Zero()};
  pendulum.duration = kSwing;
  return pendulum;
}

// θ'' = −g/l sin θ.
Motion SolvePendulum() {
  constexpr int kSteps = 10000;
  std::vector<Vector3d> angle{Vector3d(kFirstAngle, 0, 0)};
  std::vector<Vector3d> rate{Vector3d::Zero()};
  StageBuffers<double, 4> buffers;
  const auto swing = [](auto at, auto, std::span<Vector3d> a) {
    a[0] = Vector3d(-kPendulumGravity / kRodLength * std::sin(at[0].x()), 0, 0);
  };
  for (int i = 0; i < kSteps; ++i) {
    StepRungeKutta<double>(kClassicRungeKutta, kSwing / kSteps, swing, std::span(angle), std::span(rate), buffers);
  }
  const double end = angle[0].x();
  return {{Vector3d::Zero(), kRodLength * Vector3d(std::sin(end), 0, -std::cos(end))}, {}};
}

double FindOrder(Integrator integrator, bool isDamped) {
  switch (integrator) {
    case Integrator::kRungeKutta4:
      return 4;
    case Integrator::kVelocityVerlet:
    case Integrator::kLeapFrog:
      return isDamped ? 1 : 2;
    case Integrator::kPositionVerlet:
      return 0;
    default:
      return 1;
  }
}

std::int64_t FindCoarsestSteps(Integrator integrator, double order) {
  if (integrator == Integrator::kImplicitEuler) return 500;  // one of its steps costs as much as ninety of the others
  return order > 3 ? 200 : order > 1 ? 500 : 1000;
}

// Slope of the least-squares line through log error over log step; NaN where a solution blew up.
double FindSlope(const std::vector<double>& errors) {
  const double middle = (static_cast<double>(errors.size()) - 1) / 2;
  double product = 0;
  double square = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double finer = static_cast<double>(i) - middle;  // log₂ of steps
    product += finer * std::log2(errors[i]);
    square += finer * finer;
  }
  return -product / square;
}

void AddOrderRow(Bench& bench, const OrderCase& each) {
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < each.errors.size(); ++i) steps.push_back(each.steps << i);
  const double order = FindSlope(each.errors);
  bench.results.rows.push_back({{"experiment", "order"},
                                {"problem", each.problem->name},
                                {"integrator", FindName(each.integrator)},
                                {"theory", each.theory},
                                {"order", order},
                                {"steps", std::move(steps)},
                                {"errors", each.errors}});
}

// Adds the figures of the methods that solve the equations; with damping, only where it changes the order.
void AddFigure(Bench& bench, const OrderCase& each, bool isDamped) {
  if (each.integrator == Integrator::kPositionVerlet) return;
  if (isDamped && each.theory == FindOrder(each.integrator, false)) return;
  bench.results.AddFigureWithin(std::string("order_") + FindName(each.integrator) + (isDamped ? "_damped" : ""),
                                FindSlope(each.errors), each.theory - 0.1, each.theory + 0.1);
}

}  // namespace

void MeasureOrders(Bench& bench) {
  const Problem ball = MakeStretchedBall();
  const Problem damped = AddDamping(ball);
  const Problem pendulum = MakeRodPendulum();
  std::array<Motion, 2> exact;
  if (!RunTrials(bench, 2, [&](std::size_t i) { exact[i] = SolveReference(i == 0 ? ball : damped); })) return;
  const Motion exactPendulum = SolvePendulum();

  std::vector<OrderCase> cases;
  for (const Integrator integrator : kIntegrators) {
    for (const bool isDamped : {false, true}) {
      if (bench.options.quick && isDamped && integrator == Integrator::kImplicitEuler) continue;
      const double order = FindOrder(integrator, isDamped);
      cases.push_back({isDamped ? &damped : &ball,
                       &exact[isDamped ? 1 : 0],
                       integrator,
                       order,
                       FindCoarsestSteps(integrator, order),
                       {}});
    }
  }
  cases.push_back({&pendulum, &exactPendulum, Integrator::kPositionVerlet, 1, 250, {}});
  const std::size_t count = bench.options.quick ? kDoublings : kDoublings + 1;
  for (OrderCase& each : cases) each.errors.resize(count);
  const bool done = RunTrials(bench, cases.size() * count, [&](std::size_t i) {
    OrderCase& each = cases[i / count];
    const SolvedMotion solved =
        SolveInSteps(*each.problem, {.integrator = each.integrator, .steps = each.steps << (i % count)});
    each.errors[i % count] = FindDistance(solved.end.x, each.exact->x) / each.problem->blueprint->size;
  });
  if (!done) return;
  for (const OrderCase& each : cases) {
    AddOrderRow(bench, each);
    AddFigure(bench, each, damped.name == each.problem->name);
  }
  bench.results.remarks.push_back(
      "position Verlet has no order on the ball: it treats springs as rods, which are other equations; on a rod it has "
      "order 1 (rows)");
}

}  // namespace wobble::bench
