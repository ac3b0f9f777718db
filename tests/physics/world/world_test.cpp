#include <gtest/gtest.h>

#include <limits>

#include "server/physics/shapes/pair.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"
#include "tests/support/pace.h"

namespace wobble::physics {
namespace {

std::unique_ptr<World> MakeFilledWorld(int threads, Precision precision = Precision::kSingle, int bodies = 12) {
  WorldSettings settings;
  settings.threads = threads;
  settings.precision = precision;
  auto world = std::make_unique<World>(settings);
  world->AddBlueprint(MakeBall(BallDefinition{}));
  world->AddObstacle(Obstacle{});
  for (int i = 0; i < bodies; ++i) world->AddBody(0, Vector3d(i, 0.1 * i, 1 + 0.2 * i), Vector3d(0, 0, -i));
  return world;
}

TEST(World, IsTheSameForAnyNumberOfThreads) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 4}) {
      const auto world = MakeFilledWorld(threads, precision, 8);
      for (int i = 0; i < test::Shorten(80); ++i) world->Step();
      hashes.push_back(world->Hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], hashes[2]);
  }
}

TEST(World, HashSeesTheLastBit) {
  const auto one = MakeFilledWorld(1);
  const auto other = MakeFilledWorld(1);
  EXPECT_EQ(one->Hash(), other->Hash());
  other->PlaceBody(1, Vector3d(0, 0, std::nextafter(1.0, 2.0)));
  EXPECT_NE(one->Hash(), other->Hash());
}

// The place of a body changes only its origin: far from the world's origin it bounces as it does near it.
TEST(World, BodiesFarOutMoveAsAtHome) {
  const auto heightAfter = [](double x) {
    const auto world = MakeFilledWorld(1, Precision::kSingle, 0);
    const BodyId ball = world->AddBody(0, Vector3d(x, 0, 2), Vector3d(1, 0, 0));
    for (int i = 0; i < 90; ++i) world->Step();
    return world->FindCentre(world->ReadBody(ball)).z();
  };
  EXPECT_NEAR(heightAfter(0), heightAfter(4096), 1e-5);
}

TEST(World, OriginFollowsTheBody) {
  const auto world = MakeFilledWorld(1, Precision::kSingle, 0);
  const BodyId ball = world->AddBody(0, Vector3d(0, 0, 500), Vector3d(20, 0, 0));
  for (int i = 0; i < 300; ++i) world->Step();
  const Body& body = world->ReadBody(ball);
  EXPECT_NEAR(world->FindCentre(body).x(), 100, 1e-3);
  const auto& state = std::get<State<float>>(body.state);
  for (const Vector3f& x : state.positions) ASSERT_LT(x.norm(), 4) << "local coordinates stay small";
}

TEST(World, NonFiniteBodyIsResetAloneAndCounted) {
  const auto world = MakeFilledWorld(1);
  const auto control = MakeFilledWorld(1);
  // No call can make such a state, so the test writes it into the body.
  auto& state = const_cast<State<float>&>(std::get<State<float>>(world->ReadBody(3).state));
  state.velocities[7].x() = std::numeric_limits<float>::quiet_NaN();
  const StepReport report = world->Step();
  control->Step();
  EXPECT_EQ(report.nonFinite, 1U);
  EXPECT_EQ(report.inverted, 0U);
  EXPECT_EQ(world->Step().nonFinite, 0U);
  control->Step();
  for (const BodyId other : {1U, 2U, 4U, 5U}) {
    EXPECT_EQ(world->FindCentre(world->ReadBody(other)), control->FindCentre(control->ReadBody(other)));
  }
}

