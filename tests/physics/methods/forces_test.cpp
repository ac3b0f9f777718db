// Every conservative force is the gradient of its energy, by central differences.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "server/physics/model/state.h"
#include "server/physics/shapes/finish_blueprint.h"
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
  for (const double height : {1.0, 0.05, -1.0}) {  // whole, nearly flat, mirrored
    std::vector<Vector3d> x = Deform(ball.rest, 0.1);
    for (Vector3d& at : x) at.z() *= height;
    std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
    AddGas<double>(ball.full, 1, x, forces);
    ExpectGradient(
        x, forces, [&](auto at) { return ComputeGasEnergy(ball.full, at); }, 1e-5);
  }
}

// A ring of springs round a gas, in the plane.
Blueprint MakePlanarRing(int points) {
  Blueprint ring;
  Coefficients<double>& full = ring.full;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    ring.rest.emplace_back(std::cos(angle), 0, std::sin(angle));
    full.masses.push_back(0.5 + 0.1 * (i % 3));
    const auto a = static_cast<std::uint16_t>(i);
    const auto b = static_cast<std::uint16_t>((i + 1) % points);
    full.outline.push_back({a, b});
    full.springs.push_back({a, b, 0.2, 300, 2});
  }
  full.planar = true;
  full.gas = 200;
  full.ambientPressure = 15;
  FinishBlueprint(ring);
  return ring;
}

TEST(Forces, GasInAPlaneIsTheGradientOfItsEnergy) {
  const Blueprint ring = MakePlanarRing(14);
  EXPECT_NEAR(ring.restVolume, 7 * std::sin(2 * std::numbers::pi / 14), 1e-12) << "area of a regular polygon";
  std::vector<Vector3d> x = Deform(ring.rest, 0.05);
  for (Vector3d& at : x) at.y() = 0;
  std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
  AddGas<double>(ring.full, 1, x, forces);
  ExpectGradient(
      x, forces, [&](auto at) { return ComputeGasEnergy(ring.full, at); }, 1e-5);
  Vector3d sum = Vector3d::Zero();
  double torque = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += forces[i];
    torque += x[i].cross(forces[i]).y();
    EXPECT_GT(forces[i].dot(x[i]), 0) << "outward";
  }
  EXPECT_LT(sum.norm(), 1e-10);
  EXPECT_LT(std::fabs(torque), 1e-10);
}

TEST(Forces, AreaDoesNotDependOnPlaceAndIsNegatedInsideOut) {
  const Blueprint ring = MakePlanarRing(9);
  const double area = ComputeArea<double>(ring.full.outline, ring.rest);
  std::vector<Vector3d> x = ring.rest;
  for (Vector3d& at : x) at += Vector3d(200, 3, -70);
  EXPECT_NEAR(ComputeArea<double>(ring.full.outline, x), area, 1e-10);
  EXPECT_FALSE(IsInsideOut<double>(ring.full, x));
  for (Vector3d& at : x) at.x() = -at.x();
  EXPECT_NEAR(ComputeArea<double>(ring.full.outline, x), -area, 1e-10);
  EXPECT_TRUE(IsInsideOut<double>(ring.full, x));
}

TEST(Forces, OnlyWhatHoldsGasCanBeInsideOut) {
  const Blueprint ball = MakeBall(MakeMeasuredBall());
  std::vector<Vector3d> x = ball.rest;
  EXPECT_FALSE(IsInsideOut<double>(ball.full, x));
  for (Vector3d& at : x) at.z() = -at.z();
  EXPECT_TRUE(IsInsideOut<double>(ball.full, x));
  Coefficients<double> skin = ball.full;
  skin.gas = 0;
  EXPECT_FALSE(IsInsideOut<double>(skin, x));
}

TEST(Forces, RepulsionIsTheGradientOfItsEnergyAlsoBelowItsFloor) {
  Blueprint cube = MakeLattice(MakeJellyCube());
  cube.full.repulsion = 0.02;
  std::vector<Vector3d> x = Deform(cube.rest, 0.02);
  x[1] = x[0] + 0.2 * (x[1] - x[0]);  // nearer than half of the rest length
  std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
  AddRepulsion<double>(cube.full.springs, cube.full.repulsion, x, forces);
  ExpectGradient(
      x, forces, [&](auto at) { return ComputeRepulsionEnergy(cube.full, at); }, 1e-4);
  // Between two lone vertices the force is K_r/d⁴.
  const Spring<double> spring{0, 1, 1, 0, 0};
  const std::vector<Vector3d> two{Vector3d::Zero(), Vector3d(2, 0, 0)};
  std::vector<Vector3d> apart(2, Vector3d::Zero());
  AddRepulsion<double>(std::span(&spring, 1), 8.0, two, apart);
  EXPECT_LT((apart[1] - Vector3d(0.5, 0, 0)).norm(), 1e-15);
  EXPECT_LT((apart[0] + apart[1]).norm(), 1e-15);
}

