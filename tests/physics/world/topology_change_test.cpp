// Changes of a body's topology while the world runs: cloth that tears, graphs that are edited; and drives, which follow
// the clock.
#include <gtest/gtest.h>

#include "server/physics/inspect.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"
#include "tests/support/pace.h"
#include "tests/support/replace_blueprint.h"

namespace wobble::physics {
namespace {

ClothDefinition MakeSheet(double tearStretch) {
  ClothDefinition sheet;
  sheet.points = {17, 17};
  sheet.pinned = Pinned::kFrame;
  sheet.tearStretch = tearStretch;
  sheet.material.mass = 4;
  sheet.material.stiffness = 600;
  return sheet;
}

struct Fall {
  std::uint32_t torn = 0;
  std::size_t springsLeft = 0;
  std::size_t facesLeft = 0;
  double ballHeight = 0;
  std::uint32_t quarantined = 0;
  std::uint64_t hash = 0;
};

// Drops a heavy ball onto a sheet in a frame.
Fall DropOnto(const ClothDefinition& sheet, int threads = 1, int ticks = 120) {
  WorldSettings settings;
  settings.threads = threads;
  World world(settings);
  world.AddBlueprint(MakeCloth(sheet));
  BallDefinition ball;
  ball.subdivisions = 1;
  ball.radius = 0.3;
  ball.material.mass = 4;
  ball.material.gas = 400;
  ball.material.stiffness = 600;
  world.AddBlueprint(MakeBall(ball));
  const BodyId cloth = world.AddBody(0, Vector3d(0, 0, 3));
  const BodyId falling = world.AddBody(1, Vector3d(0.05, 0.02, 3.5), Vector3d(0, 0, -8));
  Fall fall;
  for (int tick = 0; tick < ticks || world.ReadBody(cloth).tornTicks > 0; ++tick) {
    const StepReport report = world.Step();
    fall.torn += report.torn;
    fall.quarantined += report.quarantined;
  }
  const Blueprint& left = world.BlueprintOf(world.ReadBody(cloth));
  fall.springsLeft = left.full.springs.size();
  fall.facesLeft = left.full.faces.size();
  fall.ballHeight = world.FindCentre(world.ReadBody(falling)).z();
  fall.hash = world.Hash();
  return fall;
}

TEST(Tearing, ASheetThatCanTearLetsTheBallThrough) {
  const Blueprint whole = MakeCloth(MakeSheet(0));
  const Fall holds = DropOnto(MakeSheet(0));
  EXPECT_EQ(holds.torn, 0U);
  EXPECT_EQ(holds.springsLeft, whole.full.springs.size());
  const Fall tears = DropOnto(MakeSheet(1.3));
  EXPECT_GT(tears.torn, 4U);
  EXPECT_EQ(tears.springsLeft, whole.full.springs.size() - tears.torn) << "torn for good, and each told once";
  EXPECT_LT(tears.facesLeft, whole.full.faces.size());
  EXPECT_LT(tears.ballHeight, 2) << "through";
  EXPECT_GT(holds.ballHeight, 2) << "caught";
  EXPECT_EQ(holds.quarantined + tears.quarantined, 0U);
}

TEST(Tearing, IsTheSameForAnyNumberOfThreads) {
  const int ticks = test::kIsSanitized ? 40 : 120;  // it tears by then
  EXPECT_EQ(DropOnto(MakeSheet(1.3), 1, ticks).hash, DropOnto(MakeSheet(1.3), 4, ticks).hash);
}

TEST(Tearing, APlacedSheetStaysTorn) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeCloth(MakeSheet(1.2)));
  const BodyId cloth = world.AddBody(0, Vector3d(0, 0, 3));
  std::vector<Vector3d> positions;
  VisitVertices(world.ReadBody(cloth), [&](std::size_t, const Vector3d& x) { positions.push_back(x); });
  positions[144] += Vector3d(0, 0, 1);  // pulls the middle out
  world.SetMotion(cloth, positions, std::vector<Vector3d>(positions.size(), Vector3d::Zero()));
  const std::uint32_t torn = world.Step().torn;
  ASSERT_GT(torn, 0U);
  world.PlaceBody(cloth, Vector3d(0, 0, 5));
  for (int tick = 0; tick < 30; ++tick) world.Step();
  const Blueprint whole = MakeCloth(MakeSheet(1.2));
  EXPECT_LE(world.BlueprintOf(world.ReadBody(cloth)).full.springs.size(), whole.full.springs.size() - torn);
}

