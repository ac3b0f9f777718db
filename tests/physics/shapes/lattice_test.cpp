// Lattices as material: Young's modulus and Poisson's ratio from a pull, isotropy from the springs of one cell, density
// from the frequency of a bar.
#include "server/physics/shapes/lattice.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

LatticeDefinition MakeDefinition(const std::array<int, 3>& cells) {
  LatticeDefinition definition;
  definition.cells = cells;
  return definition;
}

std::vector<std::size_t> FindVertices(const Blueprint& blueprint, int axis, double at) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < blueprint.rest.size(); ++i) {
    if (std::fabs(blueprint.rest[i][axis] - at) < 1e-9) found.push_back(i);
  }
  return found;
}

double FindMean(const std::vector<std::size_t>& vertices, const std::vector<Vector3d>& x, int axis) {
  double sum = 0;
  for (const std::size_t i : vertices) sum += x[i][axis];
  return sum / static_cast<double>(vertices.size());
}

// Pulls the two ends along z with `tension`, Pa, shared among their vertices evenly or by the area that belongs to
// each, and returns the shape at rest, which damped motion finds.
std::vector<Vector3d> Pull(const Blueprint& blueprint, double tension, double area, bool evenly) {
  std::vector<Vector3d> pull(blueprint.rest.size(), Vector3d::Zero());
  for (const double side : {-1.0, 1.0}) {
    double top = 0;
    for (const Vector3d& x : blueprint.rest) top = std::max(top, x.z());
    const auto end = FindVertices(blueprint, 2, side * top);
    double whole = 0;  // the masses on an end are proportional to the areas
    for (const std::size_t i : end) whole += evenly ? 1 : blueprint.full.masses[i];
    for (const std::size_t i : end) {
      pull[i].z() = side * tension * area * (evenly ? 1 : blueprint.full.masses[i]) / whole;
    }
  }
  std::vector<Vector3d> x = blueprint.rest;
  std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  std::vector<Vector3d> a(x.size());
  const double step = 1 / blueprint.angularFrequency;
  for (int iteration = 0; iteration < 20000; ++iteration) {
    ComputeAccelerations<double>(blueprint.full, Load<double>{}, {}, {}, x, v, a);
    double fastest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      a[i] += pull[i] * blueprint.full.inverseMasses[i];
      v[i] = 0.98 * v[i] + step * a[i];
      x[i] += step * v[i];
      fastest = std::max({fastest, v[i].norm(), a[i].norm() * step});
    }
    if (fastest < 1e-12) break;
  }
  return x;
}

struct Moduli {
  double young = 0;
  double poisson = 0;
};

// From the stretch between the planes z = ±`half` and the narrowing of the plane z = `middle`.
Moduli Measure(const Blueprint& blueprint, const std::vector<Vector3d>& x, double tension, double half, double middle) {
  const auto strain = [&](const std::vector<std::size_t>& high, const std::vector<std::size_t>& low, int axis) {
    const double rest = FindMean(high, blueprint.rest, axis) - FindMean(low, blueprint.rest, axis);
    return (FindMean(high, x, axis) - FindMean(low, x, axis)) / rest - 1;
  };
  const double along = strain(FindVertices(blueprint, 2, half), FindVertices(blueprint, 2, -half), 2);
  std::vector<std::size_t> left;
  std::vector<std::size_t> right;
  for (const std::size_t i : FindVertices(blueprint, 2, middle)) {
    if (blueprint.rest[i].x() < -1e-9) left.push_back(i);
    if (blueprint.rest[i].x() > 1e-9) right.push_back(i);
  }
  return {tension / along, -strain(right, left, 0) / along};
}

class LatticePull : public testing::TestWithParam<std::array<int, 3>> {};

