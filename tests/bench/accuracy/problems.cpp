// Each problem exercises one kind of force: a shell and its gas, dashpots, a solid, a sheet in wind, repelling
// neighbours in a plane, a surface. Sizes and materials are those of play.
//
// The sheet swings downwind at less than the wind's speed: drag, whose slope has a kink at zero, then never changes its
// sign. The ball bounces without friction, because anchors are no function of position and velocity, and so slowly that
// damping never makes the ground pull, where the law is cut off. The kinks at the surface and at δ remain.
#include "tests/bench/accuracy/problem.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/ring.h"

namespace wobble::bench {
namespace {

using namespace physics;

const Vector3d kGravity(0, 0, -9.81);  // m/s²

Problem MakeNamedProblem(const std::string& name, Blueprint blueprint, double duration) {
  Problem problem = MakeProblem(std::move(blueprint), duration);
  problem.name = name;
  return problem;
}

// Stretches along z and shrinks across so that the volume is kept.
void StretchAlongZ(std::vector<Vector3d>& x, double factor) {
  for (Vector3d& p : x) p = Vector3d(p.x() / std::sqrt(factor), p.y() / std::sqrt(factor), p.z() * factor);
}

// nRT, J: stretches the resting springs by a tenth, about as much as a stretch by 20 % shortens those across it.
constexpr double kGas = 1000;

// A ball of 162 vertices of 0.25 kg.
Problem MakeBallProblem(const std::string& name, double stretch, double dampingRatio, double duration,
                        double gas = kGas) {
  BallDefinition ball;
  ball.radius = 1;
  ball.material.mass = 0.25 * static_cast<double>(CountVertices(ball.subdivisions));
  ball.material.stiffness = 750;
  ball.material.gas = gas;
  ball.material.dampingRatio = dampingRatio;
  Problem problem = MakeNamedProblem(name, MakeBall(ball), duration);
  StretchAlongZ(problem.x, stretch);
  problem.isConservative = dampingRatio == 0;
  return problem;
}

// A beam whose tip falls by nearly a third of its length and returns three times.
Problem MakeBeam() {
  LatticeDefinition beam;
  beam.cells = {8, 2, 2};
  beam.cellSize = 0.1;
  beam.youngModulus = 1e5;
  beam.density = 100;
  beam.dampingRatio = 0;
  beam.fixed = Side::kLowX;
  Problem problem = MakeNamedProblem("beam under gravity, 2 s", MakeLattice(beam), 2);
  problem.equations.gravity = kGravity;
  problem.isConservative = true;
  return problem;
}

Problem MakeSwingingCloth() {
  ClothDefinition cloth;
  cloth.points = {12, 12};
  cloth.pinned = Pinned::kEdge;
  cloth.material.dampingRatio = 0.05;
  Problem problem = MakeNamedProblem("cloth swinging in wind, 2 s", MakeCloth(cloth), 2);
  problem.equations.gravity = kGravity;
  problem.equations.wind = Vector3d(0, 2.5, 0);
  constexpr double kAngle = 40 * std::numbers::pi / 180;  // from the vertical
  const double top = problem.x.front().z();
  for (Vector3d& p : problem.x) {
    const double down = top - p.z();
    p = Vector3d(p.x(), down * std::sin(kAngle), -down * std::cos(kAngle));
  }
  return problem;
}

Problem MakeRingProblem() {
  RingDefinition ring;
  ring.layers = 2;
  ring.material.dampingRatio = 0;
  ring.material.repulsion = 5e-4;
  Problem problem = MakeNamedProblem("ring with repulsion, 10 % stretch, 1 s", MakeRing(ring), 1);
  for (Vector3d& p : problem.x) p = Vector3d(p.x() / 1.1, 0, p.z() * 1.1);
  problem.isConservative = true;
  return problem;
}

Problem MakeBounce() {
  BallDefinition ball;
  ball.subdivisions = 1;
  ball.material.friction = 0;
  ball.material.restitution = 0.95;
  Problem problem = MakeNamedProblem("ball bouncing, 0.6 s", MakeBall(ball), 0.6);
  problem.touches = true;
  problem.equations.gravity = kGravity;
  problem.equations.obstacles = {Obstacle{}};
  double lowest = 0;
  for (const Vector3d& p : problem.x) lowest = std::min(lowest, p.z());
  for (Vector3d& p : problem.x) p.z() += 0.02 - lowest;
  for (Vector3d& v : problem.v) v.z() = -1;
  return problem;
}

}  // namespace

Problem MakeProblem(Blueprint blueprint, double duration) {
  Problem problem;
  problem.blueprint = std::make_shared<const Blueprint>(std::move(blueprint));
  problem.equations.blueprint = problem.blueprint.get();
  problem.x = problem.blueprint->rest;
  problem.v.assign(problem.x.size(), Vector3d::Zero());
  problem.duration = duration;
  return problem;
}

Problem MakeStretchedBall() { return MakeBallProblem("ball, 20 % stretch, 0.25 s", 1.2, 0, 0.25); }

Problem MakeUndampedBall() { return MakeBallProblem("ball, 20 % stretch, 10 s", 1.2, 0, 10); }

Problem MakeIllPosedBall() {
  return MakeBallProblem("ball with a quarter of the gas, 20 % stretch, 10 s", 1.2, 0, 10, kGas / 4);
}

std::vector<Problem> MakeProblems() {
  return {MakeStretchedBall(),
          MakeBallProblem("ball, 2 % stretch, 10 s", 1.02, 0, 10),
          MakeBallProblem("ball with damping, 20 % stretch, 10 s", 1.2, 0.05, 10),
          MakeBeam(),
          MakeSwingingCloth(),
          MakeRingProblem(),
          MakeBounce()};
}

double FindDistance(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace wobble::bench
