// Rings: balance (Laplace's law in a plane), conservation, and a fall.
#include "server/physics/shapes/ring.h"

#include <gtest/gtest.h>

#include <numbers>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

RingDefinition MakeRing2d(int points, int layers) {
  RingDefinition definition;
  definition.points = points;
  definition.layers = layers;
  definition.material.stiffness = 3000;
  return definition;
}

class RingKind : public testing::TestWithParam<std::array<int, 2>> {
 protected:
  RingDefinition definition = MakeRing2d(GetParam()[0], GetParam()[1]);
};

TEST_P(RingKind, RestsInEquilibriumAtItsRadius) {
  definition.material.ambientPressure = 20;
  ASSERT_TRUE(ValidateRing(definition).empty()) << ValidateRing(definition)[0].range;
  const Blueprint ring = MakeRing(definition);
  ASSERT_EQ(ring.rest.size(), static_cast<std::size_t>(definition.points * definition.layers));
  EXPECT_NEAR(ring.reach, definition.radius, 1e-12);
  EXPECT_NEAR(ring.totalMass, definition.material.mass, 1e-12);
  const std::vector<Vector3d> v(ring.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> a(ring.rest.size());
  ComputeAccelerations<double>(ring.full, Load<double>{}, {}, {}, ring.rest, v, a);
  for (const Vector3d& value : a) EXPECT_LT(value.norm(), 1e-9);
}

// The balance is stable: a ring that is pushed out of shape comes back to it.
TEST_P(RingKind, ComesBackToItsShape) {
  definition.material.dampingRatio = 0.5;
  const Blueprint ring = MakeRing(definition);
  std::vector<Vector3d> x = Deform(ring.rest, 0.03);
  for (Vector3d& at : x) at.y() = 0;
  std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  StageBuffers<double, 4> buffers;
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    ComputeAccelerations<double>(ring.full, Load<double>{}, {}, {}, at, speed, a);
    for (std::size_t i = 0; i < a.size(); ++i) a[i] -= 4 * speed[i];
  };
  const double h = 1 / std::max(ring.angularFrequency, ring.dampingRate);
  for (double t = 0; t < 30; t += h) {
    StepRungeKutta<double>(kClassicRungeKutta, h, accelerate, std::span(x), std::span(v), buffers);
  }
  EXPECT_NEAR(ComputeArea<double>(ring.full.outline, x), ring.restVolume, 1e-3 * ring.restVolume);
  Vector3d centre = Vector3d::Zero();
  for (const Vector3d& at : x) centre += at / static_cast<double>(x.size());
  for (std::size_t i = 0; i < static_cast<std::size_t>(definition.points); ++i) {
    EXPECT_NEAR((x[i] - centre).norm(), ring.rest[i].norm(), 0.01) << i;
  }
}

TEST_P(RingKind, KeepsMomentumAndAngularMomentum) {
  definition.material.dampingRatio = 0.05;
  const Blueprint ring = MakeRing(definition);
  std::vector<Vector3d> x = Deform(ring.rest, 0.02);
  std::vector<Vector3d> v;
  for (Vector3d& at : x) {
    at.y() = 0;
    v.push_back(Vector3d(3, 0, 1) + Vector3d(0, 1, 0).cross(at));
  }
  const auto measure = [&] {
    Vector3d momentum = Vector3d::Zero();
    double spin = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      momentum += ring.full.masses[i] * v[i];
      spin += ring.full.masses[i] * x[i].cross(v[i]).y();
    }
    return Vector3d(momentum.x(), spin, momentum.z());
  };
  const Vector3d before = measure();
  StageBuffers<double, 4> buffers;
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    ComputeAccelerations<double>(ring.full, Load<double>{}, {}, {}, at, speed, a);
  };
  for (int step = 0; step < 4800; ++step) {
    StepRungeKutta<double>(kClassicRungeKutta, 1.0 / 1920, accelerate, std::span(x), std::span(v), buffers);
  }
  const Vector3d after = measure();
  EXPECT_LT(std::fabs(after.x() - before.x()) + std::fabs(after.z() - before.z()), 1e-9 * before.norm());
  EXPECT_NEAR(after.y(), before.y(), 1e-4 * std::fabs(before.y()));
}

