// The effects of hands on bodies: forces on single vertices, and cuts by blades.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kTick = 1.0 / 60;

WorldSettings MakeWeightless() {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.precision = Precision::kDouble;
  return settings;
}

GraphDefinition MakeParticles(int count) {
  GraphDefinition graph;
  for (int i = 0; i < count; ++i) graph.particles.push_back({Vector3d(i, 0, 0), 2, false});
  return graph;
}

TEST(Push, ActsThroughOneStepAndAddsUp) {
  World world(MakeWeightless());
  world.AddBlueprint(MakeGraph(MakeParticles(2)));
  const BodyId id = world.AddBody(0, Vector3d::Zero());
  const VertexForce<double> push{1, Vector3d(3, 0, -6)};
  world.PushVertices(id, {&push, 1});
  world.PushVertices(id, {&push, 1});
  for (int tick = 0; tick < 5; ++tick) {
    world.Step();
    const auto& v = std::get<State<double>>(world.ReadBody(id).state).velocities;
    EXPECT_LT((v[1] - Vector3d(6, 0, -12) / 2 * kTick).norm(), 1e-12) << "once, however long it goes on";
    EXPECT_EQ(v[0].norm(), 0);
  }
}

TEST(Push, IsAddedToADrive) {
  World world(MakeWeightless());
  world.AddBlueprint(MakeGraph(MakeParticles(1)));
  const BodyId id = world.AddBody(0, Vector3d::Zero());
  Drive drive;
  drive.body = id;
  drive.vertices = {0};
  drive.force = Vector3d(0, 4, 0);
  world.AddDrive(drive);
  const VertexForce<double> push{0, Vector3d(2, 0, 0)};
  world.PushVertices(id, {&push, 1});
  world.Step();
  EXPECT_LT((std::get<State<double>>(world.ReadBody(id).state).velocities[0] - Vector3d(1, 2, 0) * kTick).norm(),
            1e-12);
}

TEST(Push, WakesOneThatSleepsAndNobodyElse) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.2)));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 0.4));
  const BodyId other = world.AddBody(0, Vector3d(5, 0, 0.4));
  for (int tick = 0; tick < 600 && !world.ReadBody(id).asleep; ++tick) world.Step();
  ASSERT_TRUE(world.ReadBody(id).asleep && world.ReadBody(other).asleep);
  world.PushVertices(id, {});
  EXPECT_TRUE(world.ReadBody(id).asleep) << "by nothing";
  const VertexForce<double> push{0, Vector3d(0, 0, 1)};
  world.PushVertices(id, {&push, 1});
  EXPECT_FALSE(world.ReadBody(id).asleep);
  world.Step();
  EXPECT_TRUE(world.ReadBody(other).asleep);
}

TEST(Push, LeavesWhatIsFixedAndThePlaneOfAPlanarBody) {
  World world(MakeWeightless());
  GraphDefinition graph = MakeParticles(2);
  graph.particles[0].fixed = true;
  graph.planar = true;
  world.AddBlueprint(MakeGraph(graph));
  const BodyId id = world.AddBody(0, Vector3d::Zero());
  const VertexForce<double> pushes[] = {{0, Vector3d(5, 5, 5)}, {1, Vector3d(0, 8, 2)}};
  world.PushVertices(id, pushes);
  world.Step();
  const auto& v = std::get<State<double>>(world.ReadBody(id).state).velocities;
  EXPECT_EQ(v[0].norm(), 0);
  EXPECT_LT((v[1] - Vector3d(0, 0, 1) * kTick).norm(), 1e-12);
}

TEST(Push, OfABodyThatIsGoneIsForgotten) {
  World world(MakeWeightless());
  world.AddBlueprint(MakeGraph(MakeParticles(2)));
  const BodyId gone = world.AddBody(0, Vector3d::Zero());
  const BodyId left = world.AddBody(0, Vector3d(0, 5, 0));
  const VertexForce<double> pushes[] = {{0, Vector3d(1, 0, 0)}, {1, Vector3d(0, 0, 4)}};
  world.PushVertices(gone, pushes);
  world.PushVertices(left, pushes);
  world.RemoveBody(gone);
  const GraphEdit edit = RemoveParticle(world.BlueprintOf(world.ReadBody(left)), 0);
  ASSERT_TRUE(world.ReplaceBlueprint(left, edit.blueprint, edit.keptParticles));
  world.Step();
  const auto& v = std::get<State<double>>(world.ReadBody(left).state).velocities;
  ASSERT_EQ(v.size(), 1U);
  EXPECT_LT((v[0] - Vector3d(0, 0, 2) * kTick).norm(), 1e-12) << "the one on the vertex that is left";
}

