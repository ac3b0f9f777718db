// Planar lattices as material: Young's modulus and Poisson's ratio from a pull, and that they stay in the plane.
#include <gtest/gtest.h>

#include "server/physics/shapes/material.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

LatticeDefinition MakeDefinition(int cellsX, int cellsZ) {
  LatticeDefinition definition;
  definition.cells = {cellsX, 0, cellsZ};
  definition.poissonRatio = FindPoissonRatio(definition.cells);
  return definition;
}

// The mean place along `axis` of the vertices that are at the largest (sign 1) or least one of `order` at rest.
double FindEnd(const Blueprint& lattice, const std::vector<Vector3d>& x, int order, double sign, int axis) {
  double end = 0;
  for (const Vector3d& at : lattice.rest) end = std::max(end, std::fabs(at[order]));
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::fabs(lattice.rest[i][order] - sign * end) > 1e-9) continue;
    sum += x[i][axis];
    ++count;
  }
  return sum / count;
}

// Pulls both ends along z with `tension`, Pa, shared by the width that belongs to each vertex, and returns the shape at
// rest.
std::vector<Vector3d> Pull(const Blueprint& lattice, double tension, double width) {
  double half = 0;
  for (const Vector3d& at : lattice.rest) half = std::max(half, at.z());
  double whole = 0;
  for (std::size_t i = 0; i < lattice.rest.size(); ++i) {
    if (lattice.rest[i].z() > half - 1e-9) whole += lattice.full.masses[i];
  }
  std::vector<VertexForce<double>> pushes;
  for (std::size_t i = 0; i < lattice.rest.size(); ++i) {
    const double z = lattice.rest[i].z();
    if (std::fabs(z) < half - 1e-9) continue;
    const double force = tension * width * lattice.full.masses[i] / whole;
    pushes.push_back({static_cast<std::uint16_t>(i), Vector3d(0, 0, z > 0 ? force : -force)});
  }
  Load<double> load;
  load.pushes = pushes;
  std::vector<Vector3d> x = lattice.rest;
  std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  std::vector<Vector3d> a(x.size());
  const double step = 1 / lattice.angularFrequency;
  for (int iteration = 0; iteration < 20000; ++iteration) {
    ComputeAccelerations<double>(lattice.full, load, {}, {}, x, v, a);
    double fastest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      v[i] = 0.98 * v[i] + step * a[i];
      x[i] += step * v[i];
      fastest = std::max({fastest, v[i].norm(), a[i].norm() * step});
    }
    if (fastest < 1e-12) break;
  }
  return x;
}

class PlanarPull : public testing::TestWithParam<std::array<int, 2>> {};

TEST_P(PlanarPull, HasYoungsModulusAndPoissonsRatioWhateverItsCells) {
  const auto& [cellsX, cellsZ] = GetParam();
  const LatticeDefinition definition = MakeDefinition(cellsX, cellsZ);
  ASSERT_TRUE(ValidateLattice(definition).empty());
  const Blueprint lattice = MakeLattice(definition);
  const double width = cellsX * definition.cellSize;
  const double tension = 1e-4 * definition.youngModulus;
  const std::vector<Vector3d> x = Pull(lattice, tension, width);
  const auto strain = [&](int axis) {
    const auto extent = [&](const std::vector<Vector3d>& at) {
      return FindEnd(lattice, at, axis, 1, axis) - FindEnd(lattice, at, axis, -1, axis);
    };
    return extent(x) / extent(lattice.rest) - 1;
  };
  EXPECT_NEAR(tension / strain(2), definition.youngModulus, 0.005 * definition.youngModulus);
  EXPECT_NEAR(-strain(0) / strain(2), 1.0 / 3, 0.005 / 3);
  for (const Vector3d& at : x) EXPECT_EQ(at.y(), 0);
}
INSTANTIATE_TEST_SUITE_P(Cells, PlanarPull,
                         testing::Values(std::array{1, 1}, std::array{2, 2}, std::array{3, 12}, std::array{5, 4}));