// Under an even tension every cell, at the corner or deep inside, must stretch alike. This is why shares are used.
TEST_P(LatticePull, HasYoungsModulusAndPoissonsRatioWhateverItsCells) {
  const LatticeDefinition definition = MakeDefinition(GetParam());
  const Blueprint lattice = MakeLattice(definition);
  const double a = definition.cellSize;
  const double tension = 1e-4 * definition.youngModulus;
  const std::vector<Vector3d> x = Pull(lattice, tension, a * a * GetParam()[0] * GetParam()[1], false);
  const double end = GetParam()[2] * a / 2;
  const Moduli moduli = Measure(lattice, x, tension, end, end);
  EXPECT_NEAR(moduli.young, definition.youngModulus, 0.005 * definition.youngModulus);
  EXPECT_NEAR(moduli.poisson, 0.25, 0.005 * 0.25);
}
INSTANTIATE_TEST_SUITE_P(Cells, LatticePull,
                         testing::Values(std::array{1, 1, 1}, std::array{2, 2, 2}, std::array{3, 3, 3},
                                         std::array{5, 5, 5}, std::array{2, 3, 7}, std::array{1, 1, 6}));

// A bar that is pulled evenly by the vertices of its ends, not by areas, stretches evenly far from them (Saint-Venant).
TEST(Lattice, PulledBarHasYoungsModulusInItsMiddle) {
  const LatticeDefinition definition = MakeDefinition({3, 3, 12});
  const Blueprint bar = MakeLattice(definition);
  const double a = definition.cellSize;
  const double tension = 1e-4 * definition.youngModulus;
  const std::vector<Vector3d> x = Pull(bar, tension, 9 * a * a, true);
  const Moduli moduli = Measure(bar, x, tension, 2 * a, 0);
  EXPECT_NEAR(moduli.young, definition.youngModulus, 0.01 * definition.youngModulus);
  EXPECT_NEAR(moduli.poisson, 0.25, 0.01 * 0.25);
}

// C_ijkl = (1/V) Σ k l² nᵢ nⱼ nₖ nₗ over all springs of the body.
double FindElasticity(const Blueprint& blueprint, const std::array<int, 4>& indices) {
  double sum = 0;
  for (const Spring<double>& spring : blueprint.full.springs) {
    const Vector3d l = blueprint.rest[spring.a] - blueprint.rest[spring.b];
    double product = spring.stiffness * l.squaredNorm();
    for (const int i : indices) product *= l.normalized()[i];
    sum += product;
  }
  return sum / blueprint.restVolume;
}

TEST(Lattice, SpringsAreIsotropicInAnyBox) {
  for (const auto& cells : {std::array{1, 1, 1}, std::array{4, 2, 3}}) {
    const LatticeDefinition definition = MakeDefinition(cells);
    const Blueprint lattice = MakeLattice(definition);
    const double c11 = FindElasticity(lattice, {0, 0, 0, 0});
    const double c12 = FindElasticity(lattice, {0, 0, 1, 1});
    const double c44 = FindElasticity(lattice, {1, 2, 1, 2});
    const double unit = definition.youngModulus / 2.5;  // k/a
    EXPECT_NEAR(c11, 3 * unit, 1e-9 * unit);
    EXPECT_NEAR(c12, unit, 1e-9 * unit);
    EXPECT_NEAR(c44, unit, 1e-9 * unit);
    for (const int axis : {1, 2}) EXPECT_NEAR(FindElasticity(lattice, {axis, axis, axis, axis}), c11, 1e-9 * unit);
    EXPECT_NEAR(FindElasticity(lattice, {0, 0, 0, 1}), 0, 1e-9 * unit);
  }
}

// Without the tensor: a strain in any direction, with or without shear, costs the ½ ε·C ε of an isotropic material.
TEST(Lattice, StretchingItCostsTheSameInAnyDirection) {
  const LatticeDefinition definition = MakeDefinition({3, 3, 3});
  const Blueprint lattice = MakeLattice(definition);
  constexpr double kStrain = 1e-4;
  const double exact = 0.5 * 3 * definition.youngModulus / 2.5 * kStrain * kStrain * lattice.restVolume;
  for (const Vector3d& direction :
       {Vector3d(0, 0, 1), Vector3d(1, 1, 0), Vector3d(1, 1, 1), Vector3d(3, -1, 2), Vector3d(0.2, 5, 1)}) {
    const Vector3d n = direction.normalized();
    std::vector<Vector3d> x = lattice.rest;
    for (Vector3d& at : x) at += kStrain * n.dot(at) * n;
    EXPECT_NEAR(ComputeSpringEnergy(lattice.full, x), exact, 1e-3 * exact) << direction.transpose();
  }
}

