// Captured poses: they have the true rotation and never jump, so that clients can interpolate between them.
#include "server/snapshots/capture.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>

#include "server/physics/shapes/ball.h"
#include "server/snapshots/body_captures.h"
#include "tests/support/captures.h"
#include "tests/support/game.h"
#include "tests/support/places.h"

namespace wobble::server {
namespace {

using physics::Vector3d;

constexpr double kPi = 3.14159265358979323846;

physics::Blueprint MakeSmallBall() {
  physics::BallDefinition definition;
  definition.subdivisions = 1;
  definition.material.mass = 4;
  definition.material.gas = 150;
  return physics::MakeBall(definition);
}

class CaptureTest : public testing::Test {
 protected:
  CaptureTest() : world(physics::WorldSettings{}) { world.AddBlueprint(MakeSmallBall()); }

  // Places the body's vertices at the rest shape under this map, about `centre`. The engine has no such call, because
  // in play only its own steps move vertices.
  void Deform(physics::BodyId id, const Eigen::Matrix3d& map, const Vector3d& centre) {
    auto& body = const_cast<physics::Body&>(world.ReadBody(id));
    auto& state = std::get<physics::State<float>>(body.state);
    state.origin = centre;
    for (std::size_t i = 0; i < state.positions.size(); ++i) {
      state.positions[i] = (map * world.BlueprintOf(body).rest[i]).cast<float>();
    }
  }
  static Eigen::Quaterniond RotationOf(const CapturedBody& body) {
    const protocol::Quaternion& q = body.pose.rotation;
    return {double{q.w}, double{q.x}, double{q.y}, double{q.z}};
  }

  Vector3d FindVertex(physics::BodyId id, std::size_t vertex) {
    Vector3d found;
    physics::VisitVertices(world.ReadBody(id), [&](std::size_t i, const Vector3d& x) {
      if (i == vertex) found = x;
    });
    return found;
  }