// Two particles on a spring, one of them fixed.
Blueprint MakePendulum() {
  GraphDefinition graph;
  graph.particles = {{Vector3d(0, 0, 0), 1, true}, {Vector3d(0, 0, -1), 1, false}};
  graph.springs = {{0, 1, 500, 5, 0}};
  return MakeGraph(graph);
}

TEST(Graph, GrowsWhileItRuns) {
  World world(WorldSettings{});
  world.AddBlueprint(MakePendulum());
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
  for (int tick = 0; tick < 60; ++tick) world.Step();
  std::vector<Vector3d> before;
  VisitVertices(world.ReadBody(id), [&](std::size_t, const Vector3d& x) { before.push_back(x); });

  const Blueprint& graph = world.BlueprintOf(world.ReadBody(id));
  GraphEdit grown = AddParticle(graph, {graph.rest[1] + Vector3d(0, 0, -1), 0.5, false});
  ASSERT_TRUE(grown.errors.empty());
  grown = AddSpring(grown.blueprint, {1, 2, 300, 3, 0});
  ASSERT_TRUE(grown.errors.empty());
  ASSERT_TRUE(ReplaceBlueprint(world, id, std::move(grown.blueprint)));

  std::vector<Vector3d> after;
  VisitVertices(world.ReadBody(id), [&](std::size_t, const Vector3d& x) { after.push_back(x); });
  ASSERT_EQ(after.size(), 3U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((after[i] - before[i]).norm(), 1e-6);
  EXPECT_NEAR((after[2] - after[1]).norm(), 1, 0.05);
  for (int tick = 0; tick < 600; ++tick) ASSERT_EQ(world.Step().quarantined, 0U);
  const auto state = std::get<State<float>>(world.ReadBody(id).state);
  // At rest each spring carries the mass that hangs below it: 1.5 kg, 0.5 kg.
  EXPECT_NEAR((state.positions[0] - state.positions[1]).norm(), 1 + 1.5 * 9.81 / 500, 1e-3);
  EXPECT_NEAR((state.positions[1] - state.positions[2]).norm(), 1 + 0.5 * 9.81 / 300, 1e-3);
}

TEST(Graph, IsTunedWhileItRuns) {
  World world(WorldSettings{});
  world.AddBlueprint(MakePendulum());
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
  for (int tick = 0; tick < 600; ++tick) world.Step();
  const auto lengthOf = [&] {
    const auto& x = std::get<State<float>>(world.ReadBody(id).state).positions;
    return static_cast<double>((x[0] - x[1]).norm());
  };
  EXPECT_NEAR(lengthOf(), 1 + 9.81 / 500, 1e-3);
  GraphEdit softer = SetSpring(world.BlueprintOf(world.ReadBody(id)), 0, {0, 1, 100, 5, 0.5});
  ASSERT_TRUE(softer.errors.empty());
  ASSERT_TRUE(ReplaceBlueprint(world, id, std::move(softer.blueprint)));
  for (int tick = 0; tick < 900; ++tick) world.Step();
  EXPECT_NEAR(lengthOf(), 0.5 + 9.81 / 100, 1e-3);
}

std::vector<Vector3d> ListVelocities(const World& world, BodyId id) {
  std::vector<Vector3d> velocities;
  for (const Vector3f& v : std::get<State<float>>(world.ReadBody(id).state).velocities) {
    velocities.push_back(v.cast<double>());
  }
  return velocities;
}

// A heap of particles that is thrown, turns over in the air and lands far from where it was built.
struct Sandbox {
  World world{WorldSettings{}};
  BodyId id = 0;

  Sandbox() {
    GraphDefinition graph;
    graph.particles = {{Vector3d(0, 0, 0), 1, false},
                       {Vector3d(0.5, 0, 0), 2, false},
                       {Vector3d(0, 0.5, 0), 1, false},
                       {Vector3d(0, 0, 0.5), 0.5, false}};
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) graph.springs.push_back({a, b, 300, 3, 0});
    }
    world.AddBlueprint(MakeGraph(graph));
    world.AddObstacle(Obstacle{});
    id = world.AddBody(0, Vector3d(3, 2, 4));
    const VertexForce<double> kick{3, Vector3d(400, 150, 0)};
    world.PushVertices(id, {&kick, 1});
    for (int tick = 0; tick < 20; ++tick) world.Step();
  }

  [[nodiscard]] const Blueprint& Graph() const { return world.BlueprintOf(world.ReadBody(id)); }
  bool Replace(GraphEdit edit) {
    EXPECT_TRUE(edit.errors.empty()) << edit.errors[0].field << " " << edit.errors[0].value;
    return world.ReplaceBlueprint(id, std::move(edit.blueprint), edit.keptParticles);
  }
};

