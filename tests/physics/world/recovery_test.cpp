// Bodies in broken states get back to their shape by the forces of the equations alone.
#include <gtest/gtest.h>

#include "server/physics/shapes/ring.h"
#include "tests/physics/bodies.h"
#include "tests/support/broken_states.h"

namespace wobble::physics {
namespace {

void ExpectRecovered(Broken how) {
  BallDefinition coarse;
  coarse.subdivisions = 1;
  const Blueprint blueprints[] = {MakeBall(coarse), MakeBall({}), MakeRing({})};
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