  physics::World world;
  std::vector<CapturedBody> bodies;
};

TEST_F(CaptureTest, FindsTheRotationOfARigidlyTurnedBody) {
  const auto id = world.AddBody(0, {0, 0, 0});
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (int i = 0; i < 500; ++i) {  // 20° a capture: 600°/s at 30 Hz, the axis wandering
    const Vector3d axis = Vector3d(std::sin(0.1 * i), std::cos(0.07 * i), 0.5).normalized();
    q = (Eigen::AngleAxisd(20 * kPi / 180, axis) * q).normalized();
    const Vector3d centre(0.1 * i, -3, 50);
    Deform(id, q.toRotationMatrix(), centre);
    test::CaptureAll(world, bodies);
    ASSERT_EQ(bodies.size(), 1U);
    EXPECT_LT(RotationOf(bodies[0]).angularDistance(q), 1e-5) << "capture " << i;
    const auto& c = bodies[0].pose.centroid;
    EXPECT_LT((Vector3d(double{c.x}, double{c.y}, double{c.z}) - centre).norm(), 1e-5);
  }
}

TEST_F(CaptureTest, FindsTheRotationOfADeformedBody) {
  // The rotational part of S R is R when S is symmetric and positive; an icosphere weighs all directions alike.
  const auto id = world.AddBody(0, {0, 0, 0});
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (int i = 0; i < 300; ++i) {
    q = (Eigen::AngleAxisd(0.15, Vector3d(1, 0.3 * std::sin(0.05 * i), 0).normalized()) * q).normalized();
    Eigen::Matrix3d squash = Vector3d(1.2, 1.1, 0.6 + 0.2 * std::sin(0.3 * i)).asDiagonal();
    Deform(id, squash * q.toRotationMatrix(), {0, 0, 1});
    test::CaptureAll(world, bodies);
    EXPECT_LT(RotationOf(bodies[0]).angularDistance(q), 1e-3) << "capture " << i;
  }
}

TEST_F(CaptureTest, DoesNotFlipWhenABodyIsFlattenedOrTurnedInsideOut) {
  // The height falls from 1 to −0.3 times that of the rest shape and back within 2 s, while the body turns at 60°/s.
  const auto id = world.AddBody(0, {0, 0, 0});
  Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
  double worst = 0;
  for (int i = 0; i <= 60; ++i) {
    const double height = 0.35 + 0.65 * std::cos(2 * kPi * i / 60);
    const Eigen::Matrix3d squash = Vector3d(1, 1.1, height).asDiagonal();
    Deform(id, squash * Eigen::AngleAxisd(i * 2 * kPi / 180, Vector3d::UnitZ()).toRotationMatrix(), {0, 0, 1});
    test::CaptureAll(world, bodies);
    const Eigen::Quaterniond q = RotationOf(bodies[0]);
    ASSERT_TRUE(std::isfinite(q.norm()));
    EXPECT_NEAR(q.norm(), 1, 1e-5);
    if (i > 0) worst = std::max(worst, q.angularDistance(last) * 180 / kPi);
    last = q;
  }
  EXPECT_LT(worst, 15);
  EXPECT_GT(worst, 1);  // the pose does follow
}

TEST_F(CaptureTest, ARollingBodyTurnsSmoothlyInPlay) {
  physics::World field(physics::WorldSettings{});
  field.AddBlueprint(MakeSmallBall());
  field.AddObstacle({});
  const auto id = field.AddBody(0, {0, 0, 0.6});
  Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
  double turned = 0;
  double worst = 0;
  for (int tick = 1; tick <= 300; ++tick) {
    physics::Control control;
    control.moveX = 1;
    control.jump = tick % 40 == 0;
    field.SetControl(id, control, {});
    field.Step();
    if (tick % 2 != 0) continue;
    test::CaptureAll(field, bodies);
    const double angle = RotationOf(bodies[0]).angularDistance(last);
    turned += angle;
    worst = std::max(worst, angle);
    last = RotationOf(bodies[0]);
  }
  EXPECT_GT(turned, 2 * kPi);
  EXPECT_LT(worst, 1.5);  // at 6 m/s a ball of 0.5 m rolls 0.4 rad between two snapshots
}

TEST_F(CaptureTest, RemovedBodiesVanishAndLateOnesAppear) {
  for (int i = 0; i < 5; ++i) world.AddBody(0, {2.0 * i, 0, 5});
  BodyCaptures captures;
  captures.Follow(world, world.Tick());
  ASSERT_EQ(captures.Bodies().size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) (void)captures.Read(world, i);

  world.RemoveBody(2);
  world.RemoveBody(5);
  const auto late = world.AddBody(0, {40, 0, 5});
  captures.Follow(world, world.Tick());
  ASSERT_EQ(captures.Bodies().size(), 4U);
  const std::vector<std::uint32_t> expected{1, 3, 4, late};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(captures.Bodies()[i].body, expected[i]);
    const CapturedBody& captured = captures.Read(world, i);
    EXPECT_EQ(captured.body, expected[i]);
    const Vector3d centre = world.FindCentre(world.ReadBody(expected[i]));
    EXPECT_NEAR(double{captured.pose.centroid.x}, centre.x(), 1e-4);
    EXPECT_NEAR(double{captures.Bodies()[i].centre.x}, centre.x(), 1e-4);
  }
  EXPECT_LT(RotationOf(captures.Read(world, 3)).angularDistance(Eigen::Quaterniond::Identity()), 1e-6);

