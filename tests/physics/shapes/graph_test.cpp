// Graphs: the statics of a hanging chain, the bound of the frequency, and changes while the body moves.
#include "server/physics/shapes/graph.h"

#include <gtest/gtest.h>

#include "server/physics/methods/stability.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kGravity = 9.81;

// A chain along x of `count` particles of 0.2 kg on springs of 0.1 m, with one or both ends fixed.
GraphDefinition MakeChain(int count, double stiffness, bool fixLast) {
  GraphDefinition chain;
  for (int i = 0; i < count; ++i) {
    chain.particles.push_back({Vector3d(0.1 * i, 0, 0), 0.2, i == 0 || (fixLast && i == count - 1)});
    if (i > 0) chain.springs.push_back({i - 1, i, stiffness, 1.5, 0});
  }
  return chain;
}

// Positions at rest under gravity, the first particle at the origin. Dashpots along the springs would leave a chain
// swinging for minutes, so its motion is damped here.
std::vector<Vector3d> Hang(const Blueprint& chain) {
  Load<double> load;
  load.acceleration = {0, 0, -kGravity};
  std::vector<Vector3d> x = chain.rest;
  std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  std::vector<Vector3d> a(x.size());
  const double step = 1 / std::max(chain.angularFrequency, chain.dampingRate);
  for (int iteration = 0; iteration < 200000; ++iteration) {
    ComputeAccelerations<double>(chain.full, load, {}, {}, x, v, a);
    for (std::size_t i = 0; i < x.size(); ++i) {
      v[i] = 0.998 * v[i] + step * a[i];
      x[i] += step * v[i];
    }
  }
  for (std::size_t i = x.size(); i-- > 0;) x[i] -= x[0];
  return x;
}

// Each spring carries the mass that hangs below it.
TEST(Graph, HangingChainIsAsLongAsItsWeightMakesIt) {
  GraphDefinition definition = MakeChain(11, 400, false);
  for (Particle& particle : definition.particles) particle.position = Vector3d(0, 0, -particle.position.x());
  const Blueprint chain = MakeGraph(definition);
  const std::vector<Vector3d> x = Hang(chain);
  double z = 0;
  for (int i = 1; i <= 10; ++i) {
    z -= 0.1 + 0.2 * kGravity * (11 - i) / 400;
    EXPECT_NEAR(x[static_cast<std::size_t>(i)].z(), z, 1e-9) << i;
  }
}

// A chain between two walls: at every particle the tensions to the left and right balance its weight, so the horizontal
// part is the same along the chain, and the vertical part changes by m g.
TEST(Graph, ChainBetweenTwoWallsIsInBalance) {
  GraphDefinition definition = MakeChain(21, 1e5, true);
  definition.particles.back().position.x() = 1.6;  // 2 m of chain
  for (GraphSpring& spring : definition.springs) spring.restLength = 0.1;
  for (int i = 1; i < 20; ++i) {
    definition.particles[static_cast<std::size_t>(i)].position = Vector3d(0.08 * i, 0, -0.02 * std::min(i, 20 - i));
  }
  const Blueprint chain = MakeGraph(definition);
  const std::vector<Vector3d> x = Hang(chain);
  std::vector<Vector3d> tensions;
  for (const Spring<double>& spring : chain.full.springs) {
    const Vector3d l = x[spring.b] - x[spring.a];
    tensions.push_back(spring.stiffness * (l.norm() - spring.restLength) * l.normalized());
  }
  for (std::size_t i = 1; i < tensions.size(); ++i) {
    EXPECT_NEAR(tensions[i].x(), tensions[0].x(), 1e-4 * tensions[0].x()) << i;
    EXPECT_NEAR(tensions[i].z() - tensions[i - 1].z(), 0.2 * kGravity, 1e-4 * 0.2 * kGravity) << i;
  }
  EXPECT_NEAR(x[5].z(), x[15].z(), 1e-6) << "even on both sides";
  // The catenary of 2 m between points 1.6 m apart: sag a (cosh(0.8/a) − 1) with 2 a sinh(0.8/a) = 2.
  double low = 0.1;
  double high = 10;
  while (high - low > 1e-12) {
    const double a = (low + high) / 2;
    (a * std::sinh(0.8 / a) > 1 ? low : high) = a;
  }
  const double sag = low * (std::cosh(0.8 / low) - 1);
  EXPECT_NEAR(-x[10].z(), sag, 0.02 * sag) << "but for what the springs stretch";
}