TEST(Blade, CrossesFromOneSideToTheOther) {
  const Blade blade{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const auto crosses = [&](const Vector3d& p, const Vector3d& q) {
    EXPECT_EQ(IsCrossed(p, q, blade), IsCrossed(q, p, blade));
    const Blade turned{blade[1], blade[2], blade[0]};
    EXPECT_EQ(IsCrossed(p, q, blade), IsCrossed(p, q, turned));
    return IsCrossed(p, q, blade);
  };
  EXPECT_TRUE(crosses({0.2, 0.2, -1}, {0.3, 0.3, 0.1}));
  EXPECT_FALSE(crosses({0.2, 0.2, 0.01}, {0.3, 0.3, 1})) << "does not reach it";
  EXPECT_FALSE(crosses({0.7, 0.7, -1}, {0.7, 0.7, 1})) << "passes beside it";
  EXPECT_TRUE(crosses({0.5, 0, -1}, {0.5, 0, 1})) << "on its border";
  EXPECT_FALSE(crosses({-1, 0.2, 0}, {2, 0.2, 0})) << "in its plane";
  EXPECT_FALSE(crosses({-1, 0.2, 1e-8}, {2, 0.2, -1e-8})) << "in its plane but for rounding";
  EXPECT_TRUE(crosses({0.2, 0.2, 0}, {0.2, 0.2, -1}));
  EXPECT_FALSE(crosses({0.2, 0.2, 0}, {0.2, 0.2, 1})) << "of two that meet in it, one";
  EXPECT_FALSE(crosses({0.2, 0.2, 1}, {0.2, 0.2, 1}));
}

TEST(Blade, WithoutAnAreaCutsNothing) {
  const Vector3d a(0, 0, 0);
  const Vector3d b(1, 0, 0);
  EXPECT_FALSE(IsCrossed({0.5, 0, -1}, {0.5, 0, 1}, {a, b, b}));
  EXPECT_FALSE(IsCrossed({0, 0, -1}, {0, 0, 1}, {a, a, a}));
}

TEST(Blade, LeavesNoGapBesideAnother) {
  // A fan about one corner, and segments through every point of the sides that two of its blades share.
  const Vector3d eye(0.1, 0.2, 0.05);
  const Vector3d rim[] = {{1, 0, 0}, {0.9, 0.35, 0.1}, {0.7, 0.71, 0.2}, {0.3, 0.93, 0.1}};
  for (int i = 1; i < 3; ++i) {
    for (int k = 1; k < 100; ++k) {
      const Vector3d through = eye + k / 101.0 * (rim[i] - eye);
      const Vector3d p = through + Vector3d(0.03, -0.02, 0.4);
      const Vector3d q = through - Vector3d(0.03, -0.02, 0.4);
      EXPECT_TRUE(IsCrossed(p, q, {eye, rim[i - 1], rim[i]}) || IsCrossed(p, q, {eye, rim[i], rim[i + 1]}));
    }
  }
}

// A level blade that crosses everything at this height.
Blade MakeLevelBlade(double z) { return {Vector3d(-50, -50, z), Vector3d(50, -50, z), Vector3d(0, 50, z)}; }

struct CutCloth {
  std::size_t cut = 0;
  std::size_t crossing = 0;     // springs that led across before
  std::size_t springsLeft = 0;  // once the blueprint is without them
  std::size_t facesLeft = 0;
  std::size_t crossingLeft = 0;
  double fall = 0;  // of the part below, m
  double sag = 0;   // of the part above, most, m
  std::uint32_t quarantined = 0;
};

// A curtain that hangs by its upper edge and is cut through between two rows of points.
CutCloth CutACurtain(double tearStretch, Integrator integrator, Precision precision) {
  WorldSettings settings;
  settings.precision = precision;
  World world(settings);
  ClothDefinition curtain;
  curtain.points = {8, 9};
  curtain.pinned = Pinned::kEdge;
  curtain.tearStretch = tearStretch;
  Blueprint blueprint = MakeCloth(curtain);
  SetIntegrator(blueprint, integrator);
  world.AddBlueprint(blueprint);
  const BodyId id = world.AddBody(0, Vector3d(0.3, -0.2, 5));
  for (int tick = 0; tick < 60; ++tick) world.Step();
  const std::vector<Vector3d> before = ListPositions(world, id);
  const double level = (before[3 * 8].z() + before[4 * 8].z()) / 2;
  const auto isBelow = [&](std::uint32_t vertex) { return vertex >= 4 * 8; };
  const auto countCrossing = [&] {
    return static_cast<std::size_t>(
        std::ranges::count_if(world.BlueprintOf(world.ReadBody(id)).full.springs,
                              [&](const auto& spring) { return isBelow(spring.a) != isBelow(spring.b); }));
  };
  CutCloth result;
  result.crossing = countCrossing();
  result.cut = world.CutSprings(id, MakeLevelBlade(level));
  EXPECT_EQ(world.CutSprings(id, MakeLevelBlade(level)), 0U) << "torn already";
  for (int tick = 0; tick < 30; ++tick) result.quarantined += world.Step().quarantined;
  const std::vector<Vector3d> after = ListPositions(world, id);
  result.fall = 1e9;
  for (std::uint32_t i = 0; i < after.size(); ++i) {
    const double down = before[i].z() - after[i].z();
    if (isBelow(i)) result.fall = std::min(result.fall, down);
    if (!isBelow(i)) result.sag = std::max(result.sag, down);
  }
  const Blueprint& left = world.BlueprintOf(world.ReadBody(id));
  result.springsLeft = left.full.springs.size();
  result.facesLeft = left.full.faces.size();
  result.crossingLeft = countCrossing();
  return result;
}

TEST(Blade, ACurtainThatIsCutThroughFallsApart) {
  ClothDefinition curtain;
  curtain.points = {8, 9};
  const Blueprint whole = MakeCloth(curtain);
  for (const Integrator integrator :
       {Integrator::kRungeKutta4, Integrator::kSemiImplicitEuler, Integrator::kVelocityVerlet, Integrator::kLeapFrog,
        Integrator::kPositionVerlet, Integrator::kImplicitEuler}) {
    for (const double tearStretch : {0.0, 1.9}) {
      for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
        const CutCloth result = CutACurtain(tearStretch, integrator, precision);
        const std::string which = std::to_string(static_cast<int>(integrator)) + ", " + std::to_string(tearStretch);
        EXPECT_EQ(result.cut, result.crossing) << which;
        EXPECT_EQ(result.crossingLeft, 0U) << which;
        EXPECT_EQ(result.springsLeft, whole.full.springs.size() - result.cut) << which << ": no other one";
        EXPECT_EQ(result.facesLeft, whole.full.faces.size() - 2 * 7) << which;
        EXPECT_GT(result.fall, 0.8) << which << ": ½ g t² is 1.23 m, less what the air takes";
        EXPECT_LT(result.sag, 0.05) << which;
        EXPECT_EQ(result.quarantined, 0U) << which;
      }
    }
  }
}

