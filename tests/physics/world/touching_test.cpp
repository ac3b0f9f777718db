// World::ListTouching: which bodies touch a body.
#include <gtest/gtest.h>

#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

using Ids = std::vector<BodyId>;

TEST(Touching, ListsThoseOnEitherSideAscending) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    WorldSettings settings;
    settings.precision = precision;
    World world(settings);
    world.AddBlueprint(MakeLattice(MakeJellyCube(0.3)));
    world.AddObstacle(Obstacle{});
    const BodyId top = world.AddBody(0, Vector3d(0, 0, 1.95));
    const BodyId middle = world.AddBody(0, Vector3d(0, 0, 1.16));
    const BodyId beside = world.AddBody(0, Vector3d(0.85, 0, 0.38));
    const BodyId bottom = world.AddBody(0, Vector3d(0, 0, 0.38));
    Ids touching{7, 7, 7, 7};
    world.ListTouching(middle, touching);
    EXPECT_EQ(touching, Ids{}) << "no step yet";
    const auto list = [&](BodyId id) {
      world.ListTouching(id, touching);
      return touching;
    };
    for (int tick = 0; tick < 120; ++tick) world.Step();
    const auto check = [&] {
      EXPECT_EQ(list(middle), (Ids{top, bottom}));
      EXPECT_EQ(list(top), Ids{middle});
      EXPECT_EQ(list(bottom), Ids{middle});
      EXPECT_EQ(list(beside), Ids{}) << "near, no more";
    };
    check();
    for (int tick = 0; tick < 3000 && !world.ReadBody(middle).asleep; ++tick) world.Step();
    ASSERT_TRUE(world.ReadBody(middle).asleep);
    check();
    world.RemoveBody(top);
    EXPECT_EQ(list(middle), Ids{bottom});
  }
}

TEST(Touching, AgreesWithWhatBodiesSayOfThemselves) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddObstacle(Obstacle{});
  for (int i = 0; i < 20; ++i) world.AddBody(0, Vector3d(0.7 * (i % 4), 0.7 * (i % 3), 1 + 0.8 * i));
  Ids touching;
  std::size_t touches = 0;
  for (int tick = 0; tick < 240; ++tick) {
    world.Step();
    for (const Body& body : world.Bodies()) {
      world.ListTouching(body.id, touching);
      EXPECT_TRUE(body.asleep || body.touchesBody == !touching.empty()) << tick;
      touches += touching.size();
    }
  }
  EXPECT_GT(touches, 1000U);
  EXPECT_EQ(touches % 2, 0U) << "each sees the other";
}

}  // namespace
}  // namespace wobble::physics