// The bound holds in every shape: the power iteration finds less, and for a long straight chain only just less.
TEST(Graph, FrequencyIsBoundedForEveryShape) {
  GraphDefinition definition = MakeChain(40, 300, false);
  definition.particles[7].mass = 0.05;
  for (const double bend : {0.0, 0.3, 0.9, 1.57}) {
    for (std::size_t i = 0; i < definition.particles.size(); ++i) {
      const double turned = static_cast<double>(i % 2) * bend;
      if (i > 0) {
        definition.particles[i].position =
            definition.particles[i - 1].position + 0.1 * Vector3d(std::cos(turned), 0, std::sin(turned));
      }
    }
    Blueprint chain = MakeGraph(definition);
    const double bound = chain.angularFrequency;
    FindBodyStability(chain);
    const double found = chain.angularFrequency / 1.05;
    EXPECT_LE(found, bound * (1 + 1e-9)) << bend;
    if (bend == 0) {
      EXPECT_GT(found, 0.8 * bound);
    }
  }
}

TEST(Graph, ChangesMakeNewBlueprintsAndLeaveTheOldOne) {
  GraphDefinition definition = MakeChain(3, 400, false);
  const Blueprint first = MakeGraph(definition);
  const GraphEdit more = AddParticle(first, {Vector3d(0, 0, 0.5), 0.7, false});
  ASSERT_TRUE(more.errors.empty());
  EXPECT_EQ(first.rest.size(), 3U);
  ASSERT_EQ(more.blueprint.rest.size(), 4U);
  EXPECT_NEAR(more.blueprint.totalMass, 1.3, 1e-12);
  EXPECT_NEAR((more.blueprint.rest[3] - more.blueprint.rest[0] - (Vector3d(0, 0, 0.5) - first.rest[0])).norm(), 0,
              1e-12);
  EXPECT_EQ(more.blueprint.full.inverseMasses[0], 0) << "fixed as before";
  const GraphEdit joined = AddSpring(more.blueprint, {2, 3, 150, 0.3, 0});
  ASSERT_TRUE(joined.errors.empty());
  ASSERT_EQ(joined.blueprint.full.springs.size(), 3U);
  const Spring<double>& spring = joined.blueprint.full.springs.back();
  EXPECT_NEAR(spring.restLength, (more.blueprint.rest[2] - more.blueprint.rest[3]).norm(), 1e-12);
  EXPECT_EQ(joined.blueprint.single.springs.size(), 3U);
  const GraphEdit tuned = SetSpring(joined.blueprint, 2, {0, 0, 90, 0.1, 0.25});
  ASSERT_TRUE(tuned.errors.empty());
  EXPECT_EQ(tuned.blueprint.full.springs[2].stiffness, 90);
  EXPECT_EQ(tuned.blueprint.full.springs[2].damping, 0.1);
  EXPECT_EQ(tuned.blueprint.full.springs[2].restLength, 0.25);
  EXPECT_EQ(tuned.blueprint.full.springs[2].b, 3U);
  EXPECT_EQ(tuned.blueprint.single.springs[2].stiffness, 90.0F);
  const GraphEdit heavier = SetMass(tuned.blueprint, 3, 2.5);
  ASSERT_TRUE(heavier.errors.empty());
  EXPECT_EQ(heavier.blueprint.full.masses[3], 2.5);
  EXPECT_EQ(heavier.blueprint.full.inverseMasses[3], 1 / 2.5);
  EXPECT_LT(heavier.blueprint.angularFrequency, joined.blueprint.angularFrequency * (1 + 1e-12));
  EXPECT_EQ(joined.blueprint.full.springs[2].stiffness, 150) << "untouched";
}

