// Bodies in broken states get back to their shape by the forces of the equations alone.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "server/physics/shapes/ring.h"
#include "tests/physics/bodies.h"
#include "tests/support/broken_states.h"

namespace wobble::physics {
namespace {

void ExpectRecovered(Broken how) {
  BallDefinition coarse;
  coarse.subdivisions = 1;
  RingDefinition layered;
  layered.layers = 3;
  LatticeDefinition cuboid = MakeJellyCube();
  cuboid.cells = {4, 2, 3};
  const Blueprint blueprints[] = {MakeBall(coarse),   MakeBall({}),      MakeOblong(),
                                  MakeRing({}),       MakeRing(layered), MakeSolid(MakeSolidBox({2, 1, 1}, 0.45)),
                                  MakeLattice(cuboid)};
  for (const Blueprint& blueprint : blueprints) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      bench::Random random(seed);
      const Recovery recovery = PlayBroken(how, blueprint, random);
      EXPECT_TRUE(recovery.IsWhole()) << blueprint.rest.size() << " vertices, seed " << seed << ": shape "
                                      << recovery.shape << ", reset " << recovery.reset;
      EXPECT_LT(recovery.speed, 10) << blueprint.rest.size() << " vertices, seed " << seed;
    }
  }
}

TEST(Recovery, FromFlat) { ExpectRecovered(Broken::kFlattened); }
TEST(Recovery, FromInsideOut) { ExpectRecovered(Broken::kInsideOut); }
TEST(Recovery, FromFolded) { ExpectRecovered(Broken::kFolded); }
TEST(Recovery, FromRandomPlaces) { ExpectRecovered(Broken::kRandom); }

// At random places elements are stretched by their own length and more, and their stiffness grows with the fourth
// power: no number of substeps would hold them, and the body was put back.
TEST(Recovery, OfSolidsWhoseElementsGiveWay) {
  for (const double poissonRatio : {0.0, 0.45}) {
    const Blueprint solid = MakeSolid(MakeSolidBox({4, 3, 5}, poissonRatio));
    bench::Random random(2);
    World world(WorldSettings{});
    world.AddObstacle({});
    const Vector3d place(0, 0, 1.2 * solid.reach);
    const BodyId id = world.AddBody(world.AddBlueprint(solid), place);
    std::vector<Vector3d> start = Break(Broken::kRandom, solid, random);
    for (Vector3d& at : start) at += place;
    world.SetMotion(id, start, std::vector<Vector3d>(start.size(), Vector3d::Zero()));
    for (int tick = 0; tick < 120; ++tick) ASSERT_EQ(world.Step().quarantined, 0U) << poissonRatio << " " << tick;
    EXPECT_LT(FindShapeDistance(ListPositions(world, id), solid.rest), 0.25 * solid.size) << poissonRatio;
  }
}

LatticeDefinition DescribeLattice(const std::array<int, 3>& cells) {
  LatticeDefinition lattice;
  lattice.cells = cells;
  lattice.poissonRatio = FindPoissonRatio(cells);
  return lattice;
}

// The least volume that three edges of a cell span at a corner, of that at rest; planar: the least area.
double FindLeastRatio(const Blueprint& lattice, const std::vector<Vector3d>& x) {
  const Cells<double>& cells = lattice.full.cells;
  double least = 10;
  for (const std::uint16_t first : cells.first) {
    for (unsigned bits = 0; bits < 8; ++bits) {
      if (lattice.full.planar && (bits & 2U) != 0) continue;
      std::size_t own = first;
      for (std::size_t axis = 0; axis < 3; ++axis) own += (bits >> axis & 1U) * cells.strides[axis];
      Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (cells.strides[axis] == 0) continue;
        const std::size_t from = (bits >> axis & 1U) != 0 ? own - cells.strides[axis] : own;
        edges.col(static_cast<int>(axis)) = (x[from + cells.strides[axis]] - x[from]) / cells.edge;
      }
      least = std::min(least, edges.determinant());
    }
  }
  return least;
}