TEST(Sandbox, AParticleComesWhereItIsPutThoughTheBodyFlies) {
  Sandbox sandbox;
  const std::vector<Vector3d> before = ListPositions(sandbox.world, sandbox.id);
  const std::vector<Vector3d> velocities = ListVelocities(sandbox.world, sandbox.id);
  const Vector3d place = before[3] + Vector3d(0.2, -0.3, 0.6);
  ASSERT_TRUE(sandbox.Replace(AddParticle(sandbox.Graph(), before, {place, 0.7, false})));
  ASSERT_TRUE(sandbox.Replace(AddSpring(sandbox.Graph(), {3, 4, 200, 2, 0})));
  EXPECT_NEAR(sandbox.Graph().full.springs.back().restLength, Vector3d(0.2, -0.3, 0.6).norm(), 1e-5)
      << "as far as they are apart";
  const std::vector<Vector3d> after = ListPositions(sandbox.world, sandbox.id);
  ASSERT_EQ(after.size(), 5U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(after[i], before[i]);
    EXPECT_EQ(ListVelocities(sandbox.world, sandbox.id)[i], velocities[i]);
  }
  EXPECT_LT((after[4] - place).norm(), 2e-6);
  EXPECT_EQ(ListVelocities(sandbox.world, sandbox.id)[4].norm(), 0);
  for (int tick = 0; tick < 300; ++tick) ASSERT_EQ(sandbox.world.Step().quarantined, 0U);
}

TEST(Sandbox, ARemovedParticleLeavesTheOthersInTheirMotion) {
  Sandbox sandbox;
  const std::vector<Vector3d> before = ListPositions(sandbox.world, sandbox.id);
  const std::vector<Vector3d> velocities = ListVelocities(sandbox.world, sandbox.id);
  ASSERT_TRUE(sandbox.Replace(RemoveParticle(sandbox.Graph(), 1)));
  const std::vector<Vector3d> after = ListPositions(sandbox.world, sandbox.id);
  ASSERT_EQ(after.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(after[i], before[i == 0 ? 0 : i + 1]);
    EXPECT_EQ(ListVelocities(sandbox.world, sandbox.id)[i], velocities[i == 0 ? 0 : i + 1]);
  }
  for (int tick = 0; tick < 300; ++tick) ASSERT_EQ(sandbox.world.Step().quarantined, 0U);
}

TEST(Sandbox, ContactsFollowTheirParticles) {
  Sandbox sandbox;
  for (int tick = 0; tick < 900; ++tick) sandbox.world.Step();
  const auto contactsOf = [&] { return std::get<State<float>>(sandbox.world.ReadBody(sandbox.id).state).contacts; };
  const auto before = contactsOf();
  const auto others = std::ranges::count_if(before, [](const auto& contact) { return contact.vertex != 0; });
  ASSERT_GT(others, 1);
  ASSERT_TRUE(sandbox.Replace(RemoveParticle(sandbox.Graph(), 0)));
  const auto after = contactsOf();
  ASSERT_EQ(static_cast<long>(after.size()), others);
  std::size_t next = 0;
  for (const auto& contact : before) {
    if (contact.vertex == 0) continue;
    EXPECT_EQ(after[next].vertex, contact.vertex - 1);
    EXPECT_EQ(after[next++].anchor, contact.anchor);
  }
}

TEST(Sandbox, WhatIsFixedStopsAndWhatIsLetGoFalls) {
  Sandbox sandbox;
  ASSERT_TRUE(sandbox.Replace(SetFixed(sandbox.Graph(), 2, true)));
  const Vector3d held = ListPositions(sandbox.world, sandbox.id)[2];
  for (int tick = 0; tick < 30; ++tick) sandbox.world.Step();
  EXPECT_EQ(ListPositions(sandbox.world, sandbox.id)[2], held);
  ASSERT_TRUE(sandbox.Replace(SetFixed(sandbox.Graph(), 2, false)));
  for (int tick = 0; tick < 30; ++tick) sandbox.world.Step();
  EXPECT_GT((ListPositions(sandbox.world, sandbox.id)[2] - held).norm(), 0.3);
}