  for (const std::uint32_t id : expected) world.RemoveBody(id);
  captures.Follow(world, world.Tick());
  EXPECT_TRUE(captures.Bodies().empty());
}

TEST_F(CaptureTest, OnlyWhatHasMovedIsCapturedAgain) {
  world.AddObstacle({});
  for (int i = 0; i < 2; ++i) world.AddBody(0, {3.0 * i, 0, 0.6});
  BodyCaptures captures;
  for (int tick = 0; tick < 1200 && !(world.ReadBody(1).asleep && world.ReadBody(2).asleep); ++tick) {
    world.Step();
    captures.Follow(world, world.Tick());
  }
  ASSERT_TRUE(world.ReadBody(1).asleep);
  const std::vector<std::uint64_t> resting{captures.Read(world, 0).version, captures.Read(world, 1).version};
  EXPECT_EQ(captures.Read(world, 0).vertices[0].z, static_cast<float>(FindVertex(1, 0).z())) << "where it came to rest";

  physics::Control control;
  control.jump = true;
  world.SetControl(2, control, {});
  for (int tick = 0; tick < 10; ++tick) {
    world.Step();
    captures.Follow(world, world.Tick());
  }
  EXPECT_EQ(captures.Read(world, 0).version, resting[0]);
  EXPECT_EQ(captures.Read(world, 1).version, resting[1] + 1) << "once, however many ticks";
  EXPECT_NEAR(double{captures.Bodies()[1].centre.z}, world.FindCentre(world.ReadBody(2)).z(), 0.3);
  EXPECT_GT(captures.Bodies()[1].centre.z, captures.Bodies()[0].centre.z + 0.2F);
}

TEST_F(CaptureTest, VerticesAreTheWorlds) {
  const auto id = world.AddBody(0, {100, -7, 3}, {1, 2, 3});
  world.Step();
  test::CaptureAll(world, bodies);
  const auto& state = std::get<physics::State<float>>(world.ReadBody(id).state);
  ASSERT_EQ(bodies[0].vertices.size(), state.positions.size());
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const physics::Vector3f x = (state.origin + state.positions[i].cast<double>()).cast<float>();
    EXPECT_EQ(bodies[0].vertices[i].x, x.x());
    EXPECT_EQ(bodies[0].vertices[i].y, x.y());
    EXPECT_EQ(bodies[0].vertices[i].z, x.z());
  }
}

TEST_F(CaptureTest, BlueprintsArriveAsTheyAre) {
  const physics::Blueprint ball = MakeSmallBall();
  const CapturedBlueprint captured = CaptureBlueprint(ball);
  const protocol::wire::Blueprint* parsed = nullptr;
  ASSERT_EQ(protocol::ParseBlueprint(captured.message, parsed), protocol::ParseResult::kOk);
  EXPECT_EQ(parsed->rest()->size(), 42U);
  EXPECT_EQ(parsed->faces()->size(), 80U);
  EXPECT_EQ(parsed->size(), captured.size);
  EXPECT_NEAR(double{captured.size}, ball.size, 1e-6);
  EXPECT_EQ(captured.hash, protocol::HashBytes(captured.message));
}

TEST(CaptureBlueprint, SendsEdgesOnlyWhereThereAreNoFaces) {
  physics::Blueprint ball = MakeSmallBall();
  const auto read = [](const CapturedBlueprint& captured) {
    const protocol::wire::Blueprint* parsed = nullptr;
    EXPECT_EQ(protocol::ParseBlueprint(captured.message, parsed), protocol::ParseResult::kOk);
    return parsed->edges() == nullptr ? std::size_t{0} : std::size_t{parsed->edges()->size()};
  };
  EXPECT_EQ(read(CaptureBlueprint(ball)), 0U);
  ball.full.faces.clear();
  EXPECT_EQ(read(CaptureBlueprint(ball)), ball.full.springs.size());
  ball.full.springs.resize(protocol::kMaxBlueprintEdges + 5, ball.full.springs[0]);
  EXPECT_EQ(read(CaptureBlueprint(ball)), protocol::kMaxBlueprintEdges);
}

