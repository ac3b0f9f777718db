// Implicit Euler: stability far beyond the explicit limits, and its linear solver against a dense one.
#include "server/physics/methods/implicit_euler.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "server/physics/methods/step_limits.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"
#include "tests/physics/lone_system.h"

namespace wobble::physics {
namespace {

TEST(ImplicitEuler, IsStableAtAHundredTimesTheExplicitLimit) {
  BallDefinition small = MakeMeasuredBall(0);
  small.subdivisions = 1;
  for (const Blueprint& blueprint : {MakeBall(small), MakeBall(MakeMeasuredBall(0.1)), MakeLattice(MakeJellyCube(0))}) {
    const double omega = blueprint.angularFrequency / 1.05;
    const double h = 100 * FindLargestStep(Integrator::kSemiImplicitEuler, omega * omega, 0);
    LoneSystem<double> implicit(blueprint, Integrator::kImplicitEuler);
    const std::vector<Vector3d> zero(blueprint.rest.size(), Vector3d::Zero());
    implicit.Start(Deform(blueprint.rest, 0.02), zero);
    implicit.Run(1000, h);
    for (std::size_t i = 0; i < zero.size(); ++i) {
      ASSERT_LT((implicit.x[i] - implicit.x[0]).norm(), 4 * blueprint.reach);
      ASSERT_LT(implicit.v[i].norm(), 1e-3) << "comes to rest";
    }
    LoneSystem<double> direct(blueprint, Integrator::kSemiImplicitEuler);
    direct.Start(Deform(blueprint.rest, 0.02), zero);
    direct.Run(1000, h / 50);
    EXPECT_FALSE(direct.v[0].norm() < 1) << "which twice the explicit limit does not";
  }
}

// The same step by a dense matrix, made from the formulas alone: springs, gas, a contact and a fixed vertex.
TEST(ImplicitEuler, SolvesWhatADenseSolverSolves) {
  BallDefinition definition = MakeMeasuredBall(0.3);
  definition.subdivisions = 1;
  const Blueprint ball = MakeBall(definition);
  LoneSystem<double> system(ball, Integrator::kImplicitEuler);
  system.load.acceleration = Vector3d(0.3, 0, -9.81);
  system.load.gasFactor = 1.3;
  system.load.stiffnessFactor = 1.7;
  system.blueprint.full.inverseMasses[5] = 0;
  std::vector<Vector3d> start = Deform(ball.rest, 0.03);
  std::vector<Vector3d> velocity(start.size(), Vector3d(0.2, -0.1, 0.4));
  velocity = Deform(velocity, 0.5);
  velocity[5].setZero();
  std::size_t lowest = 0;
  for (std::size_t i = 0; i < start.size(); ++i) lowest = start[i].z() < start[lowest].z() ? i : lowest;
  velocity[lowest].z() = -0.3;
  Obstacle plane;
  plane.offset = start[lowest].z() + 0.004;
  system.surfaces = {MakeSurface<double>(plane, Vector3d::Zero())};
  system.contacts = {{0, static_cast<std::uint32_t>(lowest)}};
  system.Start(start, velocity);

  constexpr double kStep = 1.0 / 60;
  const Coefficients<double>& body = system.blueprint.full;
  const auto size = static_cast<Eigen::Index>(3 * start.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd damping = Eigen::MatrixXd::Zero(size, size);
  const auto add = [](Eigen::MatrixXd& to, std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
    to.block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)) += block;
  };
  for (const Spring<double>& spring : body.springs) {
    const Vector3d l = start[spring.a] - start[spring.b];
    const Eigen::Matrix3d along = l * l.transpose() / l.squaredNorm();
    const double across = std::max(0.0, 1 - spring.restLength / l.norm());
    const Eigen::Matrix3d k = 1.7 * spring.stiffness * (along + across * (Eigen::Matrix3d::Identity() - along));
    const Eigen::Matrix3d c = 1.7 * spring.damping * along;
    for (const auto& [a, b, sign] : {std::tuple{spring.a, spring.a, 1},
                                     {spring.b, spring.b, 1},
                                     {spring.a, spring.b, -1},
                                     {spring.b, spring.a, -1}}) {
      add(stiffness, a, b, sign * k);
      add(damping, a, b, sign * c);
    }
  }
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  const double volume = ComputeVolume<double>(body.faces, start);
  for (std::size_t i = 0; i < start.size(); ++i) {  // by differences of the volume, which is linear in each coordinate
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vector3d> moved = start;
      moved[i][axis] += 0.01;
      gradient[static_cast<Eigen::Index>(3 * i) + axis] = (ComputeVolume<double>(body.faces, moved) - volume) / 0.01;
    }
  }
  stiffness += 1.3 * body.gas / (volume * volume) * gradient * gradient.transpose();
  const ContactStiffness<double> contact = FindContactStiffness<double>(
      body.contact, body.contactShares, system.surfaces, system.contacts[0], start, velocity);
  EXPECT_GT(contact.stiffness, 0);
  const Eigen::Matrix3d up = contact.normal * contact.normal.transpose();
  add(stiffness, lowest, lowest, contact.stiffness * up + contact.stickStiffness * (Eigen::Matrix3d::Identity() - up));
  add(damping, lowest, lowest, contact.damping * up + contact.stickDamping * (Eigen::Matrix3d::Identity() - up));

  std::vector<Vector3d> a(start.size());
  system.Accelerate(start, velocity, a, true);
  Eigen::MatrixXd matrix = kStep * kStep * stiffness + kStep * damping;
  Eigen::VectorXd v(size);
  Eigen::VectorXd force(size);
  for (std::size_t i = 0; i < start.size(); ++i) {
    add(matrix, i, i, body.masses[i] * Eigen::Matrix3d::Identity());
    v.segment<3>(static_cast<Eigen::Index>(3 * i)) = velocity[i];
    force.segment<3>(static_cast<Eigen::Index>(3 * i)) = body.masses[i] * a[i];
  }
  Eigen::VectorXd right = kStep * (force - kStep * stiffness * v);
  for (Eigen::Index row = 15; row < 18; ++row) {  // of vertex 5
    matrix.row(row).setZero();
    matrix.col(row).setZero();
    matrix(row, row) = 1;
    right[row] = 0;
  }
  const Eigen::VectorXd change = matrix.fullPivLu().solve(right);

  system.Run(1, kStep);
  for (std::size_t i = 0; i < start.size(); ++i) {
    const Vector3d expected = velocity[i] + change.segment<3>(static_cast<Eigen::Index>(3 * i));
    EXPECT_LT((system.v[i] - expected).norm(), 1e-10) << "vertex " << i;
    EXPECT_LT((system.x[i] - start[i] - kStep * expected).norm(), 1e-10) << "vertex " << i;
  }
  EXPECT_EQ(system.x[5], start[5]) << "fixed";
}

}  // namespace
}  // namespace wobble::physics