TEST(Graph, ChangesThatCannotBeAreRefusedWithFieldValueAndRange) {
  const Blueprint chain = MakeGraph(MakeChain(3, 400, false));
  const auto only = [](const GraphEdit& edit) {
    EXPECT_EQ(edit.errors.size(), 1U);
    return edit.errors.empty() ? std::string() : edit.errors[0].field + " = " + edit.errors[0].value;
  };
  EXPECT_EQ(only(AddParticle(chain, {Vector3d(0, 200, 0), 1, false})), "position = 200.0");
  EXPECT_EQ(only(AddParticle(chain, {Vector3d::Zero(), 0, false})), "mass = 0.0");
  EXPECT_EQ(only(AddSpring(chain, {0, 3, 100, 1, 1})), "ends = [0, 3]");
  EXPECT_EQ(only(AddSpring(chain, {1, 1, 100, 1, 1})), "ends = [1, 1]");
  EXPECT_EQ(only(AddSpring(chain, {2, 1, 100, 1, 1})), "ends = [2, 1]");
  EXPECT_EQ(only(AddSpring(chain, {0, 2, -5, 1, 1})), "stiffness = -5.0");
  EXPECT_EQ(only(AddSpring(chain, {0, 2, 1e8, 1, 1})), "stiffness = 100000000.0");  // too fast for its ticks
  EXPECT_EQ(only(SetSpring(chain, 5, {})), "spring = 5");
  EXPECT_EQ(only(SetSpring(chain, 0, {0, 1, 100, -1, 1})), "damping = -1.0");
  EXPECT_EQ(only(SetMass(chain, 9, 1)), "particle = 9");
  EXPECT_EQ(only(SetMass(chain, 1, std::nan(""))), "mass = nan");
  EXPECT_EQ(only(AddParticle(chain, {Vector3d(0, std::nan(""), 0), 1, false})), "position = inf");
  EXPECT_EQ(only(AddParticle(chain, chain.rest, {Vector3d(0, 0, -300), 1, false})), "position = 300.0");
  EXPECT_EQ(only(SetShape(chain, std::vector<Vector3d>{{0, 0, 0}, {0, 0, 0}, {240, 0, 0}})),
            "particle[2].position = 160.0");
  EXPECT_EQ(only(RemoveParticle(chain, 3)), "particle = 3");
  EXPECT_EQ(only(RemoveSpring(chain, 2)), "spring = 2");
  EXPECT_EQ(only(SetFixed(chain, 7, true)), "particle = 7");
  GraphDefinition lone;
  lone.particles.resize(1);
  EXPECT_EQ(only(RemoveParticle(MakeGraph(lone), 0)), "particles = 0");
  GraphDefinition crowd;
  crowd.particles.resize(kMaxParticles);
  EXPECT_EQ(only(AddParticle(MakeGraph(crowd), {})), "particles = 513.0");
}

