// Equilibria in closed form. They test forces only, no integrator: both force implementations are followed downhill
// with friction until nothing accelerates.
//
//   Hanging chain: each spring bears the weight below it, and is longer by that weight over its stiffness.
//   Icosahedron of springs around a gas: all edges ℓ are equal. Balanced forces have no virial,
//     3 P V = Σ T ℓ   →   3 nRT = 30 k (ℓ − r) ℓ,   for any volume (P₀ = 0).
//     The same balance holds for any shell of springs around a gas; a ball of 162 vertices must keep it.
//   Ring of p springs in a plane: 2 P A = Σ T ℓ   →   2 nRT = p k (ℓ − r) ℓ, Laplace's law of a polygon.
//   Lattice bar under tension: a spring on the border has the stiffness of its share of the cells, so that all cells
//     are alike and stretch alike, by λ along the bar and μ across it. With W the energy of a cell's springs and F the
//     force on its end, ∂W/∂λ = F a and ∂W/∂μ = 0: two equations, solved by Newton's method for strains of any size.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <Eigen/LU>

#include "server/physics/methods/forces.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/ring.h"
#include "tests/bench/accuracy/equations.h"
#include "tests/bench/accuracy/exact.h"

namespace wobble::bench {
namespace {

using namespace physics;
using Places = std::vector<Vector3d>;
using Accelerate = std::function<void(std::span<const Vector3d> x, std::span<const Vector3d> v, std::span<Vector3d> a)>;

// The friction suits the slowest modes of these bodies, the step the fastest.
Places Settle(const Blueprint& blueprint, const Accelerate& accelerate) {
  constexpr int kSteps = 6000;
  constexpr double kKept = 0.95;  // of the velocity, per step
  Places x = blueprint.rest;
  Places v(x.size(), Vector3d::Zero());
  Places a(x.size());
  const Places still = v;
  const double step = 1 / blueprint.angularFrequency;
  for (int i = 0; i < kSteps; ++i) {
    accelerate(x, still, a);
    for (std::size_t j = 0; j < x.size(); ++j) {
      v[j] = kKept * v[j] + step * a[j];
      x[j] += step * v[j];
    }
  }
  return x;
}

struct Shapes {
  Places engine;
  Places reference;
};

Shapes SettleBoth(const Blueprint& blueprint, const Vector3d& gravity,
                  const std::vector<VertexForce<double>>& pulls = {}) {
  Load<double> load;
  load.acceleration = gravity;
  load.pushes = pulls;
  Equations equations;
  equations.blueprint = &blueprint;
  equations.gravity = gravity;
  equations.pulls = pulls;
  return {Settle(blueprint,
                 [&](auto x, auto v, auto a) { ComputeAccelerations<double>(blueprint.full, load, {}, {}, x, v, a); }),
          Settle(blueprint, [&](auto x, auto v, auto a) { FindAccelerations(equations, x, v, a); })};
}

double FindLength(const Places& x, std::size_t a, std::size_t b) { return (x[a] - x[b]).norm(); }

std::vector<ExactValue> SolveChain() {
  constexpr int kLinks = 10;
  constexpr double kGravity = 9.81;
  GraphDefinition chain;
  double below = 0;  // mass under the first spring, kg
  for (int i = 0; i <= kLinks; ++i) {
    const double mass = 0.1 + 0.02 * i;
    chain.particles.push_back({Vector3d(0, 0, -0.1 * i), mass, i == 0});
    if (i == 0) continue;
    below += mass;
    chain.springs.push_back({i - 1, i, 100.0 + 10 * i, 1, 0});
  }
  const Shapes shapes = SettleBoth(MakeGraph(chain), Vector3d(0, 0, -kGravity));
  const double topmost = 0.1 + below * kGravity / chain.springs[0].stiffness;
  double length = 0;
  for (int i = 0; i < kLinks; ++i) {
    length += 0.1 + below * kGravity / chain.springs[i].stiffness;
    below -= chain.particles[i + 1].mass;
  }
  const auto add = [&](const char* quantity, double exact, int to) {
    return ExactValue{
        "hanging chain", quantity, exact, FindLength(shapes.engine, 0, to), FindLength(shapes.reference, 0, to), exact};
  };
  return {add("topmost spring, m", topmost, 1), add("whole length, m", length, kLinks)};
}

// Multiplies the gas of a finished blueprint.
Blueprint Inflate(Blueprint blueprint, double factor) {
  blueprint.full.gas *= factor;
  FinishBlueprint(blueprint);
  return blueprint;
}

// ℓ from c nRT = n k (ℓ − r) ℓ.
double FindEdge(const Coefficients<double>& body, double dimensions) {
  const Spring<double>& spring = body.springs[0];
  const double squared = dimensions * body.gas / (static_cast<double>(body.springs.size()) * spring.stiffness);
  return spring.restLength / 2 + std::sqrt(spring.restLength * spring.restLength / 4 + squared);
}

ExactValue SolveShellOfEqualEdges(const char* name, const Blueprint& shell, double dimensions) {
  const Shapes shapes = SettleBoth(shell, Vector3d::Zero());
  const Spring<double>& spring = shell.full.springs[0];
  const double exact = FindEdge(shell.full, dimensions);
  return {.problem = name,
          .quantity = "edge, m",
          .exact = exact,
          .engine = FindLength(shapes.engine, spring.a, spring.b),
          .reference = FindLength(shapes.reference, spring.a, spring.b),
          .scale = exact};
}

ExactValue SolveBall() {
  BallDefinition ball;
  ball.material.gas = 100;
  const Blueprint shell = Inflate(MakeBall(ball), 2.5);
  const Shapes shapes = SettleBoth(shell, Vector3d::Zero());
  const auto findVirial = [&](const Places& x) {
    double sum = 0;
    for (const Spring<double>& spring : shell.full.springs) {
      const double length = FindLength(x, spring.a, spring.b);
      sum += spring.stiffness * (length - spring.restLength) * length;
    }
    return sum;
  };
  const double exact = 3 * shell.full.gas;
  return {.problem = "ball of 162 under pressure",
          .quantity = "virial of its springs, J",
          .exact = exact,
          .engine = findVirial(shapes.engine),
          .reference = findVirial(shapes.reference),
          .scale = exact};
}

// A bar along x, pulled at both ends by `force` on the end of each cell.
struct PulledBar {
  LatticeDefinition definition;
  Blueprint blueprint;
  std::vector<VertexForce<double>> pulls;
  double force = 0;  // N
};

PulledBar MakePulledBar(double force) {
  PulledBar bar;
  bar.definition.cells = {8, 2, 2};
  bar.definition.cellSize = 0.1;
  bar.blueprint = MakeLattice(bar.definition);
  bar.force = force;
  const auto [columns, rows, layers] = bar.definition.cells;
  const auto findShare = [](int at, int last) { return at == 0 || at == last ? 0.5 : 1.0; };
  for (int z = 0; z <= layers; ++z) {
    for (int y = 0; y <= rows; ++y) {
      const double share = findShare(y, rows) * findShare(z, layers);
      const int first = (z * (rows + 1) + y) * (columns + 1);
      bar.pulls.push_back({static_cast<std::uint16_t>(first), Vector3d(-force * share, 0, 0)});
      bar.pulls.push_back({static_cast<std::uint16_t>(first + columns), Vector3d(force * share, 0, 0)});
    }
  }
  return bar;
}

// Gradient of a cell's energy over (λ, μ, μ), about K a²: the stiffnesses of lattice.cpp for edges, face diagonals and
// body diagonals, each direction once, those with −1 in it as well.
Eigen::Vector2d FindCellGradient(const Eigen::Vector2d& stretch) {
  constexpr double kShares[] = {1.25, 0.75, 0.1875};
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  for (int i = 1; i < 8; ++i) {  // bits: along x, y, z
    const double along = i & 1;
    const double across = ((i >> 1) & 1) + ((i >> 2) & 1);
    const double squares = along + across;
    const double alike = squares == 1 ? 1 : squares == 2 ? 2 : 4;
    const double length = std::sqrt(along * stretch[0] * stretch[0] + across * stretch[1] * stretch[1]);
    const double slope = alike * kShares[static_cast<int>(squares) - 1] * (1 - std::sqrt(squares) / length);
    gradient += slope * Eigen::Vector2d(along * stretch[0], across * stretch[1]);
  }
  return gradient;
}

// λ under a pull of `load` = F/(K a).
double FindStretch(double load) {
  Eigen::Vector2d stretch = Eigen::Vector2d::Ones();
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d excess = FindCellGradient(stretch) - Eigen::Vector2d(load, 0);
    Eigen::Matrix2d slope;
    constexpr double kStep = 1e-5;
    for (int j = 0; j < 2; ++j) {
      const Eigen::Vector2d moved = kStep * Eigen::Vector2d::Unit(j);
      slope.col(j) = (FindCellGradient(stretch + moved) - FindCellGradient(stretch - moved)) / (2 * kStep);
    }
    stretch -= slope.inverse() * excess;
  }
  return stretch[0];
}

struct BarLengths {
  double rest = 0;
  double exact = 0;
  double engine = 0;
  double reference = 0;
};

BarLengths PullBar(const PulledBar& bar) {
  const LatticeDefinition& d = bar.definition;
  const Shapes shapes = SettleBoth(bar.blueprint, Vector3d::Zero(), bar.pulls);
  const double stiffness = d.youngModulus * d.cellSize / 2.5;  // K
  const auto last = static_cast<std::size_t>(d.cells[0]);
  const double rest = d.cells[0] * d.cellSize;
  return {rest, rest * FindStretch(bar.force / (stiffness * d.cellSize)), FindLength(shapes.engine, 0, last),
          FindLength(shapes.reference, 0, last)};
}

}  // namespace

