// Every conservative force is the gradient of its energy, by central differences.
#include <gtest/gtest.h>

#include <functional>

#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

using Energy = std::function<double(std::span<const Vector3d>)>;

void ExpectGradient(std::vector<Vector3d> x, const std::vector<Vector3d>& forces, const Energy& energy,
                    double tolerance) {
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double at = x[i][axis];
      x[i][axis] = at + kStep;
      const double above = energy(x);
      x[i][axis] = at - kStep;
      const double below = energy(x);
      x[i][axis] = at;
      ASSERT_NEAR(forces[i][axis], -(above - below) / (2 * kStep), tolerance) << "vertex " << i << " axis " << axis;
    }
  }
}

TEST(Forces, SpringsAreTheGradientOfTheirEnergy) {
  const Blueprint ball = MakeBall(MakeMeasuredBall());
  const std::vector<Vector3d> x = Deform(ball.rest, 0.1);
  const std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
  AddSprings<double>(ball.full.springs, 1, x, v, forces);
  ExpectGradient(
      x, forces, [&](auto at) { return ComputeSpringEnergy(ball.full, at); }, 1e-5);
}

TEST(Forces, GasIsTheGradientOfItsEnergy) {
  BallDefinition definition = MakeMeasuredBall();
  definition.material.ambientPressure = 40;
  const Blueprint ball = MakeBall(definition);
  const std::vector<Vector3d> x = Deform(ball.rest, 0.1);
  std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
  AddGas<double>(ball.full, 1, x, forces);
  ExpectGradient(
      x, forces, [&](auto at) { return ComputeGasEnergy(ball.full, at); }, 1e-5);
}

TEST(Forces, PenaltyIsTheGradientOfItsEnergyAndSmooth) {
  ContactParameters<double> contact;
  contact.stiffness = 1500;
  contact.fadeDepth = 0.005;
  double work = 0;
  constexpr double kStep = 1e-6;
  for (double depth = -0.001; depth < 0.02; depth += kStep) {
    work += ComputePenalty(contact, depth + kStep / 2) * kStep;
    const double slope =
        (ComputePenalty(contact, depth + kStep) - ComputePenalty(contact, depth - kStep)) / (2 * kStep);
    ASSERT_NEAR(slope, ComputePenaltySlope(contact, depth), 0.2) << depth;
  }
  // ∫ F dd = k δ²/6 up to δ, then k (d²/2 − δd/2 + δ²/6).
  const double d = 0.02;
  const double delta = contact.fadeDepth;
  EXPECT_NEAR(work, contact.stiffness * (d * d / 2 - delta * d / 2 + delta * delta / 6), 1e-4);
}

TEST(Forces, PressureGoesOnAlongItsTangentBelowTheFloor) {
  const double floor = 0.1;
  EXPECT_DOUBLE_EQ(ComputePressure(5.0, floor, floor), 5.0 / floor);
  const double slopeAbove = (ComputePressure(5.0, floor + 1e-7, floor) - 5.0 / floor) / 1e-7;
  const double slopeBelow = (5.0 / floor - ComputePressure(5.0, floor - 1e-7, floor)) / 1e-7;
  EXPECT_NEAR(slopeAbove / slopeBelow, 1, 1e-4);
  EXPECT_LE(ComputePressure(5.0, 0.0, floor), 2 * 5.0 / floor) << "finite when crushed flat";
}

TEST(Forces, DashpotsTakeEnergyFromStretchingOnly) {
  const Blueprint ball = MakeBall(MakeMeasuredBall(0.1));
  std::vector<Vector3d> forces(ball.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> still(ball.rest.size(), Vector3d::Zero());
  AddSprings<double>(ball.full.springs, 1, ball.rest, still, forces);
  // Turning rigidly stretches nothing: the same forces.
  std::vector<Vector3d> turning;
  for (const Vector3d& x : ball.rest) turning.push_back(Vector3d(0.3, -1, 2).cross(x));
  std::vector<Vector3d> turned(ball.rest.size(), Vector3d::Zero());
  AddSprings<double>(ball.full.springs, 1, ball.rest, turning, turned);
  for (std::size_t i = 0; i < forces.size(); ++i) ASSERT_LT((forces[i] - turned[i]).norm(), 1e-10);
  // Growing is resisted.
  const std::vector<Vector3d>& growing = ball.rest;
  std::vector<Vector3d> grown(ball.rest.size(), Vector3d::Zero());
  AddSprings<double>(ball.full.springs, 1, ball.rest, growing, grown);
  double power = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) power += (grown[i] - forces[i]).dot(growing[i]);
  EXPECT_LT(power, 0);
}

TEST(Forces, FloatAgreesWithDouble) {
  const Blueprint ball = MakeBall(MakeMeasuredBall(0.05));
  const std::vector<Vector3d> x = Deform(ball.rest, 0.05);
  const std::vector<Vector3d> v = Deform(std::vector<Vector3d>(x.size(), Vector3d::Zero()), 1);
  std::vector<Vector3f> xSingle;
  std::vector<Vector3f> vSingle;
  for (const Vector3d& value : x) xSingle.push_back(value.cast<float>());
  for (const Vector3d& value : v) vSingle.push_back(value.cast<float>());
  std::vector<Vector3d> a(x.size());
  std::vector<Vector3f> aSingle(x.size());
  ComputeAccelerations<double>(ball.full, Load<double>{}, {}, {}, x, v, a);
  ComputeAccelerations<float>(ball.single, Load<float>{}, {}, {}, xSingle, vSingle, aSingle);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_LT((a[i] - aSingle[i].cast<double>()).norm(), 1e-5 * 3000);
}

}  // namespace
}  // namespace wobble::physics