// A body of each kind without gas, which is cut through its middle.
struct Kind {
  Blueprint blueprint;
  Blade blade;
};

std::vector<Kind> MakeKinds() {
  GraphDefinition chain;
  for (int i = 0; i < 12; ++i) chain.particles.push_back({Vector3d(0.02 * (i % 3), 0, -0.1 * i), 0.2, i == 0});
  for (int i = 1; i < 12; ++i) chain.springs.push_back({i - 1, i, 300, 1, 0});
  for (int i = 2; i < 12; ++i) chain.springs.push_back({i - 2, i, 50, 0.5, 0});
  LatticeDefinition sheet = MakeJellyCube(0.1);
  sheet.cells = {4, 0, 4};
  ClothDefinition cloth;
  cloth.points = {7, 7};
  cloth.material.drag = 0;  // faces go later than springs
  PairDefinition pair;
  pair.direction = Vector3d(0.1, 0, 1);
  std::vector<Kind> kinds;
  for (Blueprint& blueprint : std::vector{MakeGraph(chain), MakeLattice(MakeJellyCube(0.1)), MakeLattice(sheet),
                                          MakeCloth(cloth), MakePair(pair)}) {
    kinds.push_back({std::move(blueprint), MakeLevelBlade(0.02)});
  }
  return kinds;
}

