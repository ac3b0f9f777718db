#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <variant>

#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/world.h"
#include "server/physics/world_state.h"
#include "tests/physics/bodies.h"
#include "tests/support/pace.h"

namespace wobble::physics {
namespace {

BallDefinition MakeStiffBall() {
  BallDefinition ball;
  ball.subdivisions = 1;
  ball.material.stiffness = 3000;
  ball.material.dampingRatio = 0.02;
  return ball;
}

std::vector<Vector3d> ReadPositions(const World& world, BodyId id) {
  std::vector<Vector3d> positions;
  VisitVertices(world.ReadBody(id), [&](std::size_t, const Vector3d& x) { positions.push_back(x); });
  return positions;
}

struct Counts {
  std::uint32_t nonFinite = 0, inverted = 0, quarantined = 0, reset = 0;
};

Counts Play(World& world, int ticks) {
  Counts counts;
  for (int tick = 0; tick < ticks; ++tick) {
    const StepReport report = world.Step();
    counts.nonFinite += report.nonFinite;
    counts.inverted += report.inverted;
    counts.quarantined += report.quarantined;
    counts.reset += report.reset;
  }
  return counts;
}

// A blueprint that claims too low a frequency, as with a wrong bound, is stepped at a rate at which RK4 is unstable.
TEST(Quarantine, ARunawayIsSteppedFinerAndLives) {
  Blueprint blueprint = MakeBall(MakeStiffBall());
  ASSERT_GT(blueprint.angularFrequency / 60, 1.5 * 2.83);
  blueprint.angularFrequency /= 10;
  blueprint.dampingRate /= 100;
  WorldSettings settings;
  settings.maxSubsteps = 1;  // else the error would be noticed first
  World world(settings);
  world.AddBlueprint(std::move(blueprint));
  world.AddBlueprint(MakeBall(MakeStiffBall()));
  world.AddBody(0, Vector3d(0, 0, 50), Vector3d(0, 1, 0));
  world.AddBody(1, Vector3d(9, 0, 50), Vector3d(0, 1, 0));
  // A small deformation that the instability can grow from.
  auto positions = ReadPositions(world, 1);
  for (Vector3d& x : positions) x.x() *= 1.01;
  world.SetMotion(1, positions, std::vector<Vector3d>(positions.size(), Vector3d(0, 1, 0)));
  const Counts counts = Play(world, 120);
  EXPECT_GT(counts.quarantined, 0U);
  EXPECT_EQ(counts.nonFinite, 0U) << "noticed before that";
  EXPECT_EQ(counts.reset, 0U) << "16 times the substeps are enough";
  const Vector3d apart = world.FindCentre(world.ReadBody(2)) - world.FindCentre(world.ReadBody(1));
  EXPECT_NEAR((apart - Vector3d(9, 0, 0)).norm(), 0, 0.1) << "it falls as its neighbour does";
}

// The gas turns the body the right side out again, so violently that the first try misses its error by far.
TEST(Quarantine, InsideOutIsPutRight) {
  World world(WorldSettings{});
  const Blueprint blueprint = MakeBall(BallDefinition{});
  world.AddBlueprint(blueprint);
  world.AddBody(0, Vector3d(0, 0, 500));
  auto positions = ReadPositions(world, 1);
  for (Vector3d& x : positions) x.x() = -x.x();
  world.SetMotion(1, positions, std::vector<Vector3d>(positions.size(), Vector3d::Zero()));
  const StepReport report = world.Step();
  EXPECT_GT(report.allSubsteps, report.substeps);  // the first try was thrown away
  EXPECT_EQ(report.reset, 0U);
  Play(world, 120);
  EXPECT_EQ(Play(world, 120).quarantined, 0U);
  const double volume = ComputeVolume<double>(blueprint.full.faces, ReadPositions(world, 1));
  EXPECT_NEAR(volume, blueprint.restVolume, 0.2 * blueprint.restVolume);
}

// The work of a drive counts as put in.
TEST(Quarantine, APushIsNoRunaway) {
  World world(WorldSettings{.gravity = Vector3d::Zero()});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  const BodyId ball = world.AddBody(0, Vector3d::Zero());
  world.AddDrive({.body = ball, .vertices = {0, 1, 2}, .force = Vector3d(200, 0, 0), .end = 2});
  EXPECT_EQ(Play(world, 30).quarantined, 0U);
  EXPECT_NEAR(world.FindCentre(world.ReadBody(ball)).x(), 0.5 * 200 / 8 * 0.25, 0.05);
}

TEST(Quarantine, TheNeighbourOfALostBodyLives) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddObstacle(Obstacle{});
  world.AddBody(0, Vector3d(0, 0, 0.5), Vector3d(1, 0, 0));
  world.AddBody(0, Vector3d(1.1, 0, 0.5), Vector3d(-1, 0, 0));
  for (int tick = 0; tick < 30 && !world.ReadBody(1).touchesBody; ++tick) world.Step();
  ASSERT_TRUE(world.ReadBody(1).touchesBody);
  const auto positions = ReadPositions(world, 1);
  std::vector<Vector3d> velocities(positions.size(), Vector3d::Zero());
  velocities[3].z() = std::numeric_limits<double>::quiet_NaN();
  world.SetMotion(1, positions, velocities);
  const StepReport report = world.Step();
  EXPECT_EQ(report.nonFinite, 1U);
  EXPECT_EQ(report.reset, 1U);
  const Counts after = Play(world, 240);
  EXPECT_EQ(after.quarantined, 0U);
  EXPECT_NEAR(world.FindCentre(world.ReadBody(1)).z(), world.FindCentre(world.ReadBody(2)).z(), 0.05)
      << "both lie on the ground, rocking a little";
}

// How long two bodies have been in one another, ticks: 0 if they are not, or are not known to be.
int ReadTangle(const World& world) {
  return std::visit(
      [](const auto& pairs) {
        int ticks = 0;
        for (const auto& pair : pairs.awake) ticks = std::max(ticks, pair.tangle.ticks);
        return ticks;
      },
      world.Capture().pairs);
}

// The next time that it is in a neighbour, the tension begins to grow anew.
TEST(Quarantine, ALostBodyWasInNobody) {
  World world(WorldSettings{.gravity = Vector3d::Zero()});
  LatticeDefinition block;
  block.cells = {2, 2, 2};
  world.AddBlueprint(MakeLattice(block));
  world.AddBody(0, Vector3d(0, 0, 0.5));
  world.AddBody(0, Vector3d(0.3, 0.1, 0.75));
  for (int tick = 0; tick < 60; ++tick) world.Step();
  ASSERT_GT(ReadTangle(world), 0);
  const auto positions = ReadPositions(world, 1);
  std::vector<Vector3d> velocities(positions.size(), Vector3d::Zero());
  velocities[3].z() = std::numeric_limits<double>::quiet_NaN();
  world.SetMotion(1, positions, velocities);
  EXPECT_EQ(world.Step().reset, 1U);
  EXPECT_EQ(ReadTangle(world), 0);
}

// The vertices of one of ten cloths fly apart at up to 10⁶ m/s: all others are within their way.
TEST(Quarantine, WhatIsTooFastToMeetAnythingLeavesTheOthersAlone) {
  const auto make = [] {
    auto world = std::make_unique<World>(WorldSettings{});
    world->AddBlueprint(MakeCloth({.points = {8, 8}}));
    world->AddObstacle(Obstacle{});
    for (int i = 0; i < 10; ++i) world->AddBody(0, Vector3d(5.0 * i, 0, 3));
    return world;
  };
  const auto world = make();
  const auto calm = make();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> speed(-1e6, 1e6);
  const auto positions = ReadPositions(*world, 5);
  std::vector<Vector3d> velocities;
  for (std::size_t i = 0; i < positions.size(); ++i)
    velocities.emplace_back(speed(random), speed(random), speed(random));
  world->SetMotion(5, positions, velocities);
  EXPECT_EQ(Play(*world, 60).reset, 1U);
  Play(*calm, 60);
  for (const BodyId id : {1, 4, 6, 10}) EXPECT_EQ(ReadPositions(*world, id), ReadPositions(*calm, id)) << id;
}

// Vertices are thrown about at random, from a push to the speed of a bullet: the result is always finite and the right
// side out.
TEST(Quarantine, AnyThrowIsSurvived) {
  std::uint32_t random = 12345;
  const auto next = [&random] {
    random = random * 1664525U + 1013904223U;
    return static_cast<double>(random >> 8) / (1U << 23) - 1;
  };
  const Blueprint blueprint = MakeBall(BallDefinition{});
  for (const double speed : {10.0, 30.0, 100.0, 300.0, 1000.0}) {
    World world(WorldSettings{});
    world.AddBlueprint(blueprint);
    world.AddObstacle(Obstacle{});
    world.AddBody(0, Vector3d(0, 0, 1));
    const auto positions = ReadPositions(world, 1);
    std::vector<Vector3d> velocities;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      velocities.emplace_back(speed * Vector3d(next(), next(), next()));
    }
    world.SetMotion(1, positions, velocities);
    EXPECT_EQ(Play(world, 900).reset, 0U) << speed;
    EXPECT_GT(ComputeVolume<double>(blueprint.full.faces, ReadPositions(world, 1)), 0) << speed;
  }
}