TEST(World, ABodyThatStaysInsideOutIsResetAndCounted) {
  World limp{WorldSettings{}};
  // With so little gas that it cannot turn itself out again, and without an aim, as closed meshes that are not
  // star-shaped.
  BallDefinition definition;
  definition.material.gas = 0.01;
  Blueprint blueprint = MakeBall(definition);
  blueprint.full.aim = blueprint.single.aim = {};
  limp.AddBlueprint(std::move(blueprint));
  World* world = &limp;
  world->AddBody(0, Vector3d(0, 0, 5));
  world->AddBody(0, Vector3d(0, 0, 9));
  auto& state = const_cast<State<float>&>(std::get<State<float>>(world->ReadBody(2).state));
  for (Vector3f& x : state.positions) x = -x;
  int inverted = 0;
  StepReport report;
  for (int tick = 0; tick < 200 && report.reset == 0; ++tick) {
    report = world->Step();
    inverted += static_cast<int>(report.inverted);
  }
  EXPECT_EQ(inverted, 121) << "kInvertedTime and the tick of the reset";
  EXPECT_EQ(report.quarantined, 1U);
  report = world->Step();
  EXPECT_EQ(report.inverted, 0U);
  EXPECT_EQ(report.reset, 0U);
}

TEST(World, JumpsOnceForOnePressAndOnlyFromTheGround) {
  const auto world = MakeFilledWorld(1, Precision::kSingle, 0);
  const BodyId ball = world->AddBody(0, Vector3d(0, 0, 0.5));
  const auto highest = [&](bool jump, int ticks) {
    double top = 0;
    Control control;
    control.jump = jump;
    world->SetControl(ball, control, ControlLimits{});
    for (int i = 0; i < ticks; ++i) {
      world->Step();
      top = std::max(top, world->FindCentre(world->ReadBody(ball)).z());
    }
    return top;
  };
  highest(false, 240);
  const double standing = world->FindCentre(world->ReadBody(ball)).z();
  EXPECT_GT(highest(true, 60), standing + 0.8);  // v²/2g would be 1.8 m for a rigid body
  highest(true, 300);
  EXPECT_LT(highest(true, 120), standing + 0.4) << "holding the key does not jump again";
}

TEST(World, MovesWhereItIsAskedToAndNoFaster) {
  const auto world = MakeFilledWorld(1, Precision::kSingle, 0);
  const BodyId ball = world->AddBody(0, Vector3d(0, 0, 0.5));
  Control control;
  control.moveY = 1;
  world->SetControl(ball, control, ControlLimits{});
  double last = 0;
  for (int i = 0; i < 300; ++i) {
    last = world->FindCentre(world->ReadBody(ball)).y();
    world->Step();
  }
  const Vector3d centre = world->FindCentre(world->ReadBody(ball));
  EXPECT_GT(centre.y(), 10);
  EXPECT_NEAR(centre.x(), 0, 0.5);
  EXPECT_LT((centre.y() - last) * 60, 1.1 * ControlLimits{}.speed);
}

TEST(World, PuffedUpBodyIsLargerAndShrinksAgain) {
  const auto world = MakeFilledWorld(1, Precision::kDouble, 0);
  const BodyId ball = world->AddBody(0, Vector3d(0, 0, 50));
  const auto volume = [&] {
    return ComputeVolume<double>(world->Blueprints()[0].full.faces,
                                 std::get<State<double>>(world->ReadBody(ball).state).positions);
  };
  const double before = volume();
  Control control;
  control.puff = true;
  world->SetControl(ball, control, ControlLimits{});
  for (int i = 0; i < 60; ++i) world->Step();
  EXPECT_GT(volume(), 1.1 * before);
  world->SetControl(ball, Control{}, ControlLimits{});
  double sum = 0;  // the body pulsates, so the mean is compared
  for (int i = 0; i < 120; ++i) {
    world->Step();
    sum += volume();
  }
  EXPECT_NEAR(sum / 120, before, 0.1 * before);
}