Blade Move(Blade blade, const Vector3d& by) {
  for (Vector3d& corner : blade) corner += by;
  return blade;
}

// Before its blueprint is made anew, a body that was cut moves like one that never had the cut springs.
TEST(Blade, WhatIsCutMovesAsIfTheSpringsHadNeverBeen) {
  for (const Kind& kind : MakeKinds()) {
    for (const int count : {1, 7}) {
      std::vector<std::uint8_t> torn(kind.blueprint.full.springs.size(), 0);
      ASSERT_GT(FindCut<double>(kind.blueprint.full, kind.blade, kind.blueprint.rest, torn), 0U);
      WorldSettings settings;
      settings.precision = Precision::kDouble;
      World cut(settings);
      World made(settings);
      cut.AddBlueprint(kind.blueprint);
      made.AddBlueprint(MakeTornBlueprint(kind.blueprint, torn));
      std::vector<BodyId> ids;
      for (int i = 0; i < count; ++i) {
        const Vector3d at(10 * i, 0, 5);
        ids.push_back(cut.AddBody(0, at));
        made.AddBody(0, at);
        EXPECT_EQ(cut.CutSprings(ids.back(), Move(kind.blade, at)),
                  static_cast<std::size_t>(std::ranges::count(torn, 1)));
        std::vector<Vector3d> shaken = Deform(ListPositions(cut, ids.back()), 0.01);
        if (kind.blueprint.full.planar) {
          for (Vector3d& x : shaken) x.y() = 0;
        }
        const std::vector<Vector3d> still(shaken.size(), Vector3d::Zero());
        cut.SetMotion(ids.back(), shaken, still);
        made.SetMotion(ids.back(), shaken, still);
      }
      for (int tick = 0; tick < 12; ++tick) {
        cut.Step();
        made.Step();
      }
      for (const BodyId id : ids) {
        EXPECT_EQ(cut.BlueprintOf(cut.ReadBody(id)).full.springs.size(), torn.size()) << "not yet made anew";
        const std::vector<Vector3d> a = ListPositions(cut, id);
        const std::vector<Vector3d> b = ListPositions(made, id);
        for (std::size_t i = 0; i < a.size(); ++i) {
          EXPECT_LT((a[i] - b[i]).norm(), 1e-9) << kind.blueprint.name << ", " << count;
        }
      }
    }
  }
}

// Of seven bodies of each kind some are cut, so that cut and whole ones share packs of every width.
TEST(Blade, DoesTheSameForAnyNumberOfLanesAndThreads) {
  const auto play = [](int widest, int threads) {
    WorldSettings settings;
    settings.widestPack = widest;
    settings.threads = threads;
    World world(settings);
    world.AddObstacle(Obstacle{});
    const std::vector<Kind> kinds = MakeKinds();
    for (const Kind& kind : kinds) world.AddBlueprint(kind.blueprint);
    for (int i = 0; i < 35; ++i) {
      const Vector3d at(2.0 * i, 0.1 * i, 1.5);
      const BodyId id = world.AddBody(static_cast<std::uint8_t>(i % 5), at, Vector3d(0, 0, -1));
      if (i % 4 == 0) continue;
      EXPECT_GT(world.CutSprings(id, Move(kinds[i % 5].blade, at)), 0U);
    }
    for (int tick = 0; tick < 40; ++tick) {
      const VertexForce<double> push{1, Vector3d(1, 2, 3)};
      for (BodyId id = 1; id <= 35; id += 3) world.PushVertices(id, {&push, 1});
      world.Step();
    }
    return world.Hash();
  };
  const std::uint64_t hash = play(16, 1);
  EXPECT_EQ(hash, play(1, 1));
  EXPECT_EQ(hash, play(8, 1));
  EXPECT_EQ(hash, play(16, 3));
}

