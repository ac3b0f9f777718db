// Bodies that rest, stand and slide on one another: piles, stacks, edges, and the ground that a body is for another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"
#include "tests/support/pace.h"

namespace wobble::physics {
namespace {

// Twelve balls dropped into a pit in three layers.
TEST(Stacks, APileComesToRest) {
  World world(WorldSettings{});
  BallDefinition ball;
  ball.material.gas = 330;
  world.AddBlueprint(MakeBall(ball));
  for (const Vector3d& normal :
       {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0)}) {
    world.AddObstacle({.normal = normal, .offset = normal.z() > 0 ? 0.0 : -1.2});
  }
  for (int i = 0; i < 12; ++i) {
    world.AddBody(0, Vector3d(1.1 * (i % 2) - 0.55 + 0.05 * (i % 3), 1.1 * (i / 2 % 2) - 0.6, 0.6 + 1.2 * (i / 4)));
  }
  for (int i = 0; i < test::Shorten(12 * 60); ++i) {
    const StepReport report = world.Step();
    ASSERT_EQ(report.nonFinite + report.inverted, 0U) << i;
  }
  if (test::kIsSanitized) return;
  for (const Body& body : world.Bodies()) {
    const Vector3d centre = world.FindCentre(body);
    EXPECT_GT(centre.z(), 0.25);  // half of the radius, under two layers
    EXPECT_LT(centre.head<2>().cwiseAbs().maxCoeff(), 1);
    EXPECT_LT(FindMeanVelocity(world.BlueprintOf(body), std::get<State<float>>(body.state)).norm(), 0.05);
    for (const Body& other : world.Bodies()) {
      const double apart = (world.FindCentre(other) - centre).norm();
      EXPECT_TRUE(other.id == body.id || apart > 0.6) << body.id << " " << other.id << " " << apart;
    }
  }
}

// The slabs' vertices lie over one another, corner over corner: the stack must neither slide nor sink nor shake.
TEST(Stacks, AStackOfSlabsStands) {
  World world(WorldSettings{});
  LatticeDefinition slab;
  slab.cells = {3, 3, 2};
  slab.cellSize = 0.3;
  slab.youngModulus = 31400;
  world.AddBlueprint(MakeLattice(slab));
  world.AddObstacle(Obstacle{});
  for (int i = 0; i < 3; ++i) world.AddBody(0, Vector3d(0, 0, 0.31 + 0.61 * i));
  for (int i = 0; i < 5 * 60; ++i) {
    const StepReport report = world.Step();
    ASSERT_EQ(report.nonFinite, 0U);
  }
  for (const Body& body : world.Bodies()) {
    const Vector3d centre = world.FindCentre(body);
    EXPECT_LT(centre.head<2>().norm(), 0.01);
    EXPECT_NEAR(centre.z(), 0.3 + 0.6 * (body.id - 1), 0.05);
    EXPECT_LT(FindMeanVelocity(world.BlueprintOf(body), std::get<State<float>>(body.state)).norm(), 0.05);
  }
}

// Face on face and edge on edge, without a gap: rounding decides on which side of an edge a vertex is.
TEST(Stacks, CubesStandEdgeOnEdge) {
  for (const int cells : {2, 3}) {
    World world(WorldSettings{});
    LatticeDefinition cube;
    cube.cells = {cells, cells, cells};
    cube.cellSize = 0.5 / cells;
    cube.dampingRatio = 0.3;
    world.AddBlueprint(MakeLattice(cube));
    world.AddObstacle(Obstacle{});
    for (int i = 0; i < 3; ++i) world.AddBody(0, Vector3d(0, 0, 0.25 + 0.5 * i));
    for (int i = 0; i < 5 * 60; ++i) world.Step();
    for (const Body& body : world.Bodies()) {
      const Vector3d centre = world.FindCentre(body);
      EXPECT_LT(centre.head<2>().norm(), 0.001) << cells << " cells, body " << body.id;
      EXPECT_NEAR(centre.z(), 0.25 + 0.5 * (body.id - 1), 0.05) << cells << " cells, body " << body.id;
    }
  }
}

// A cube slides down a slab on a slope of 26° when their friction is 0.4; the slab itself is held by far more friction.
// The part of the slab that rises before the cube must not catch its edge.
TEST(Stacks, AnEdgeIsNotCaughtByWhatItSlidesOver) {
  WorldSettings settings;
  World world(settings);
  LatticeDefinition cube;
  cube.cells = {2, 2, 2};
  cube.cellSize = 0.2;
  cube.youngModulus = 20000;
  cube.friction = 0.4;
  LatticeDefinition slab = cube;
  slab.cells = {7, 5, 1};
  world.AddBlueprint(MakeLattice(cube));
  world.AddBlueprint(MakeLattice(slab));
  world.AddObstacle({.friction = 50});
  world.AddBody(0, Vector3d(0, 0, 0.4));
  world.AddBody(1, Vector3d(0.3, 0, 0.1));
  for (int i = 0; i < 60; ++i) world.Step();
  for (int i = 1; i <= 120; ++i) {
    const double angle = i / 120.0 * 26 / 180 * std::acos(-1.0);
    world.SetGravity(9.81 * Vector3d(std::sin(angle), 0, -std::cos(angle)));
    world.Step();
  }
  const double from = world.FindCentre(world.Bodies()[0]).x();
  for (int i = 0; i < 30; ++i) world.Step();
  EXPECT_GT(world.FindCentre(world.Bodies()[0]).x() - from, 0.05);
}

// A body that stands on another can jump off it.
TEST(Stacks, ABodyIsGroundToJumpFrom) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  for (const double side : {-1.0, 1.0}) {
    world.AddObstacle({.normal = Vector3d(side, 0, 0), .offset = -0.55});
    world.AddObstacle({.normal = Vector3d(0, side, 0), .offset = -0.55});
  }
  world.AddObstacle(Obstacle{});
  world.AddBody(0, Vector3d(0, 0, 0.5));
  const BodyId top = world.AddBody(0, Vector3d(0.02, 0, 1.5));
  for (int i = 0; i < 180; ++i) world.Step();
  world.SetControl(top, {.jump = true}, ControlLimits{});
  const auto speedOf = [&world](BodyId id) {
    const Body& body = world.ReadBody(id);
    return FindMeanVelocity(world.BlueprintOf(body), std::get<State<float>>(body.state)).z();
  };
  world.Step();
  EXPECT_GT(speedOf(top), 4);
}

}  // namespace
}  // namespace wobble::physics
