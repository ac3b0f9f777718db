// Cores keep closed bodies from passing through one another: the spring by itself, then in worlds.
#include "server/physics/skins/core_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world_state.h"
#include "tests/bench/stress/shots.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kPlayTick = 1.0 / 60;
constexpr double kMargin = 0.02;

struct Cores {
  CoreBody first{.mass = 3, .radius = 0.5};
  CoreBody second{.mass = 6, .radius = 0.3};
  CoreContact contact;

  void Look(double distance, double approach) {
    UpdateCoreContact(first, second, Vector3d(0, 0, distance), Vector3d(0.7, 0, -approach), kPlayTick, kMargin,
                      contact);
  }
};

TEST(CoreContact, TakesUpTheEnergyOfTheApproach) {
  Cores cores;
  cores.Look(1, 50);
  ASSERT_TRUE(cores.contact.MayAct());  // within the tick
  const double range = cores.contact.range;
  EXPECT_GT(range, 0.2);
  EXPECT_LT(range, 0.8);
  const double energy = 2 * 50 * 50 / 2.0;  // of the reduced mass
  EXPECT_EQ(FindCoreEnergy(cores.contact, Vector3d(0, range, 0)), 0);
  EXPECT_NEAR(FindCoreEnergy(cores.contact, Vector3d(0, range / 2, 0)), energy, 1e-9 * energy);
}

TEST(CoreContact, IsTheGradientOfItsEnergy) {
  Cores cores;
  cores.Look(1, 50);
  const Vector3d apart(0.05, -0.1, 0.12);
  const Vector3d force = FindCoreForce(cores.contact, apart);
  EXPECT_GT(force.norm(), 1);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d step = 1e-6 * Vector3d::Unit(axis);
    const double slope =
        (FindCoreEnergy(cores.contact, apart + step) - FindCoreEnergy(cores.contact, apart - step)) / 2e-6;
    EXPECT_NEAR(force[axis], -slope, 1e-6 * force.norm());
  }
  EXPECT_EQ(FindCoreForce(cores.contact, Vector3d(0, 0, cores.contact.range)).norm(), 0);
  EXPECT_EQ(FindCoreForce(cores.contact, Vector3d::Zero()).norm(), 0);
}

TEST(CoreContact, BeginsOnceTheCoresHaveBeenApart) {
  Cores cores;
  cores.Look(0.1, 50);
  EXPECT_FALSE(cores.contact.MayAct());
  cores.Look(0.7, 50);  // the one is still in the other
  EXPECT_EQ(cores.contact.stiffness, 0);
  cores.Look(0.8, 50);
  EXPECT_GT(cores.contact.stiffness, 0);
}

TEST(CoreContact, KeepsItsStiffnessInsideAndForgetsItOutside) {
  Cores cores;
  cores.Look(1, 50);
  const double stiffness = cores.contact.stiffness;
  cores.Look(0.1, 0);
  EXPECT_EQ(cores.contact.stiffness, stiffness);
  EXPECT_TRUE(cores.contact.MayAct());
  cores.Look(0.7, -40);
  EXPECT_EQ(cores.contact.stiffness, 0);
  cores.Look(0.7, 0.1);
  EXPECT_LT(cores.contact.stiffness, 1e-5 * stiffness);
  EXPECT_FALSE(cores.contact.MayAct());  // it is too far for this tick
}

TEST(CoreContact, RadiiLieWithinTheBodies) {
  EXPECT_NEAR(MakeLattice(MakeJellyCube()).coreRadius, 0.375, 1e-9);
  const double ofBall = MakeBall(BallDefinition{}).coreRadius;
  EXPECT_GT(ofBall, 0.45);
  EXPECT_LT(ofBall, 0.5);
}

// Of the head-on shots of the laboratory's stress part some that passed through before there were cores: balls, cubes
// of springs and solids at 36 to 92 m/s.
TEST(CoreContact, NothingGoesThroughHeadOn) {
  for (const std::size_t number : {23, 28, 243, 508, 568, 778, 963}) {
    const bench::StressShot shot = bench::PlayStressShot(1, number);
    ASSERT_EQ(shot.target, bench::StressTarget::kBody) << number;
    EXPECT_FALSE(shot.through || shot.hangs)
        << "shot " << number << ", " << bench::NameStressBody(shot.body) << " at " << shot.speed;
    EXPECT_EQ(shot.outcome.reset + shot.outcome.nonFinite, 0U) << number;
  }
}

// A ball and a cube that meet head on, off the middle by a little.
std::unique_ptr<World> MakeHeadOn(double tick, Precision precision, double friction = 0.8) {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  settings.precision = precision;
  settings.tickDuration = tick;
  auto world = std::make_unique<World>(settings);
  BallDefinition ball;
  ball.material.friction = friction;
  LatticeDefinition cube = MakeJellyCube();
  cube.friction = friction;
  world->AddBlueprint(MakeBall(ball));
  world->AddBlueprint(MakeLattice(cube));
  world->AddBody(0, Vector3d(-0.8, 0.03, 0.02), Vector3d(30, 0, 0));
  world->AddBody(1, Vector3d(0.8, -0.03, 0), Vector3d(-30, 0.2, 0.1));
  return world;
}

double FindDistance(const World& world) {
  return (world.FindCentre(world.Bodies()[1]) - world.FindCentre(world.Bodies()[0])).norm();
}

// Without friction, which gives up a part of its torque on faces that are squashed thin (skins/body_contact.cpp).
TEST(CoreContact, KeepsMomentumAndAngularMomentum) {
  const auto world = MakeHeadOn(kPlayTick / 64, Precision::kDouble, 0);
  const auto addUp = [&world] {
    Vector3d momentum = Vector3d::Zero();
    Vector3d angular = Vector3d::Zero();
    for (const Body& body : world->Bodies()) {
      const auto& state = std::get<State<double>>(body.state);
      VisitVertices(body, [&](std::size_t i, const Vector3d& x) {
        const Vector3d part = world->BlueprintOf(body).full.masses[i] * state.velocities[i];
        momentum += part;
        angular += x.cross(part);
      });
    }
    return std::pair(momentum, angular);
  };
  const auto [momentum, angular] = addUp();
  double nearest = 1;
  for (int tick = 0; tick < 8 * 64; ++tick) {
    world->Step();
    nearest = std::min(nearest, FindDistance(*world));
  }
  EXPECT_LT(nearest, 0.3);  // the cores have met
  const auto [momentumAfter, angularAfter] = addUp();
  const double scale = 8 * 30;
  EXPECT_LT((momentumAfter - momentum).norm(), 1e-11 * scale);
  EXPECT_LT((angularAfter - angular).norm(), 1e-9 * scale);
}

// What a stored world has of a core: without it the copy would go on without the spring.
TEST(CoreContact, IsStored) {
  const auto world = MakeHeadOn(kPlayTick / 16, Precision::kSingle);
  while (FindDistance(*world) > 0.3) world->Step();
  const auto copy = MakeHeadOn(kPlayTick / 16, Precision::kSingle);
  ASSERT_EQ(copy->Restore(world->Capture()), "");
  for (int tick = 0; tick < 32; ++tick) {
    world->Step();
    copy->Step();
    ASSERT_EQ(world->Hash(), copy->Hash()) << tick;
  }
  EXPECT_GT(FindDistance(*world), 0.3);
}

}  // namespace
}  // namespace wobble::physics