TEST(Lattice, WeighsWhatItsVolumeDoesAndRestsInItsMiddle) {
  const LatticeDefinition definition = MakeDefinition({4, 2, 3});
  const Blueprint lattice = MakeLattice(definition);
  const double a = definition.cellSize;
  const double volume = 24 * a * a * a;
  ASSERT_EQ(lattice.rest.size(), CountVertices(definition.cells));
  EXPECT_EQ(lattice.rest.size(), 60U);
  EXPECT_NEAR(lattice.restVolume, volume, 1e-12);
  EXPECT_NEAR(lattice.totalMass, definition.density * volume, 1e-12);
  EXPECT_NEAR(lattice.reach, 0.5 * a * std::sqrt(16 + 4 + 9), 1e-12);
  EXPECT_EQ(lattice.full.gas, 0);
  const std::vector<Vector3d> v(lattice.rest.size(), Vector3d::Zero());
  std::vector<Vector3d> accelerations(lattice.rest.size());
  ComputeAccelerations<double>(lattice.full, Load<double>{}, {}, {}, lattice.rest, v, accelerations);
  for (const Vector3d& value : accelerations) EXPECT_LT(value.norm(), 1e-9);
}

TEST(Lattice, SurfaceIsClosedAndLooksOutward) {
  const Blueprint lattice = MakeLattice(MakeDefinition({4, 2, 3}));
  EXPECT_EQ(lattice.full.faces.size(), 2U * 2 * (4 * 2 + 2 * 3 + 4 * 3));
  std::map<std::array<std::uint16_t, 2>, int> sides;  // in the direction in which the face walks them
  for (const Face& face : lattice.full.faces) {
    const Vector3d& p = lattice.rest[face[0]];
    const Vector3d normal = (lattice.rest[face[1]] - p).cross(lattice.rest[face[2]] - p);
    EXPECT_GT(normal.dot(p), 0);
    EXPECT_NEAR(normal.norm(), 0.25 * 0.25, 1e-12) << "half a cell's square";
    for (std::size_t side = 0; side < 3; ++side) ++sides[{face[side], face[(side + 1) % 3]}];
  }
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(sides.count({side[1], side[0]}), 1U) << "and once the other way round, by the face beyond";
  }
}

// A bar that is let go after a pull along its first mode rings at c/2L, c = √(E/ρ). By RK4, without damping.
TEST(Lattice, BarRingsAtTheSpeedOfSoundOverTwiceItsLength) {
  LatticeDefinition definition = MakeDefinition({1, 1, 16});
  definition.dampingRatio = 0;
  const Blueprint bar = MakeLattice(definition);
  const double length = 16 * definition.cellSize;
  const double period = 2 * length / std::sqrt(definition.youngModulus / definition.density);
  std::vector<Vector3d> x = bar.rest;
  std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  for (Vector3d& at : x) {
    const double phase = std::numbers::pi * at.z() / length;
    const Vector3d sideways(-0.25 * at.x(), -0.25 * at.y(), 0);
    at += 1e-4 * (Vector3d(0, 0, length / std::numbers::pi * std::sin(phase)) + std::cos(phase) * sideways);
  }
  const auto top = FindVertices(bar, 2, length / 2);
  const double rest = length / 2;
  StageBuffers<double, 4> buffers;
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    ComputeAccelerations<double>(bar.full, Load<double>{}, {}, {}, at, speed, a);
  };
  // Measures from one upward passage through the rest length to the fourth after it.
  constexpr double h = 1.0 / 1000;
  std::vector<double> passages;
  double last = 1;
  for (int step = 1; passages.size() < 5 && step < 20000; ++step) {
    StepRungeKutta<double>(kClassicRungeKutta, h, accelerate, std::span(x), std::span(v), buffers);
    const double now = FindMean(top, x, 2) - rest;
    if (last < 0 && now >= 0) passages.push_back(h * (step - now / (now - last)));
    last = now;
  }
  ASSERT_EQ(passages.size(), 5U);
  EXPECT_NEAR((passages[4] - passages[0]) / 4, period, 0.01 * period);
}

