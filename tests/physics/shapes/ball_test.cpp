#include <gtest/gtest.h>

#include <numbers>

#include "server/physics/methods/stability.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

class BallSize : public testing::TestWithParam<int> {};

TEST_P(BallSize, IsAClosedSphereOfTheSizeAsked) {
  const Icosphere sphere = MakeIcosphere(GetParam());
  EXPECT_EQ(sphere.vertices.size(), CountVertices(GetParam()));
  EXPECT_EQ(sphere.faces.size(), 20U << (2 * GetParam()));
  // By Euler's formula V − E + F = 2 every edge is listed once.
  EXPECT_EQ(sphere.vertices.size() + sphere.faces.size(), sphere.edges.size() + 2);
  const double volume = ComputeVolume<double>(sphere.faces, sphere.vertices);
  EXPECT_GT(volume, 0) << "faces look outward";
  EXPECT_LT(volume, 4.0 / 3 * std::numbers::pi);
}
INSTANTIATE_TEST_SUITE_P(Subdivisions, BallSize, testing::Range(0, 6));

// The icosahedron of circumradius 1: a³ · 5 (3 + √5)/12 with edge a = 1/sin(2π/5).
TEST(Ball, VolumeOfAnIcosahedronIsExact) {
  const Icosphere sphere = MakeIcosphere(0);
  const double edge = 1 / std::sin(2 * std::numbers::pi / 5);
  const double exact = edge * edge * edge * 5 * (3 + std::sqrt(5.0)) / 12;
  EXPECT_NEAR(ComputeVolume<double>(sphere.faces, sphere.vertices), exact, 1e-12);
}

TEST(Ball, VolumeDoesNotDependOnPlaceOrIsNegatedByTurningFaces) {
  Icosphere sphere = MakeIcosphere(2);
  const double volume = ComputeVolume<double>(sphere.faces, sphere.vertices);
  for (Vector3d& x : sphere.vertices) x += Vector3d(100, -50, 30);
  EXPECT_NEAR(ComputeVolume<double>(sphere.faces, sphere.vertices), volume, 1e-10);
  for (Face& face : sphere.faces) std::swap(face[1], face[2]);
  EXPECT_NEAR(ComputeVolume<double>(sphere.faces, sphere.vertices), -volume, 1e-10);
}

TEST(Ball, RestsInEquilibriumAtItsRadius) {
  for (const int subdivisions : {0, 1, 2, 3}) {
    BallDefinition definition;
    definition.subdivisions = subdivisions;
    definition.material.stiffness = subdivisions == 0 ? 300 : 150;
    definition.material.gas = 150;
    ASSERT_TRUE(ValidateBall(definition).empty());
    const Blueprint ball = MakeBall(definition);
    std::vector<Vector3d> a(ball.rest.size());
    const std::vector<Vector3d> v(ball.rest.size(), Vector3d::Zero());
    ComputeAccelerations<double>(ball.full, Load<double>{}, {}, {}, ball.rest, v, a);
    double worst = 0;
    for (const Vector3d& value : a) worst = std::max(worst, value.norm());
    EXPECT_LT(worst, 1e-3) << "m/s² left over at " << subdivisions << " subdivisions";
    EXPECT_NEAR(ball.size, definition.radius, 0.02 * definition.radius);
  }
}

// In equilibrium the virial of the springs balances 3 (P − P₀) V.
TEST(Ball, PressureBalancesTheSpringsAsLaplaceSays) {
  const Blueprint ball = MakeBall(MakeMeasuredBall());
  double springs = 0;
  for (const Spring<double>& spring : ball.full.springs) {
    const double length = (ball.rest[spring.a] - ball.rest[spring.b]).norm();
    springs += spring.stiffness * (length - spring.restLength) * length;
  }
  EXPECT_NEAR(3 * ball.full.gas, springs, 1e-6 * springs);  // P V = nRT
}

TEST(Ball, FrequencyIsThatMeasuredBefore) {
  BallDefinition definition = MakeMeasuredBall();
  definition.material.gas = 300;
  EXPECT_NEAR(MakeBall(definition).angularFrequency / 1.05, 132, 2);
}

// Dashpots do not change a body at rest.
TEST(Ball, DampingDoesNotMoveTheRestShape) {
  BallDefinition definition;
  definition.subdivisions = 1;
  definition.material.dampingRatio = 0;
  const Blueprint undamped = MakeBall(definition);
  for (const double dampingRatio : {0.2, 0.6, 1.0, 2.0}) {
    definition.material.dampingRatio = dampingRatio;
    EXPECT_EQ(MakeBall(definition).rest, undamped.rest) << "damping ratio " << dampingRatio;
  }
}

TEST(Ball, ValidateNamesFieldValueAndRange) {
  BallDefinition definition;
  definition.material.mass = -1;
  definition.material.restitution = 1.5;
  definition.subdivisions = 9;
  const std::vector<FieldError> errors = ValidateBall(definition);
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0].field, "subdivisions");
  EXPECT_EQ(errors[1].field, "mass");
  EXPECT_EQ(errors[1].value, "-1.0");
  EXPECT_EQ(errors[1].range, "0.001 to 1000000 kg");
  EXPECT_EQ(errors[2].field, "restitution");
}

TEST(Ball, ValidateRefusesGasThatSpringsCannotHoldAndStiffnessThatTicksCannotFollow) {
  BallDefinition bursting;
  bursting.material.gas = 1e5;
  ASSERT_EQ(ValidateBall(bursting).size(), 1U);
  EXPECT_EQ(ValidateBall(bursting)[0].field, "gas");
  BallDefinition rigid;
  rigid.material.stiffness = 1e7;
  ASSERT_EQ(ValidateBall(rigid).size(), 1U);
  EXPECT_EQ(ValidateBall(rigid)[0].field, "stiffness");
}

TEST(Ball, AmbientPressureWithGasGivesTheGaugePressure) {
  BallDefinition definition;
  definition.material.ambientPressure = 101325;
  const double volume = 4.0 / 3 * std::numbers::pi * 0.125;
  definition.material.gas = (101325 + 300) * volume;  // about 300 Pa above ambient
  definition.material.stiffness = 400;
  const auto errors = ValidateBall(definition);
  EXPECT_TRUE(errors.empty() || errors[0].field == "gas");
  definition.material.gas = 1000;  // far too little: it would be crushed
  ASSERT_EQ(ValidateBall(definition).size(), 1U);
  EXPECT_NE(ValidateBall(definition)[0].range.find("crushed"), std::string::npos);
}

}  // namespace
}  // namespace wobble::physics