// A plate of 2 m² across a wind of 3 m/s: ½ρC A u².
TEST(Forces, DragGoesWithTheSquareOfTheSpeedThroughAFaceFromBothSides) {
  const std::vector<Vector3d> x{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  const std::vector<Face> faces{{0, 1, 2}};
  const auto sum = [&](const Vector3d& wind, const Vector3d& velocity) {
    std::vector<Vector3d> forces(3, Vector3d::Zero());
    AddDrag<double>(faces, 0.6, wind, x, std::vector<Vector3d>(3, velocity), forces);
    for (const Vector3d& force : forces) EXPECT_LT((force - forces[0]).norm(), 1e-12) << "a third to each";
    return Vector3d(forces[0] + forces[1] + forces[2]);
  };
  const Vector3d none = Vector3d::Zero();
  EXPECT_LT((sum({0, 0, 3}, none) - Vector3d(0, 0, 0.6 * 2 * 9)).norm(), 1e-12);
  EXPECT_LT((sum({0, 0, -3}, none) + Vector3d(0, 0, 0.6 * 2 * 9)).norm(), 1e-12);
  EXPECT_LT((sum({5, -7, 3}, none) - sum({0, 0, 3}, none)).norm(), 1e-12) << "along the face: none";
  EXPECT_LT((sum(none, {1, 2, -3}) - sum({0, 0, 3}, none)).norm(), 1e-12) << "only the relative speed counts";
}

TEST(Forces, TornSpringsPullNoMore) {
  Blueprint cube = MakeLattice(MakeJellyCube(0.1));
  cube.full.repulsion = 0.01;
  const std::vector<Vector3d> x = Deform(cube.rest, 0.02);
  const std::vector<Vector3d> v = Deform(std::vector<Vector3d>(x.size(), Vector3d::Zero()), 1);
  std::vector<std::uint8_t> torn(cube.full.springs.size(), 0);
  Coefficients<double> without = cube.full;
  without.springs.clear();
  for (std::size_t i = 0; i < torn.size(); ++i) {
    torn[i] = i % 3 == 0 ? 1 : 0;
    if (torn[i] == 0) without.springs.push_back(cube.full.springs[i]);
  }
  Load<double> load;
  std::vector<Vector3d> expected(x.size());
  std::vector<Vector3d> forces(x.size());
  ComputeForces<double>(without, load, {}, {}, x, v, expected);
  load.torn = torn;
  ComputeForces<double>(cube.full, load, {}, {}, x, v, forces);
  EXPECT_EQ(forces, expected);
}

TEST(Forces, PushesActOnTheirVertices) {
  const Blueprint cube = MakeLattice(MakeJellyCube());
  const std::vector<VertexForce<double>> pushes{{3, {1, 2, 3}}, {5, {0, -1, 0}}, {3, {1, 0, 0}}};
  Load<double> load;
  load.pushes = pushes;
  const std::vector<Vector3d> v(cube.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> forces(cube.rest.size());
  ComputeForces<double>(cube.full, load, {}, {}, cube.rest, v, forces);
  EXPECT_LT((forces[3] - Vector3d(2, 2, 3)).norm(), 1e-9);
  EXPECT_LT((forces[5] - Vector3d(0, -1, 0)).norm(), 1e-9);
}

TEST(Forces, NothingMovesAFixedVertexOrAPlanarBodyOutOfItsPlane) {
  Blueprint ring = MakePlanarRing(8);
  ring.full.fixed = {2, 5};
  FinishBlueprint(ring);
  EXPECT_GT(ring.angularFrequency, 0);
  Load<double> load;
  load.acceleration = {1, 2, -9.81};
  const std::vector<VertexForce<double>> pushes{{2, {100, 0, 0}}, {0, {0, 50, 0}}};
  load.pushes = pushes;
  const std::vector<Vector3d> x = Deform(ring.rest, 0.05);
  const std::vector<Vector3d> v = Deform(std::vector<Vector3d>(x.size(), Vector3d::Zero()), 1);
  std::vector<Vector3d> a(x.size());
  ComputeAccelerations<double>(ring.full, load, {}, {}, x, v, a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].y(), 0);
    EXPECT_EQ(a[i].isZero(0), i == 2 || i == 5) << i;
  }
  const State<float> state = MakeState<float>(ring, Vector3d::Zero(), Vector3d(3, 4, 5));
  EXPECT_EQ(state.velocities[0], Vector3f(3, 0, 5));
  EXPECT_EQ(state.velocities[2], Vector3f::Zero());
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

TEST(Forces, PressureGoesOnAlongItsTangentBelowTheFloorAndIsConstantBelowZero) {
  const double floor = 0.1;
  EXPECT_DOUBLE_EQ(ComputePressure(5.0, floor, floor), 5.0 / floor);
  const double slopeAbove = (ComputePressure(5.0, floor + 1e-7, floor) - 5.0 / floor) / 1e-7;
  const double slopeBelow = (5.0 / floor - ComputePressure(5.0, floor - 1e-7, floor)) / 1e-7;
  EXPECT_NEAR(slopeAbove / slopeBelow, 1, 1e-4);
  EXPECT_LE(ComputePressure(5.0, 0.0, floor), 2 * 5.0 / floor) << "finite when crushed flat";
  EXPECT_DOUBLE_EQ(ComputePressure(5.0, -1.0, floor), ComputePressure(5.0, 0.0, floor));
}

TEST(Forces, DashpotsTakeEnergyFromStretchingOnly) {
  const Blueprint ball = MakeBall(MakeMeasuredBall(0.1));
  std::vector<Vector3d> forces(ball.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> still(ball.rest.size(), Vector3d::Zero());
  AddSprings<double>(ball.full.springs, 1, ball.rest, still, forces);
  // A rigid rotation stretches nothing, so it adds no forces.
  std::vector<Vector3d> turning;
  for (const Vector3d& x : ball.rest) turning.push_back(Vector3d(0.3, -1, 2).cross(x));
  std::vector<Vector3d> turned(ball.rest.size(), Vector3d::Zero());
  AddSprings<double>(ball.full.springs, 1, ball.rest, turning, turned);
  for (std::size_t i = 0; i < forces.size(); ++i) ASSERT_LT((forces[i] - turned[i]).norm(), 1e-10);
  // Dashpots resist growth.
  const std::vector<Vector3d>& growing = ball.rest;
  std::vector<Vector3d> grown(ball.rest.size(), Vector3d::Zero());
  AddSprings<double>(ball.full.springs, 1, ball.rest, growing, grown);
  double power = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) power += (grown[i] - forces[i]).dot(growing[i]);
  EXPECT_LT(power, 0);
}

void ExpectFloatAgreesWithDouble(const Blueprint& body, double scale) {
  const std::vector<Vector3d> x = Deform(body.rest, 0.05);
  const std::vector<Vector3d> v = Deform(std::vector<Vector3d>(x.size(), Vector3d::Zero()), 1);
  Load<double> load;
  load.wind = {3, -2, 1};
  Load<float> loadSingle;
  loadSingle.wind = load.wind.cast<float>();
  std::vector<Vector3f> xSingle;
  std::vector<Vector3f> vSingle;
  for (const Vector3d& value : x) xSingle.push_back(value.cast<float>());
  for (const Vector3d& value : v) vSingle.push_back(value.cast<float>());
  std::vector<Vector3d> a(x.size());
  std::vector<Vector3f> aSingle(x.size());
  ComputeAccelerations<double>(body.full, load, {}, {}, x, v, a);
  ComputeAccelerations<float>(body.single, loadSingle, {}, {}, xSingle, vSingle, aSingle);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_LT((a[i] - aSingle[i].cast<double>()).norm(), 1e-5 * scale);
}

TEST(Forces, FloatAgreesWithDouble) {
  Blueprint ball = MakeBall(MakeMeasuredBall(0.05));
  ball.full.drag = 0.6;
  ball.full.repulsion = 0.02;
  FinishBlueprint(ball);
  ExpectFloatAgreesWithDouble(ball, 3000);
  ExpectFloatAgreesWithDouble(MakePlanarRing(12), 1000);
}

}  // namespace
}  // namespace wobble::physics