// Contacts keep what they remember of friction and depth, so the motion is the same to the last bit.
TEST(World, ContactsBetweenBodiesOutliveAChangeOfBlueprint) {
  const auto play = [](bool replace) {
    World world(WorldSettings{});
    world.AddBlueprint(MakeLattice(LatticeDefinition{}));
    world.AddObstacle(Obstacle{});
    const BodyId below = world.AddBody(0, Vector3d(0, 0, 0.38));
    const BodyId above = world.AddBody(0, Vector3d(0.1, 0.05, 1.13));
    for (int tick = 0; tick < 60; ++tick) world.Step();
    EXPECT_TRUE(world.ReadBody(above).touchesBody);
    const bool replaced = replace && ReplaceBlueprint(world, below, world.Blueprints()[0]);
    EXPECT_EQ(replaced, replace);
    for (int tick = 0; tick < 20; ++tick) world.Step();
    EXPECT_TRUE(world.ReadBody(above).touchesBody);
    return world.Hash();
  };
  EXPECT_EQ(play(true), play(false));
}

// Contacts of removed vertices and faces are removed with them, so nothing is read past the end of the remaining ones.
TEST(World, ContactsOfWhatIsGoneAreLetGo) {
  World world(WorldSettings{});
  BallDefinition fine;
  fine.subdivisions = 2;
  world.AddBlueprint(MakeBall(fine));
  world.AddObstacle(Obstacle{});
  const BodyId below = world.AddBody(0, Vector3d(0, 0, 0.6));
  const BodyId above = world.AddBody(0, Vector3d(0.02, 0.01, 1.9));
  for (int tick = 0; tick < 120 && !world.ReadBody(above).touchesBody; ++tick) world.Step();
  for (int tick = 0; tick < 4; ++tick) world.Step();
  ASSERT_TRUE(world.ReadBody(above).touchesBody);
  BallDefinition coarse = fine;
  coarse.subdivisions = 1;
  const std::vector<std::uint16_t> kept{0, 1, 2, 3, 40, 41};
  ASSERT_TRUE(world.ReplaceBlueprint(above, MakeBall(coarse), kept));
  for (const BodyId id : {below, above}) {
    for (const Vector3d& force : InspectForces(world, id).contact) EXPECT_TRUE(force.allFinite());
  }
  for (const auto& contact : std::get<State<float>>(world.ReadBody(above).state).contacts) {
    EXPECT_LT(contact.vertex, kept.size());
  }
  EXPECT_EQ(world.Step().nonFinite, 0U);
}

TEST(Drive, PushesByTheClockAndWakes) {
  World world(WorldSettings{});
  LatticeDefinition cube;
  cube.cells = {1, 1, 1};
  world.AddBlueprint(MakeLattice(cube));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 0.125));
  Drive drive;
  drive.body = id;
  for (std::uint16_t vertex = 0; vertex < 8; ++vertex) drive.vertices.push_back(vertex);
  const double mass = world.Blueprints()[0].totalMass;
  drive.force = Vector3d(2 * mass * 9.81, 0, 0);
  drive.begin = 4;
  drive.end = 4.5;
  drive.period = 1000;
  world.AddDrive(drive);
  for (int tick = 0; tick < 238; ++tick) world.Step();
  EXPECT_TRUE(world.ReadBody(id).asleep);
  EXPECT_NEAR(world.FindCentre(world.ReadBody(id)).x(), 0, 1e-3);
  for (int tick = 0; tick < 4; ++tick) world.Step();
  EXPECT_FALSE(world.ReadBody(id).asleep);
  for (int tick = 0; tick < 60; ++tick) world.Step();
  // The force of 2 g less friction of 0.8 g acts for half a second, then friction alone: more than ½ a t².
  EXPECT_GT(world.FindCentre(world.ReadBody(id)).x(), 1.2);
}

TEST(Drive, WithoutABodyIsWind) {
  World world(WorldSettings{});
  BallDefinition ball;
  ball.material.drag = 1;
  world.AddBlueprint(MakeBall(ball));
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 50));
  Drive gust;
  gust.wind = Vector3d(10, 0, 0);
  gust.end = 2;
  world.AddDrive(gust);
  for (int tick = 0; tick < 60; ++tick) world.Step();
  EXPECT_GT(world.FindCentre(world.ReadBody(id)).x(), 0.2);
}

}  // namespace
}  // namespace wobble::physics
