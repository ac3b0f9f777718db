// The energy of a body by kind against values computed by hand; a swing conserves their sum.
#include "server/physics/energy.h"

#include <gtest/gtest.h>

#include "server/physics/methods/elasticity.h"
#include "server/physics/shapes/pair.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

Energy ComputeOf(const World& world, BodyId id) {
  std::vector<Vector3d> scratch;
  return ComputeEnergy(world, world.ReadBody(id), scratch);
}

double Sum(const Energy& energy) { return energy.kinetic + energy.gravity + energy.springs + energy.gas; }

TEST(Energy, OfABodyThatFliesIsThatOfItsCentre) {
  World world({});
  const std::uint8_t ball = world.AddBlueprint(MakeBall({}));
  const BodyId id = world.AddBody(ball, {0, 0, 10}, {3, 0, 4});
  const double mass = world.Blueprints()[ball].totalMass;
  const Energy energy = ComputeOf(world, id);
  EXPECT_NEAR(energy.kinetic, 0.5 * mass * 25, 1e-4 * mass);
  EXPECT_NEAR(energy.gravity, mass * 9.81 * 10, 1e-4 * mass);
  EXPECT_GE(energy.springs, 0);
}

TEST(Energy, OfASpringThatIsDrawnIsHalfItsStiffnessTimesTheSquare) {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  settings.precision = Precision::kDouble;
  World world(settings);
  PairDefinition pair;
  const std::uint8_t blueprint = world.AddBlueprint(MakePair(pair));
  const BodyId id = world.AddBody(blueprint, Vector3d::Zero());
  const std::vector<Vector3d>& rest = world.Blueprints()[blueprint].rest;
  std::vector<Vector3d> drawn(rest.begin(), rest.end());
  const double length = (drawn[1] - drawn[0]).norm();
  drawn[1] += 0.1 * (drawn[1] - drawn[0]);
  world.SetMotion(id, drawn, std::vector<Vector3d>(2, Vector3d::Zero()));
  const double stiffness = world.Blueprints()[blueprint].full.springs[0].stiffness;
  const Energy energy = ComputeOf(world, id);
  EXPECT_NEAR(energy.springs, 0.5 * stiffness * 0.01 * length * length, 1e-9 * stiffness);
  EXPECT_EQ(energy.gas, 0);
  EXPECT_EQ(energy.gravity, 0);
  EXPECT_EQ(energy.kinetic, 0);
}

TEST(Energy, OfASolidTurnsIntoMotionAndBackAndItsSumStays) {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  settings.precision = Precision::kDouble;
  settings.errorTarget = 1e-5;
  World world(settings);
  const Blueprint solid = MakeSolid(MakeSolidBox({2, 2, 2}, 0.4, 0));
  const BodyId id = world.AddBody(world.AddBlueprint(solid), Vector3d::Zero());
  std::vector<Vector3d> wide;
  for (const Vector3d& at : solid.rest) wide.push_back(at.cwiseProduct(Vector3d(1.1, 1, 0.95)));
  world.SetMotion(id, wide, std::vector<Vector3d>(wide.size(), Vector3d::Zero()));
  const double stored = ComputeSolidEnergy(solid.full, wide);
  EXPECT_GT(stored, 1);
  EXPECT_NEAR(ComputeOf(world, id).springs, stored, 1e-9 * stored);
  double fastest = 0;
  for (int tick = 0; tick < 60; ++tick) {
    world.Step();
    const Energy energy = ComputeOf(world, id);
    fastest = std::max(fastest, energy.kinetic);
    EXPECT_NEAR(Sum(energy), stored, 1e-3 * stored);
  }
  EXPECT_GT(fastest, 0.5 * stored);
}

TEST(Energy, KindsTurnIntoOneAnotherAndTheirSumStays) {
  WorldSettings settings;
  settings.precision = Precision::kDouble;
  World world(settings);
  BallDefinition ball;
  ball.material.dampingRatio = 0;
  const BodyId id = world.AddBody(world.AddBlueprint(MakeBall(ball)), {0, 0, 50});
  std::vector<Vector3d> wide;
  VisitVertices(world.ReadBody(id), [&](std::size_t, const Vector3d& x) {
    wide.push_back(Vector3d(0, 0, 50) + 1.05 * (x - Vector3d(0, 0, 50)));
  });
  world.SetMotion(id, wide, std::vector<Vector3d>(wide.size(), Vector3d::Zero()));
  const Energy before = ComputeOf(world, id);
  for (int i = 0; i < 30; ++i) world.Step();
  const Energy after = ComputeOf(world, id);
  EXPECT_GT(after.kinetic, 10 * (before.kinetic + 1));
  EXPECT_NEAR(Sum(after), Sum(before), 1e-3 * after.kinetic);
}

}  // namespace
}  // namespace wobble::physics
