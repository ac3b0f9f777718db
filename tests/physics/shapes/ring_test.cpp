// Rings: balance (Laplace's law in a plane), conservation, and a fall.
#include "server/physics/shapes/ring.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>
#include <string>

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

// What is said of a ring with far too much gas.
std::string ValidateMessage(RingDefinition definition) {
  definition.material.gas = 1e9;
  return ValidateRing(definition).at(0).range;
}

// The most gas that a ring may have, J.
double FindMostGas(RingDefinition definition) {
  double least = 0;
  double most = 1e9;
  for (int halving = 0; halving < 60; ++halving) {
    definition.material.gas = (least + most) / 2;
    (ValidateRing(definition).empty() ? least : most) = definition.material.gas;
  }
  return least;
}

// Of the stiffness at rest, −∂F/∂x by central differences, as a multiple of the springs'. Negative: a small change of
// shape grows.
double FindLeastStiffness(const Blueprint& ring) {
  const auto size = static_cast<Eigen::Index>(2 * ring.rest.size());
  const double step = 1e-6 * ring.reach;
  Eigen::MatrixXd stiffness(size, size);
  const std::vector<Vector3d> v(ring.rest.size(), Vector3d::Zero());
  const auto findForces = [&](Eigen::Index moved, double by) {
    std::vector<Vector3d> x = ring.rest;
    x[static_cast<std::size_t>(moved / 2)][moved % 2 * 2] += by;  // x and z
    std::vector<Vector3d> a(x.size());
    ComputeAccelerations<double>(ring.full, Load<double>{}, {}, {}, x, v, a);
    Eigen::VectorXd forces(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const auto vertex = static_cast<std::size_t>(i / 2);
      forces[i] = ring.full.masses[vertex] * a[vertex][i % 2 * 2];
    }
    return forces;
  };
  for (Eigen::Index i = 0; i < size; ++i) {
    stiffness.col(i) = (findForces(i, -step) - findForces(i, step)) / (2 * step);
  }
  const Eigen::MatrixXd symmetric = (stiffness + stiffness.transpose()) / 2;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues()[0] /
         ring.full.springs[0].stiffness;
}

// Of two layers the limit is half of what they bear; of several layers it is at least stable. Without the limit, layers
// turned over within five ticks.
TEST(Ring, WithItsMostGasIsAStableBalance) {
  for (const int points : {3, 4, 7, 12, 30}) {
    for (const int layers : {2, 3, 5}) {
      for (const double thickness : {0.1, 0.4, 0.8}) {
        RingDefinition definition = MakeRing2d(points, layers);
        definition.radius = 1;
        definition.thickness = thickness;
        definition.material.gas = FindMostGas(definition);
        ASSERT_GT(definition.material.gas, 0);
        EXPECT_GT(FindLeastStiffness(MakeRing(definition)), -1e-6) << points << ' ' << layers << ' ' << thickness;
        if (layers > 2 || ValidateMessage(definition).find("turn over") == std::string::npos) continue;
        definition.material.gas *= 2.1;
        EXPECT_LT(FindLeastStiffness(MakeRing(definition)), -1e-3) << points << ' ' << thickness;
      }
    }
  }
}

TEST(Ring, WithItsMostGasHasNoLayerTurnedOverAfterAFall) {
  RingDefinition definition = MakeRing2d(6, 4);
  definition.thickness = 0.15;
  definition.material.gas = FindMostGas(definition);
  World world{WorldSettings{}};
  const Blueprint ring = MakeRing(definition);
  world.AddBlueprint(ring);
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 1));
  for (int tick = 0; tick < 300; ++tick) world.Step();
  const std::vector<Vector3d> x = ListPositions(world, id);
  for (const auto& [a, b, c] : ring.full.faces) EXPECT_LT((x[b] - x[a]).cross(x[c] - x[a]).y(), 0);
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
  EXPECT_NE(ValidateRing(definition)[0].range.find("springs would vanish"), std::string::npos);
  definition.layers = 4;
  ASSERT_EQ(ValidateRing(definition).size(), 1U);
  EXPECT_NE(ValidateRing(definition)[0].range.find("turn over"), std::string::npos);
  definition.layers = 1;
  definition.material.gas = 10;
  definition.material.ambientPressure = 1000;
  ASSERT_EQ(ValidateRing(definition).size(), 1U);
  EXPECT_NE(ValidateRing(definition)[0].range.find("crushed"), std::string::npos);
}

}  // namespace
}  // namespace wobble::physics