// Lattices hit the ground with a side, an edge, a corner and askew, as after a fall of 3 m, and are not left folded.
TEST(Lattice, SpringsBackFromAHit) {
  const LatticeDefinition definition = MakeJellyCube(0.1);
  const Blueprint cube = MakeLattice(definition);
  const double speed = 0.35 * std::sqrt(definition.youngModulus / definition.density);
  for (const Vector3d& towards : {Vector3d(0, 0, 1), Vector3d(1, 0, 1), Vector3d(1, 1, 1), Vector3d(1, 0.3, 2)}) {
    Obstacle wall;
    wall.normal = towards.normalized();
    World world({Vector3d::Zero(), 1.0 / 60, Precision::kSingle, 1});
    world.AddBlueprint(cube);
    world.AddObstacle(wall);
    const BodyId id = world.AddBody(0, (cube.reach + 0.01) * wall.normal, -speed * wall.normal);
    for (int tick = 0; tick < 480; ++tick) world.Step();
    std::vector<Vector3d> x(cube.rest.size());
    VisitVertices(world.ReadBody(id), [&](std::size_t i, const Vector3d& at) { x[i] = at; });
    EXPECT_GT(world.FindCentre(world.ReadBody(id)).dot(wall.normal), 1) << "has bounced off";
    EXPECT_NEAR(ComputeVolume<double>(cube.full.faces, x), cube.restVolume, 0.02 * cube.restVolume);
    EXPECT_LT(ComputeSpringEnergy(cube.full, x), 0.01 * 0.5 * cube.totalMass * speed * speed)
        << towards.transpose() << ": springs are left tense";
  }
}

TEST(Lattice, ValidateNamesFieldValueAndRange) {
  LatticeDefinition definition;
  definition.cells = {3, 3, 0};
  definition.poissonRatio = 0.3;
  definition.density = -2;
  const std::vector<FieldError> errors = ValidateLattice(definition);
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0].field, "cells");
  EXPECT_EQ(errors[0].value, "[3, 3, 0]");
  EXPECT_EQ(errors[0].range, "three whole numbers from 1 to 100, or the second 0: a planar lattice");
  EXPECT_EQ(errors[1].field, "poisson_ratio");
  EXPECT_EQ(errors[1].value, "0.3");
  EXPECT_EQ(errors[1].range, "0.25: a lattice of central springs has no other in 3-D");
  EXPECT_EQ(errors[2].field, "density");
  EXPECT_TRUE(ValidateLattice(LatticeDefinition{}).empty());
}

TEST(Lattice, ValidateRefusesMoreVerticesThanThereMayBeAndStiffnessThatTicksCannotFollow) {
  const auto tooMany = ValidateLattice(MakeDefinition({30, 30, 30}));
  ASSERT_EQ(tooMany.size(), 1U);
  EXPECT_EQ(tooMany[0].range, "fewer: 29791 vertices; at most 10000");
  LatticeDefinition rigid;
  rigid.youngModulus = 1e9;
  ASSERT_EQ(ValidateLattice(rigid).size(), 1U);
  EXPECT_EQ(ValidateLattice(rigid)[0].field, "young_modulus");
}

// No body of many cells is stiffer for its mass than its cells by themselves, which share nothing: 20 k/m of a cell.
TEST(Lattice, IsNoFasterThanOneCell) {
  for (const auto& cells : {std::array{1, 1, 1}, std::array{2, 2, 2}, std::array{5, 3, 4}}) {
    const LatticeDefinition definition = MakeDefinition(cells);
    const double a = definition.cellSize;
    const double cell = std::sqrt(20 * definition.youngModulus * a / 2.5 / (definition.density * a * a * a));
    EXPECT_LE(MakeLattice(definition).angularFrequency, 1.0501 * cell);
    EXPECT_GE(MakeLattice(definition).angularFrequency, 0.7 * cell);
  }
}

}  // namespace
}  // namespace wobble::physics