// Random trials found bodies that gained energy for ever, since nothing ever stopped this motion.
TEST(World, SetMotionMovesNeitherFixedVerticesNorPlanarBodiesAcrossTheirPlane) {
  PairDefinition pair;
  pair.firstIsFixed = true;
  LatticeDefinition sheet;
  sheet.cells = {2, 0, 2};
  sheet.poissonRatio = FindPoissonRatio(sheet.cells);
  World world{WorldSettings{}};
  world.AddBlueprint(MakePair(pair));
  world.AddBlueprint(MakeLattice(sheet));
  const Vector3d velocity(1, 2, 3);
  for (const std::uint8_t blueprint : {std::uint8_t{0}, std::uint8_t{1}}) {
    const BodyId id = world.AddBody(blueprint, Vector3d(5.0 * blueprint, 0, 10));
    std::vector<Vector3d> positions;
    VisitVertices(world.ReadBody(id), [&](std::size_t, const Vector3d& x) { positions.push_back(x); });
    world.SetMotion(id, positions, std::vector<Vector3d>(positions.size(), velocity));
  }
  const auto& held = std::get<State<float>>(world.ReadBody(1).state).velocities;
  EXPECT_TRUE(held[0].isZero(0));
  EXPECT_TRUE(held[1].isApprox(velocity.cast<float>()));
  for (const auto& v : std::get<State<float>>(world.ReadBody(2).state).velocities) {
    EXPECT_TRUE(v.isApprox(Vector3<float>(1, 0, 3)));
  }
}

TEST(World, RemovedBodiesAreGoneAndIdsAreNotReused) {
  const auto world = MakeFilledWorld(1);
  world->RemoveBody(5);
  EXPECT_EQ(world->Bodies().size(), 11U);
  EXPECT_EQ(world->AddBody(0, Vector3d(0, 0, 1)), 13U);
  world->Step();
  EXPECT_EQ(world->ReadBody(13).id, 13U);
}

// Balls touch the ground and one another: contacts remember anchors, faces and slips, and step choices remember errors.
TEST(World, TwinGoesOnWithTheSameBits) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    const auto world = MakeFilledWorld(1, precision, 0);
    for (int i = 0; i < 4; ++i) world->AddBody(0, Vector3d(0.3 * i, 0.1 * i, 0.6 + 0.9 * i), Vector3d(1, 0, -2));
    for (int i = 0; i < 30; ++i) world->Step();
    World twin(*world, world->Settings());
    for (int i = 0; i < 20; ++i) {
      world->Step();
      twin.Step();
    }
    EXPECT_EQ(world->Hash(), twin.Hash());
    EXPECT_EQ(world->Tick(), twin.Tick());
  }
}

// A twin in double precision and finer ticks moves like its original, and its drives act at the same times.
// Without the losses in gas and in rolling, which act once a tick: of first order in it.
TEST(World, TwinGoesOnInFinerSteps) {
  const auto world = std::make_unique<World>(WorldSettings{});
  BallDefinition ball;
  ball.material.rollingResistance = 0;
  ball.material.gasDampingRatio = 0;
  world->AddBlueprint(MakeBall(ball));
  world->AddObstacle(Obstacle{});
  for (int i = 0; i < 3; ++i) world->AddBody(0, Vector3d(0.3 * i, 0, 0.6 + 0.9 * i));
  Drive push;
  push.force = Vector3d(20, 0, 0);
  push.begin = 0.75;
  push.end = 2;
  world->AddDrive(push);
  for (int i = 0; i < 30; ++i) world->Step();
  WorldSettings fine = world->Settings();
  fine.precision = Precision::kDouble;
  fine.tickDuration /= 8;
  World twin(*world, fine);
  for (int i = 0; i < 30; ++i) world->Step();
  for (int i = 0; i < 240; ++i) twin.Step();
  for (std::size_t i = 0; i < world->Bodies().size(); ++i) {
    EXPECT_NEAR((world->FindCentre(world->Bodies()[i]) - twin.FindCentre(twin.Bodies()[i])).norm(), 0, 1e-3);
  }
}

}  // namespace
}  // namespace wobble::physics