TEST(CaptureObstacles, EveryKindAsTheWireHasIt) {
  using Kind = physics::Obstacle::Kind;
  physics::Obstacle sphere;
  sphere.kind = Kind::kSphere;
  sphere.centre = Vector3d(1, 2, 3);
  sphere.radius = 4;
  physics::Obstacle capsule = sphere;
  capsule.kind = Kind::kCapsule;
  capsule.end = Vector3d(5, 6, 7);
  physics::Obstacle ground;
  ground.kind = Kind::kHeightField;
  ground.centre = Vector3d(-1, -2, 10);
  const std::vector<double> heights{0, 1, 0, 0, 3, 0};
  ground.field = physics::MakeHeightField(3, 2, heights);
  const std::vector<physics::Obstacle> all{sphere, ground, capsule};

  const auto captured = CaptureObstacles(all);
  ASSERT_EQ(captured.size(), 2U) << "ground goes by itself";
  EXPECT_EQ(captured[0].kind(), protocol::wire::ObstacleKind::Sphere);
  EXPECT_EQ(captured[0].a().z(), 3);
  EXPECT_EQ(captured[0].radius(), 4);
  EXPECT_EQ(captured[1].kind(), protocol::wire::ObstacleKind::Capsule);
  EXPECT_EQ(captured[1].b().x(), 5);

  const auto grounds = CaptureGrounds(all);
  ASSERT_EQ(grounds.size(), 1U);
  const protocol::wire::HeightField& field = grounds[0].field;
  EXPECT_EQ(field.columns(), 17) << "eight cells for each of its own";
  EXPECT_EQ(field.rows(), 9);
  EXPECT_EQ(field.cell_size(), 0.25F);
  ASSERT_EQ(grounds[0].heights.size(), 17U * 9);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 17; ++column) {
      const double sent =
          static_cast<double>(field.low()) +
          static_cast<double>(field.step()) * grounds[0].heights[static_cast<std::size_t>(row * 17 + column)];
      EXPECT_NEAR(sent, physics::FindHeight(*ground.field, 0.25 * column, 0.25 * row), 1e-4);
    }
  }
  EXPECT_EQ(field.corner().z(), 10);
}

protocol::ParseResult ParseWelcomeOf(const scenes::Scene& scene) {
  protocol::WelcomeFields fields;
  fields.tickHz = fields.snapshotHz = 60;
  fields.scene = scene.name;
  fields.obstacles = CaptureObstacles(scene.obstacles);
  for (const CapturedGround& ground : CaptureGrounds(scene.obstacles)) fields.heightFields.push_back(ground.field);
  const protocol::wire::ServerMessage* message = nullptr;
  return protocol::ParseServerMessage(protocol::MakeWelcome(fields), message);
}

TEST(CaptureObstacles, ThoseOfEveryShippedSceneAreInTheProtocolsBounds) {
  std::size_t obstacles = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::FindSource("server/scenes"))) {
    if (entry.path().extension() != ".toml") continue;
    const scenes::Scene scene = test::LoadShippedScene(entry.path().stem());
    obstacles += scene.obstacles.size();
    EXPECT_EQ(ParseWelcomeOf(scene), protocol::ParseResult::kOk) << scene.name;
  }
  EXPECT_GT(obstacles, 40U);
}

TEST(CaptureObstacles, WhatASceneMayHaveIsInTheProtocolsBounds) {
  EXPECT_EQ(ParseWelcomeOf(test::MakeYard(R"(
[[obstacle]]
kind = "plane"
normal = [0.3, -1, 1e-5]
offset = -4000
[[obstacle]]
kind = "box"
center = [4000, -4000, 4000]
half_extents = [4000, 0.1, 4000]
[[obstacle]]
kind = "sphere"
center = [-4000, 4000, 4000]
radius = 1000
[[obstacle]]
kind = "capsule"
from = [-4000, 4000, 4000]
to = [4000, -4000, -4000]
radius = 1000
[[obstacle]]
kind = "height_field"
position = [4000, 4000, 4000]
cell_size = 100
heights = [[-1000, 1000], [1000, -1000]]
)")),
            protocol::ParseResult::kOk);
}

}  // namespace
}  // namespace wobble::server