// Plays a lattice from these positions, relative to its place, for two seconds, and checks that every corner of every
// cell is right side out then and that it moved no faster on the way than sound in it.
void ExpectUnfolded(const Blueprint& lattice, const std::vector<Vector3d>& start, const std::string& what) {
  Recovery recovery;
  const std::vector<Vector3d> x = PlayOnGround(lattice, start, recovery).back();
  EXPECT_GT(FindLeastRatio(lattice, x), 0.3) << what;
  EXPECT_EQ(recovery.reset, 0U) << what;
  EXPECT_LT(recovery.speed, 22) << what;
}

constexpr std::array<int, 3> kLattices[] = {{1, 1, 1}, {3, 3, 3}, {5, 2, 2}, {4, 0, 4}, {8, 0, 3}};

void ExpectUnfolded(Broken how) {
  for (const auto& cells : kLattices) {
    const Blueprint lattice = MakeLattice(DescribeLattice(cells));
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      bench::Random random(seed);
      ExpectUnfolded(lattice, Break(how, lattice, random),
                     std::to_string(cells[0]) + " cells along x, seed " + std::to_string(seed));
    }
  }
}

TEST(Recovery, OfLatticesFromFlat) { ExpectUnfolded(Broken::kFlattened); }
TEST(Recovery, OfLatticesFromInsideOut) { ExpectUnfolded(Broken::kInsideOut); }
TEST(Recovery, OfLatticesFromFolded) { ExpectUnfolded(Broken::kFolded); }

// One corner of the lattice, or another vertex, pushed through its cell.
TEST(Recovery, OfLatticesFromAVertexPushedThrough) {
  for (const auto& cells : kLattices) {
    const Blueprint lattice = MakeLattice(DescribeLattice(cells));
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      bench::Random random(seed);
      std::vector<Vector3d> x = lattice.rest;
      Vector3d& at = x[seed == 0 ? 0 : random.Choose(x.size())];
      at -= random.Draw(1.2, 2.2) * lattice.full.cells.edge * at.normalized();
      ExpectUnfolded(lattice, x, std::to_string(cells[0]) + " cells along x, seed " + std::to_string(seed));
    }
  }
}

// Without damping, what a fall has put into the springs stays there as heat, here ten times the energy of the gas: the
// gas alone turned such a ball out of its own volume and back for as long as it was looked at.
TEST(Recovery, OfAHotBallWithLittleGas) {
  BallDefinition definition;
  definition.subdivisions = 2;
  definition.material.mass = 1.16;
  definition.material.stiffness = 105;
  definition.material.dampingRatio = 0;
  definition.material.gas = 5.4;
  definition.material.ambientPressure = 0;
  const Blueprint ball = MakeBall(definition);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    bench::Random random(seed);
    World world(WorldSettings{});
    world.AddObstacle({});
    const Vector3d place(0, 0, 1.2 * ball.reach);
    const BodyId id = world.AddBody(world.AddBlueprint(ball), place);
    std::vector<Vector3d> start = Break(Broken::kInsideOut, ball, random);
    std::vector<Vector3d> velocities;
    for (Vector3d& at : start) {
      at = place + 0.4 * at;
      velocities.push_back(random.Draw(0, 15) * random.DrawDirection());
    }
    world.SetMotion(id, start, velocities);
    std::uint32_t reset = 0;
    for (int tick = 0; tick < 120; ++tick) reset += world.Step().reset;
    const std::vector<Vector3d> x = ListPositions(world, id);
    EXPECT_EQ(reset, 0U) << seed;
    EXPECT_GT(ComputeVolume<double>(ball.full.faces, x), 0.3 * ball.restVolume) << seed;
  }
}

// Thrown onto the floor with up to 160 times the energy of its gas, a ball comes out as it was.
TEST(Recovery, FromAnyThrow) {
  for (const double speed : {10.0, 20.0, 30.0, 40.0, 50.0, 70.0, 100.0}) {
    World world(WorldSettings{});
    world.AddObstacle({});
    const BodyId id = world.AddBody(world.AddBlueprint(MakeBall({})), {0, 0, 1}, {0.2 * speed, 0, -speed});
    for (int tick = 0; tick < 120; ++tick) ASSERT_EQ(world.Step().quarantined, 0U) << speed << " " << tick;
    const Blueprint& blueprint = world.Blueprints()[0];
    EXPECT_LT(FindShapeDistance(ListPositions(world, id), blueprint.rest), 0.15 * blueprint.size) << speed;
  }
}

}  // namespace
}  // namespace wobble::physics