TEST(Blade, DoesNotLetGasOut) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeBall(BallDefinition{}));
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
  EXPECT_EQ(world.CutSprings(id, MakeLevelBlade(5)), 0U);
  world.Step();
  EXPECT_TRUE(std::get<State<float>>(world.ReadBody(id).state).torn.empty());
}

TEST(Blade, ThatMissesLeavesEverythingAsItWas) {
  World world(WorldSettings{});
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.2)));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 0.4));
  for (int tick = 0; tick < 600 && !world.ReadBody(id).asleep; ++tick) world.Step();
  ASSERT_TRUE(world.ReadBody(id).asleep);
  EXPECT_EQ(world.CutSprings(id, MakeLevelBlade(3)), 0U);
  EXPECT_TRUE(world.ReadBody(id).asleep);
  EXPECT_TRUE(std::get<State<float>>(world.ReadBody(id).state).torn.empty());
  EXPECT_GT(world.CutSprings(id, MakeLevelBlade(world.FindCentre(world.ReadBody(id)).z())), 0U);
  EXPECT_FALSE(world.ReadBody(id).asleep);
}

TEST(Blade, WakesWhoLiesOnWhatItCuts) {
  World world(WorldSettings{});
  ClothDefinition sheet;
  sheet.points = {11, 11};
  sheet.orientation = Orientation::kHorizontal;
  sheet.pinned = Pinned::kFrame;
  sheet.material.mass = 2;
  sheet.material.stiffness = 400;
  world.AddBlueprint(MakeCloth(sheet));
  LatticeDefinition cube = MakeJellyCube(0.5);
  cube.cells = {2, 2, 2};
  cube.cellSize = 0.15;
  world.AddBlueprint(MakeLattice(cube));
  const BodyId cloth = world.AddBody(0, Vector3d(0, 0, 2));
  const BodyId lying = world.AddBody(1, Vector3d(0, 0, 2.16));
  for (int tick = 0; tick < 3000 && !world.ReadBody(lying).asleep; ++tick) world.Step();
  ASSERT_TRUE(world.ReadBody(lying).asleep && world.ReadBody(cloth).asleep);
  const double height = world.FindCentre(world.ReadBody(lying)).z();
  for (const double x : {-0.27, 0.27}) {
    world.CutSprings(cloth, {Vector3d(x, -5, 2), Vector3d(x, 5, -3), Vector3d(x, 5, 7)});
  }
  EXPECT_FALSE(world.ReadBody(lying).asleep);
  for (const double y : {-0.27, 0.27}) {
    world.CutSprings(cloth, {Vector3d(-5, y, 2), Vector3d(5, y, -3), Vector3d(5, y, 7)});
  }
  for (int tick = 0; tick < 60; ++tick) world.Step();
  EXPECT_LT(world.FindCentre(world.ReadBody(lying)).z(), height - 2) << "down it goes";
}

TEST(Blade, IsRememberedWhenTheBlueprintIsReplaced) {
  World world(MakeWeightless());
  GraphDefinition chain = MakeParticles(5);
  for (int i = 1; i < 5; ++i) chain.springs.push_back({i - 1, i, 100, 1, 0});
  world.AddBlueprint(MakeGraph(chain));
  const BodyId id = world.AddBody(0, Vector3d::Zero());
  const double x = ListPositions(world, id)[2].x() + 0.5;
  EXPECT_EQ(world.CutSprings(id, {Vector3d(x, -5, -5), Vector3d(x, 5, -5), Vector3d(x, 0, 9)}), 1U);
  const GraphEdit edit = RemoveParticle(world.BlueprintOf(world.ReadBody(id)), 0);
  ASSERT_TRUE(world.ReplaceBlueprint(id, edit.blueprint, edit.keptParticles));
  for (int tick = 0; tick < 20; ++tick) world.Step();
  const auto& springs = world.BlueprintOf(world.ReadBody(id)).full.springs;
  ASSERT_EQ(springs.size(), 2U) << "of four one has gone with its particle and one was cut";
  EXPECT_EQ(springs[0].a + springs[0].b, 1U);
  EXPECT_EQ(springs[1].a + springs[1].b, 5U);
}

}  // namespace
}  // namespace wobble::physics