TEST_P(RingKind, FallsOnAFloorAndHolds) {
  ASSERT_TRUE(ValidateRing(definition).empty());
  World world{WorldSettings{}};
  world.AddBlueprint(MakeRing(definition));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 1, 2));
  for (int tick = 0; tick < 600; ++tick) {
    const StepReport report = world.Step();
    ASSERT_EQ(report.nonFinite + report.inverted, 0U) << tick;
  }
  const double height = world.FindCentre(world.ReadBody(id)).z();
  EXPECT_GT(height, 0.6 * definition.radius);
  EXPECT_LT(height, 1.1 * definition.radius);
}

TEST_P(RingKind, FacesAllLookTheSameWay) {
  const Blueprint ring = MakeRing(definition);
  const int layers = definition.layers;
  EXPECT_EQ(ring.full.faces.size(), layers == 1 ? static_cast<std::size_t>(definition.points - 2)
                                                : static_cast<std::size_t>(2 * definition.points * (layers - 1)));
  double area = 0;
  for (const auto& [a, b, c] : ring.full.faces) {
    const Vector3d normal = (ring.rest[b] - ring.rest[a]).cross(ring.rest[c] - ring.rest[a]);
    EXPECT_LT(normal.y(), 0);
    area += normal.norm() / 2;
  }
  const double whole = definition.points * definition.radius * definition.radius *
                       std::sin(2 * std::numbers::pi / definition.points) / 2;
  EXPECT_NEAR(area, layers == 1 ? whole : whole - ring.restVolume, 1e-12);
}
INSTANTIATE_TEST_SUITE_P(PointsAndLayers, RingKind,
                         testing::Values(std::array{24, 1}, std::array{40, 1}, std::array{24, 3}, std::array{33, 2}));

// A ring of many points holds P − P₀ by a tension of (P − P₀) R, whatever its material.
TEST(Ring, PressureIsTensionOverRadiusAsLaplaceSays) {
  for (const double stiffness : {1000.0, 10000.0}) {
    RingDefinition definition = MakeRing2d(96, 1);
    definition.material.stiffness = stiffness;
    definition.material.gas = 20;
    definition.material.ambientPressure = 5;
    ASSERT_TRUE(ValidateRing(definition).empty()) << ValidateRing(definition)[0].range;
    const Blueprint ring = MakeRing(definition);
    const double pressure = 20 / ring.restVolume - 5;
    for (const Spring<double>& spring : ring.full.springs) {
      const double tension =
          spring.stiffness * ((ring.rest[spring.a] - ring.rest[spring.b]).norm() - spring.restLength);
      EXPECT_NEAR(tension, pressure * definition.radius, 1e-3 * tension);
    }
  }
}

TEST(Ring, ValidateNamesFieldValueAndRange) {
  RingDefinition definition;
  EXPECT_TRUE(ValidateRing(definition).empty());
  definition.points = 2;
  definition.layers = 20;
  definition.radius = 0;
  ASSERT_EQ(ValidateRing(definition).size(), 4U);  // and no thickness fits into a radius of 0
  definition = {};
  definition.layers = 3;
  definition.thickness = 0.49;
  ASSERT_EQ(ValidateRing(definition).size(), 1U);
  EXPECT_EQ(ValidateRing(definition)[0].field, "thickness");
  definition = {};
  definition.material.gas = 0;
  ASSERT_EQ(ValidateRing(definition).size(), 1U);
  EXPECT_NE(ValidateRing(definition)[0].range.find("held open"), std::string::npos);
  definition.material.gas = 1e5;
  ASSERT_EQ(ValidateRing(definition).size(), 1U);
  EXPECT_NE(ValidateRing(definition)[0].range.find("at most"), std::string::npos);
  definition.material.gas = 10;
  definition.material.ambientPressure = 1000;
  ASSERT_EQ(ValidateRing(definition).size(), 1U);
  EXPECT_NE(ValidateRing(definition)[0].range.find("crushed"), std::string::npos);
}

}  // namespace
}  // namespace wobble::physics