TEST(PlanarLattice, WeighsWhatItsAreaDoesAndHasFacesAllOverIt) {
  const LatticeDefinition definition = MakeDefinition(4, 3);
  const Blueprint lattice = MakeLattice(definition);
  const double area = 12 * definition.cellSize * definition.cellSize;
  EXPECT_EQ(lattice.rest.size(), CountVertices(definition.cells));
  EXPECT_NEAR(lattice.totalMass, definition.density * area, 1e-12);
  ASSERT_EQ(lattice.full.faces.size(), 24U);
  double faces = 0;
  for (const auto& [a, b, c] : lattice.full.faces) {
    const Vector3d normal = (lattice.rest[b] - lattice.rest[a]).cross(lattice.rest[c] - lattice.rest[a]);
    EXPECT_LT(normal.y(), 0);
    faces += normal.norm() / 2;
  }
  EXPECT_NEAR(faces, area, 1e-12);
  // Only the border touches anything: its vertices carry half a cell each, corners a quarter.
  const auto corner =
      static_cast<std::size_t>(std::ranges::min_element(lattice.full.masses) - lattice.full.masses.begin());
  EXPECT_DOUBLE_EQ(lattice.full.contactShares[corner], 0.5);
  EXPECT_DOUBLE_EQ(*std::ranges::max_element(lattice.full.contactShares), 1);
}

TEST(PlanarLattice, FallsOnAFloorBouncesAndStaysInItsPlane) {
  Blueprint lattice = MakeLattice(MakeDefinition(3, 3));
  World world{WorldSettings{}};
  world.AddBlueprint(lattice);
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0.1, 3, 1.2), Vector3d(0.3, 5, 0));
  Control control;
  control.moveY = 1;
  world.SetControl(id, control, ControlLimits{});
  for (int tick = 0; tick < 600; ++tick) {
    const StepReport report = world.Step();
    ASSERT_EQ(report.nonFinite + report.inverted, 0U);
  }
  VisitVertices(world.ReadBody(id), [](std::size_t, const Vector3d& at) { EXPECT_EQ(at.y(), 3); });
  EXPECT_NEAR(world.FindCentre(world.ReadBody(id)).z(), 0.375, 0.02);
}

TEST(PlanarLattice, ASideThatIsFixedStaysWhereItIs) {
  for (const auto& cells : {std::array{2, 0, 6}, std::array{2, 2, 6}}) {
    LatticeDefinition definition;
    definition.cells = cells;
    definition.poissonRatio = FindPoissonRatio(cells);
    definition.dampingRatio = 0.5;
    definition.fixed = Side::kHighZ;
    ASSERT_TRUE(ValidateLattice(definition).empty());
    const Blueprint bar = MakeLattice(definition);
    ASSERT_EQ(bar.full.fixed.size(), CountVertices({cells[0], cells[1], 0}));
    World world{WorldSettings{}};
    world.AddBlueprint(bar);
    const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
    for (int tick = 0; tick < 900; ++tick) world.Step();
    double lowest = 10;
    VisitVertices(world.ReadBody(id), [&](std::size_t i, const Vector3d& at) {
      if (bar.full.inverseMasses[i] == 0) {
        EXPECT_LT((at - Vector3d(0, 0, 5) - bar.rest[i]).norm(), 1e-6);
      }
      lowest = std::min(lowest, at.z());
    });
    // A bar under its own weight lengthens by ρ g L²/2E.
    const double length = 6 * definition.cellSize;
    const double stretch = definition.density * 9.81 * length * length / (2 * definition.youngModulus);
    EXPECT_NEAR(5 - length / 2 - lowest, stretch, 0.1 * stretch);
  }
}

TEST(PlanarLattice, RepulsionLeavesTheRestShapeAndStiffens) {
  LatticeDefinition definition = MakeDefinition(3, 3);
  definition.repulsion = 0.5;
  ASSERT_TRUE(ValidateLattice(definition).empty());
  const Blueprint lattice = MakeLattice(definition);
  const std::vector<Vector3d> v(lattice.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> a(lattice.rest.size());
  ComputeAccelerations<double>(lattice.full, Load<double>{}, {}, {}, lattice.rest, v, a);
  for (const Vector3d& value : a) EXPECT_LT(value.norm(), 1e-9);
  EXPECT_GT(lattice.angularFrequency, MakeLattice(MakeDefinition(3, 3)).angularFrequency);
  definition.repulsion = 1000;
  ASSERT_FALSE(ValidateLattice(definition).empty());
  EXPECT_EQ(ValidateLattice(definition)[0].field, "repulsion");
}

}  // namespace
}  // namespace wobble::physics