std::vector<ExactValue> SolveExactEquilibria() {
  std::vector<ExactValue> values = SolveChain();
  BallDefinition icosahedron;
  icosahedron.subdivisions = 0;
  icosahedron.material.gas = 40;
  values.push_back(SolveShellOfEqualEdges("icosahedron under pressure", Inflate(MakeBall(icosahedron), 2.5), 3));
  RingDefinition ring;
  values.push_back(SolveShellOfEqualEdges("ring under pressure", Inflate(MakeRing(ring), 2.5), 2));
  values.push_back(SolveBall());
  const BarLengths lengths = PullBar(MakePulledBar(10));
  values.push_back({"lattice bar under tension", "length, m", lengths.exact, lengths.engine, lengths.reference,
                    lengths.exact - lengths.rest});
  return values;
}

ExactValue MeasureYoungModulus() {
  const PulledBar bar = MakePulledBar(1);  // a strain of 1 %
  const LatticeDefinition& d = bar.definition;
  const BarLengths lengths = PullBar(bar);
  const auto findModulus = [&](double length) {
    return bar.force / (d.cellSize * d.cellSize) / (length / lengths.rest - 1);
  };
  return {.problem = "lattice bar under tension",
          .quantity = "Young's modulus, Pa",
          .exact = d.youngModulus,
          .engine = findModulus(lengths.engine),
          .reference = findModulus(lengths.reference),
          .scale = d.youngModulus};
}

}  // namespace wobble::bench