TEST(Graph, RemovalKeepsTheOrderOfThoseLeft) {
  GraphDefinition definition = MakeChain(5, 400, true);
  definition.springs.push_back({1, 3, 100, 1, 0});
  for (std::size_t i = 0; i < 5; ++i) definition.particles[i].mass = 0.2 + 0.1 * static_cast<double>(i);
  const Blueprint graph = MakeGraph(definition);
  const GraphEdit less = RemoveParticle(graph, 2);
  ASSERT_TRUE(less.errors.empty());
  EXPECT_EQ(less.keptParticles, (std::vector<std::uint16_t>{0, 1, 3, 4}));
  EXPECT_EQ(less.keptSprings, (std::vector<std::uint16_t>{0, 3, 4})) << "those at the third are gone";
  const Coefficients<double>& full = less.blueprint.full;
  ASSERT_EQ(full.masses.size(), 4U);
  ASSERT_EQ(full.springs.size(), 3U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(full.masses[i], graph.full.masses[less.keptParticles[i]]);
    const Vector3d shift = less.blueprint.rest[i] - graph.rest[less.keptParticles[i]];
    EXPECT_LT((shift - (less.blueprint.rest[0] - graph.rest[0])).norm(), 1e-12);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Spring<double>& before = graph.full.springs[less.keptSprings[i]];
    EXPECT_EQ(less.keptParticles[full.springs[i].a], before.a);
    EXPECT_EQ(less.keptParticles[full.springs[i].b], before.b);
    EXPECT_EQ(full.springs[i].stiffness, before.stiffness);
  }
  EXPECT_EQ(full.fixed, (std::vector<std::uint16_t>{0, 3}));
  EXPECT_EQ(full.inverseMasses[3], 0);
  EXPECT_GT(full.inverseMasses[2], 0);
  EXPECT_EQ(less.blueprint.single.springs.size(), 3U);
  const GraphEdit parted = RemoveSpring(less.blueprint, 1);
  ASSERT_TRUE(parted.errors.empty());
  EXPECT_EQ(parted.keptSprings, (std::vector<std::uint16_t>{0, 2}));
  EXPECT_EQ(parted.blueprint.full.springs.size(), 2U);
  EXPECT_EQ(parted.keptParticles.size(), 4U);
}

TEST(Graph, ParticlesAreFixedAndLetGo) {
  const Blueprint chain = MakeGraph(MakeChain(4, 400, false));
  const GraphEdit fixed = SetFixed(chain, 2, true);
  ASSERT_TRUE(fixed.errors.empty());
  EXPECT_EQ(fixed.blueprint.full.fixed, (std::vector<std::uint16_t>{0, 2}));
  EXPECT_EQ(fixed.blueprint.single.inverseMasses[2], 0);
  EXPECT_EQ(SetFixed(fixed.blueprint, 2, true).blueprint.full.fixed.size(), 2U) << "once is enough";
  const GraphEdit free = SetFixed(fixed.blueprint, 0, false);
  ASSERT_TRUE(free.errors.empty());
  EXPECT_EQ(free.blueprint.full.fixed, (std::vector<std::uint16_t>{2}));
  EXPECT_EQ(free.blueprint.full.inverseMasses[0], 1 / 0.2);
}

TEST(Graph, TakesTheShapeThatItsParticlesAreIn) {
  const Blueprint chain = MakeGraph(MakeChain(3, 400, false));
  const std::vector<Vector3d> positions{{50, 20, 3}, {50, 20.2, 3}, {50, 20.2, 3.5}};
  const GraphEdit bent = SetShape(chain, positions);
  ASSERT_TRUE(bent.errors.empty());
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((bent.blueprint.rest[i] - bent.blueprint.rest[0] - positions[i] + positions[0]).norm(), 1e-12);
    moment += bent.blueprint.full.masses[i] * bent.blueprint.rest[i];
  }
  EXPECT_LT(moment.norm(), 1e-12);
  EXPECT_EQ(bent.blueprint.full.springs[0].restLength, chain.full.springs[0].restLength);
  const GraphEdit joined = AddSpring(bent.blueprint, {0, 2, 100, 1, 0});
  ASSERT_TRUE(joined.errors.empty());
  EXPECT_NEAR(joined.blueprint.full.springs.back().restLength, std::hypot(0.2, 0.5), 1e-12);
}

TEST(Graph, OneParticleAloneIsABody) {
  GraphDefinition definition;
  definition.particles.resize(1);
  ASSERT_TRUE(ValidateGraph(definition).empty());
  World world{WorldSettings{}};
  world.AddBlueprint(MakeGraph(definition));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 1));
  for (int tick = 0; tick < 600; ++tick) ASSERT_EQ(world.Step().nonFinite, 0U);
  EXPECT_NEAR(world.FindCentre(world.ReadBody(id)).z(), 0, 0.02) << "it lies on the floor";
}

}  // namespace
}  // namespace wobble::physics
