// Bodies at rest fall asleep, cost nothing then, and wake when something reaches them.
#include <gtest/gtest.h>

#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kCube = 0.5;  // edge of a cube, m

// A stack of cubes on the floor; the lowest is body 1.
std::unique_ptr<World> MakeStack(int height, int threads = 1) {
  WorldSettings settings;
  settings.threads = threads;
  auto world = std::make_unique<World>(settings);
  LatticeDefinition cube;
  cube.cells = {2, 2, 2};
  cube.cellSize = kCube / 2;
  cube.dampingRatio = 0.3;
  world->AddBlueprint(MakeLattice(cube));
  world->AddBlueprint(MakeBall(BallDefinition{}));
  world->AddObstacle(Obstacle{});
  for (int i = 0; i < height; ++i) world->AddBody(0, Vector3d(0, 0, kCube * (0.5 + 1.02 * i)));
  return world;
}

// Steps until all bodies sleep and returns the ticks; 0: they do not within a minute.
int PlayUntilAsleep(World& world) {
  for (int tick = 1; tick <= 3600; ++tick) {
    if (world.Step().awake == 0) return tick;
  }
  return 0;
}

bool IsAsleep(const World& world, BodyId id) { return world.ReadBody(id).asleep; }
double HeightOf(const World& world, BodyId id) { return world.FindCentre(world.ReadBody(id)).z(); }

// For an hour: to the bit, so that nothing drifts.
TEST(Sleep, AStackFallsAsleepAndStaysSo) {
  const auto world = MakeStack(4);
  const int ticks = PlayUntilAsleep(*world);
  ASSERT_GT(ticks, 30) << "half a second of quiet at the least";
  const std::uint64_t hash = world->Hash();
  for (int tick = 0; tick < 60 * 60 * 60; ++tick) {
    const StepReport report = world->Step();
    ASSERT_EQ(report.awake, 0U);
    ASSERT_EQ(report.allSubsteps, 0U);
  }
  EXPECT_EQ(world->Hash(), hash);
}

TEST(Sleep, NobodySleepsAloneInAStack) {
  const auto world = MakeStack(3);
  for (int tick = 0; tick < 3600 && !IsAsleep(*world, 3); ++tick) {
    EXPECT_EQ(IsAsleep(*world, 1), IsAsleep(*world, 3));
    EXPECT_EQ(IsAsleep(*world, 2), IsAsleep(*world, 3));
    world->Step();
  }
  EXPECT_TRUE(IsAsleep(*world, 1) && IsAsleep(*world, 2) && IsAsleep(*world, 3));
}

TEST(Sleep, LostSupportWakesInTheSameTick) {
  const auto world = MakeStack(3);
  ASSERT_GT(PlayUntilAsleep(*world), 0);
  const double before = HeightOf(*world, 3);
  world->RemoveBody(1);
  EXPECT_EQ(world->Step().awake, 2U) << "the body that rested on it, and the one above that";
  for (int tick = 0; tick < 30; ++tick) world->Step();
  EXPECT_LT(HeightOf(*world, 3), before - kCube / 2);
}

TEST(Sleep, SupportThatIsTakenElsewhereIsLostToo) {
  const auto world = MakeStack(2);
  ASSERT_GT(PlayUntilAsleep(*world), 0);
  world->PlaceBody(1, Vector3d(20, 0, 1));
  EXPECT_EQ(world->Step().awake, 2U);
}

TEST(Sleep, WhatFallsOntoASleeperWakesAllUnderIt) {
  const auto world = MakeStack(3);
  ASSERT_GT(PlayUntilAsleep(*world), 0);
  const BodyId ball = world->AddBody(1, Vector3d(0, 0, 4));
  int tick = 0;
  while (IsAsleep(*world, 3) && tick < 120) {
    const StepReport report = world->Step();
    ++tick;
    ASSERT_TRUE(report.awake == 1 || report.awake == 4) << "all bodies wake in one tick";
  }
  EXPECT_FALSE(IsAsleep(*world, 1));
  EXPECT_LT(HeightOf(*world, ball), 3);
  EXPECT_GT(tick, 20) << "not before it came near";
}

TEST(Sleep, InputWakesAndNoInputDoesNot) {
  const auto world = MakeStack(1);
  ASSERT_GT(PlayUntilAsleep(*world), 0);
  world->SetControl(1, {}, {});
  EXPECT_EQ(world->Step().awake, 0U);
  Control control;
  control.jump = true;
  world->SetControl(1, control, {});
  EXPECT_EQ(world->Step().awake, 1U);
  EXPECT_GT(HeightOf(*world, 1), kCube / 2 + 0.05) << "and it jumps at once";
}

TEST(Sleep, HeldInputKeepsAwake) {
  const auto world = MakeStack(1);
  Control control;
  control.puff = true;
  world->SetControl(1, control, {});
  EXPECT_EQ(PlayUntilAsleep(*world), 0);
}

TEST(Sleep, TiltedGravityWakesEverybody) {
  const auto world = MakeStack(3);
  ASSERT_GT(PlayUntilAsleep(*world), 0);
  world->SetGravity(Vector3d(0, 0, -9.81));
  EXPECT_EQ(world->Step().awake, 0U) << "nothing has changed";
  world->SetGravity(Vector3d(2, 0, -9.6));
  EXPECT_EQ(world->Step().awake, 3U);
}

TEST(Sleep, APassingBodyWakesNobody) {
  const auto world = MakeStack(2);
  ASSERT_GT(PlayUntilAsleep(*world), 0);
  world->AddBody(1, Vector3d(-8, 1.2, 0.5), Vector3d(6, 0, 0));  // 0.45 m clear of the stack
  for (int tick = 0; tick < 120; ++tick) ASSERT_EQ(world->Step().awake, 1U);
}

TEST(Sleep, RemovalDoesNotMixSleepersUp) {
  const auto world = MakeStack(1);
  const BodyId far = world->AddBody(0, Vector3d(5, 0, kCube / 2));
  world->AddBody(0, Vector3d(10, 0, kCube / 2));
  ASSERT_GT(PlayUntilAsleep(*world), 0);
  world->RemoveBody(far);
  EXPECT_EQ(world->Step().awake, 0U);
  world->AddBody(1, Vector3d(10, 0, 2));
  for (int tick = 0; tick < 60; ++tick) world->Step();
  EXPECT_TRUE(IsAsleep(*world, 1));
  EXPECT_FALSE(IsAsleep(*world, 3));
}

TEST(Sleep, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2, 4}) {
    const auto world = MakeStack(3, threads);
    EXPECT_GT(PlayUntilAsleep(*world), 0);
    world->AddBody(1, Vector3d(0.1, 0, 4));
    for (int tick = 0; tick < 120; ++tick) world->Step();
    hashes.push_back(world->Hash());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

}  // namespace
}  // namespace wobble::physics