// The most violent honest play is not taken for a runaway.
TEST(Quarantine, HonestViolenceIsNoRunaway) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddObstacle(Obstacle{});
  Control control;
  const ControlLimits limits;
  for (int i = 0; i < 6; ++i) world.AddBody(0, Vector3d(0.2 * i, 0.1 * i, 1 + 1.2 * i), Vector3d(0, 0, -10));
  Counts counts;
  for (int second = 0; second < test::Shorten(10); ++second) {
    for (BodyId id = 1; id <= 6; ++id) {
      control.jump = (second + static_cast<int>(id)) % 2 == 0;
      control.puff = second % 3 == 0;
      control.stiffen = second % 4 == 1;
      control.moveX = second % 2 == 0 ? 1 : -1;
      world.SetControl(id, control, limits);
    }
    const Counts more = Play(world, 60);
    counts.quarantined += more.quarantined;
  }
  EXPECT_EQ(counts.quarantined, 0U);
}

// A tick that missed its error by far is stepped again, whatever state its bodies are in. Here the first tries are
// unstable, since the blueprint claims too low a frequency; the same happens to bodies that a kick has folded.
TEST(Quarantine, ATryThatDoesNotCountIsNotJudged) {
  PairDefinition definition;
  definition.material.stiffness = 2e4;
  Blueprint blueprint = MakePair(definition);
  blueprint.angularFrequency = 1;
  blueprint.dampingRate = 0;
  World world(WorldSettings{});
  world.AddBlueprint(blueprint);
  world.AddBody(0, Vector3d(0, 0, 100));
  std::vector<Vector3d> positions = ReadPositions(world, 1);
  positions[1].x() += 0.2;
  world.SetMotion(1, positions, std::vector<Vector3d>(2, Vector3d::Zero()));
  StepReport report = world.Step();
  EXPECT_GT(report.allSubsteps, report.substeps);
  EXPECT_EQ(report.quarantined, 0U);
}

}  // namespace
}  // namespace wobble::physics
