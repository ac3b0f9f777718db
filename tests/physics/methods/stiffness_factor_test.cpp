// World::SetStiffnessFactor: every spring of a world is made stiffer or softer at once.
#include <gtest/gtest.h>

#include <cmath>

#include "server/physics/methods/stability.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kTick = 1.0 / 60;

// A particle of 1 kg that hangs from a fixed one, by 1 m of spring.
Blueprint MakePendulum(double stiffness, double damping) {
  GraphDefinition graph;
  graph.particles = {{Vector3d(0, 0, 0), 1, true}, {Vector3d(0, 0, -1), 1, false}};
  graph.springs = {{0, 1, stiffness, damping, 0}};
  return MakeGraph(graph);
}

double FindLength(const World& world, BodyId id) {
  const auto& x = std::get<State<float>>(world.ReadBody(id).state).positions;
  return static_cast<double>((x[0] - x[1]).norm());
}

TEST(StiffnessFactor, DividesWhatAWeightStretches) {
  for (const Integrator integrator : {Integrator::kRungeKutta4, Integrator::kSemiImplicitEuler,
                                      Integrator::kVelocityVerlet, Integrator::kLeapFrog, Integrator::kImplicitEuler}) {
    World world(WorldSettings{});
    Blueprint pendulum = MakePendulum(100, 5);
    SetIntegrator(pendulum, integrator);
    world.AddBlueprint(pendulum);
    const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
    for (const double factor : {1.0, 4.0, 0.25, 1.0}) {
      world.SetStiffnessFactor(factor);
      for (int tick = 0; tick < 900; ++tick) ASSERT_EQ(world.Step().quarantined, 0U);
      EXPECT_NEAR(FindLength(world, id), 1 + 9.81 / (100 * factor), 2e-3) << static_cast<int>(integrator);
    }
  }
}

TEST(StiffnessFactor, IsNothingToSpringsThatAreDistances) {
  World world(WorldSettings{});
  Blueprint pendulum = MakePendulum(100, 5);
  SetIntegrator(pendulum, Integrator::kPositionVerlet);
  world.AddBlueprint(pendulum);
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
  for (int tick = 0; tick < 120; ++tick) world.Step();
  const double length = FindLength(world, id);
  world.SetStiffnessFactor(0.25);
  for (int tick = 0; tick < 120; ++tick) world.Step();
  EXPECT_NEAR(FindLength(world, id), length, 1e-5);
}

TEST(StiffnessFactor, OfOneIsNone) {
  const auto play = [](bool set) {
    World world(WorldSettings{});
    world.AddBlueprint(MakeBall(BallDefinition{}));
    world.AddObstacle(Obstacle{});
    const BodyId id = world.AddBody(0, Vector3d(0, 0, 1));
    Control control;
    control.stiffen = true;
    world.SetControl(id, control, ControlLimits{});
    for (int tick = 0; tick < 60; ++tick) {
      if (set) world.SetStiffnessFactor(1);
      world.Step();
    }
    return world.Hash();
  };
  EXPECT_EQ(play(true), play(false));
}

TEST(StiffnessFactor, WakesThemAndLetsThemFallAsleepAgain) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.2)));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 0.4));
  const auto fallsAsleep = [&] {
    for (int tick = 0; tick < 900 && !world.ReadBody(id).asleep; ++tick) world.Step();
    return world.ReadBody(id).asleep;
  };
  ASSERT_TRUE(fallsAsleep());
  world.SetStiffnessFactor(1);
  EXPECT_TRUE(world.ReadBody(id).asleep) << "nothing has changed";
  world.SetStiffnessFactor(2.5);
  EXPECT_FALSE(world.ReadBody(id).asleep);
  EXPECT_TRUE(fallsAsleep());
  EXPECT_NEAR(world.ReadBody(id).stiffnessFactor, 2.5, 2e-3);
  EXPECT_EQ(world.ReadBody(world.AddBody(0, Vector3d(5, 0, 1))).stiffnessFactor, 2.5) << "born into it";
}

TEST(StiffnessFactor, MultipliesWhatAPlayerStiffens) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.2)));
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 50));
  Control control;
  control.stiffen = true;
  world.SetControl(id, control, ControlLimits{});
  world.SetStiffnessFactor(3);
  for (int tick = 0; tick < 60; ++tick) world.Step();
  EXPECT_NEAR(world.ReadBody(id).stiffnessFactor, 6, 1e-6);
}

// Two bodies that need nearly half of kMaxSubsteps at factor 1: one by its frequency, one by its damping.
TEST(StiffnessFactor, GoesAsFarAsSubstepsSuffice) {
  EXPECT_EQ(FindStiffnessBound(MakePendulum(100, 1), kTick), kMaxStiffnessBound);
  for (const auto& [stiffness, damping] : {std::pair{2e7, 500.0}, std::pair{1e5, 4000.0}}) {
    const Blueprint stiff = MakePendulum(stiffness, damping);
    ASSERT_TRUE(IsSlowEnough(stiff));
    const double bound = FindStiffnessBound(stiff, kTick);
    EXPECT_GT(bound, 2);
    EXPECT_LT(bound, 8);
    EXPECT_EQ(FindStiffnessBound(stiff, 1), 1) << "in slower ticks";
    World world(WorldSettings{});
    world.AddBlueprint(stiff);
    world.AddObstacle(Obstacle{});
    const BodyId id = world.AddBody(0, Vector3d(0, 0, 0.9));
    Control control;
    control.stiffen = true;
    world.SetControl(id, control, ControlLimits{});
    for (int tick = 0; tick < 60; ++tick) world.Step();
    EXPECT_NEAR(world.ReadBody(id).stiffnessFactor, 2, 1e-6);
    world.SetStiffnessFactor(kMostStiffnessFactor);
    for (int tick = 0; tick < 300; ++tick) ASSERT_EQ(world.Step().quarantined, 0U) << tick;
    EXPECT_NEAR(world.ReadBody(id).stiffnessFactor, bound, 1e-6);
  }
}

// Balls and cubes that fall on one another while the factor jumps about.
TEST(StiffnessFactor, LeavesAHeapInGoodHealth) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.1)));
  world.AddObstacle(Obstacle{});
  for (int i = 0; i < 5; ++i) {
    world.AddBody(static_cast<std::uint8_t>(i % 2), Vector3d(0.7 * (i % 3), 0.1 * i, 0.8 + 0.5 * i));
  }
  for (int tick = 0; tick < 240; ++tick) {
    if (tick % 40 == 0) world.SetStiffnessFactor(tick % 80 == 0 ? kMostStiffnessFactor : kLeastStiffnessFactor);
    ASSERT_EQ(world.Step().quarantined, 0U) << tick;
  }
}

}  // namespace
}  // namespace wobble::physics
