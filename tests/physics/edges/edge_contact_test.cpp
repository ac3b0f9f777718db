// Edge contacts: the law by itself, then rods on rods, on skins, on nets, and planar bodies in their plane.
#include "server/physics/edges/edge_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/shapes/ring.h"
#include "server/physics/skins/body_contact_update.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kPace = 1.0 / 60;

// Two edges that touch, and what the contact between them needs.
struct TwoEdges {
  std::array<EdgeEnds, 2> edges{EdgeEnds{0, 1}, EdgeEnds{2, 3}};
  std::vector<Vector3d> x = std::vector<Vector3d>(4);
  std::vector<Vector3d> v = std::vector<Vector3d>(4, Vector3d::Zero());
  std::vector<double> shares = std::vector<double>(4, 1);
  ContactParameters<double> parameters;
  EdgeContact<double> contact;

  explicit TwoEdges(std::mt19937& random) {
    std::uniform_real_distribution<double> of(-1, 1);
    const auto draw = [&] { return Vector3d(of(random), of(random), of(random)); };
    for (Vector3d& each : x) each = draw();
    for (Vector3d& each : v) each = draw();
    Material material;
    material.stiffness = 1000;
    parameters = MakeContactParameters(material, 1, 0.5);
    contact.phase = EdgePhase::kTouching;
    // Move the first edge so that both are 2 to 5 cm apart, whatever their nearest points are.
    for (int i = 0; i < 3; ++i) {
      const EdgeView<double> view = See(Vector3d::Zero());
      const Vector3d to = (0.035 + 0.015 * of(random) - view.distance) * view.normal;
      x[0] += to;
      x[1] += to;
    }
    const EdgeView<double> view = See(Vector3d::Zero());
    contact.normal = view.normal;
    contact.s = view.s;
    contact.t = view.t;
    contact.slip = 0.01 * RemoveNormalPart<double>(draw(), view.normal);
  }

  [[nodiscard]] EdgeMeeting<double> Meet() const {
    return {.first = {std::span(edges).first(1), x, v, shares},
            .second = {std::span(edges).last(1), x, v, shares},
            .shift = Vector3d::Zero(),
            .radius = 0.06};
  }
  [[nodiscard]] EdgeView<double> See(const Vector3d& normal) const { return FindEdgeView(Meet(), 0, 0, normal); }
  [[nodiscard]] EdgeForce<double> Force() const {
    std::array<EdgeForce<double>, 1> forces;
    ComputeEdgeContacts<double>(parameters, Meet(), {&contact, 1}, forces);
    return forces[0];
  }
  [[nodiscard]] double Energy() const { return ComputeEdgeContactEnergy<double>(parameters, Meet(), {&contact, 1}); }
};

TEST(EdgeContact, NormalForceIsTheGradientOfTheEnergy) {
  std::mt19937 random(1);
  int acted = 0;
  for (int trial = 0; trial < 300; ++trial) {
    TwoEdges two(random);
    two.contact.phase = EdgePhase::kFree;
    two.parameters.stickDamping = 0;
    std::ranges::fill(two.v, Vector3d::Zero());
    const EdgeForce<double> force = two.Force();
    if (!force.acts) continue;
    ++acted;
    for (std::size_t end = 0; end < 4; ++end) {
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kShift = 1e-6;
        const double at = two.x[end][axis];
        two.x[end][axis] = at + kShift;
        const double above = two.Energy();
        two.x[end][axis] = at - kShift;
        const double below = two.Energy();
        two.x[end][axis] = at;
        EXPECT_NEAR(force.forces[end][axis], -(above - below) / (2 * kShift), 2e-3) << trial << " end " << end;
      }
    }
  }
  EXPECT_GT(acted, 250);
}

TEST(EdgeContact, ForcesWithFrictionKeepBothMomenta) {
  std::mt19937 random(2);
  double mostFriction = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TwoEdges two(random);
    const EdgeForce<double> force = two.Force();
    if (!force.acts) continue;
    Vector3d sum = Vector3d::Zero();
    Vector3d torque = Vector3d::Zero();
    for (std::size_t end = 0; end < 4; ++end) {
      sum += force.forces[end];
      torque += two.x[end].cross(force.forces[end]);
    }
    EXPECT_LT(sum.norm(), 1e-10) << trial;
    EXPECT_LT(torque.norm(), 1e-10) << trial;
    const Vector3d onFirst = force.forces[0] + force.forces[1];
    mostFriction = std::max(mostFriction, RemoveNormalPart<double>(onFirst, two.contact.normal).norm());
  }
  EXPECT_GT(mostFriction, 1) << "N: friction takes part";
}

// The sense lasts: an edge that is carried past the other's axis is pushed back to where it came from.
TEST(EdgeContact, PushesBackFromBeyondTheAxis) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    TwoEdges two(random);
    const Vector3d from = two.contact.normal;
    const EdgeView<double> before = two.See(from);
    if (!before.first.inside || !before.second.inside) continue;
    for (const std::size_t end : {0U, 1U}) two.x[end] -= (before.distance + 0.01) * from;
    std::ranges::fill(two.v, Vector3d::Zero());
    const EdgeForce<double> force = two.Force();
    ASSERT_TRUE(force.acts);
    EXPECT_NEAR(two.See(from).distance, -0.01, 1e-9);
    EXPECT_GT((force.forces[0] + force.forces[1]).dot(from), 0) << trial;
  }
}

// What is left out without a view, because the remembered normal separates two edges, has no force, and nothing else
// is left out: near, apart, past one another's axes, and with normals that no longer fit.
TEST(EdgeContact, ActsWhereItsViewIsDeepAndNowhereElse) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> of(-1, 1);
  int acted = 0;
  int apart = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    TwoEdges two(random);
    two.contact.phase = EdgePhase::kFree;
    const Vector3d way = 0.2 * of(random) * two.contact.normal + 0.1 * Vector3d(of(random), of(random), of(random));
    for (const std::size_t end : {0U, 1U}) two.x[end] += way;
    if (trial % 3 == 0) two.contact.normal = Vector3d(of(random), of(random), of(random)).normalized();
    const bool isDeep = two.See(two.contact.normal).distance < two.Meet().radius;
    EXPECT_EQ(two.Force().acts, isDeep) << trial;
    (isDeep ? acted : apart) += 1;
  }
  EXPECT_GT(std::min(acted, apart), 500);
}

// Nearly parallel edges have their nearest points wherever rounding puts them, unless these are found in double
// precision: in single precision edges 34 cm apart touched now and then, and energy came from nowhere.
TEST(EdgeContact, NearlyParallelEdgesAreAsFarInSinglePrecision) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> of(-1, 1);
  const std::array<EdgeEnds, 1> edges{EdgeEnds{0, 1}};
  const std::vector<Vector3f> v(2, Vector3f::Zero());
  const std::vector<double> shares(2, 1);
  const std::vector<float> sharesSingle(2, 1);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto draw = [&] { return Vector3d(of(random), of(random), of(random)); };
    const Vector3d along = draw();
    const double angle = std::pow(10.0, -2 + 2 * of(random));
    const Vector3d side = 0.3 * draw();
    const std::vector<Vector3f> first{Vector3f::Zero(), along.cast<float>()};
    const std::vector<Vector3f> second{side.cast<float>(), (side + along + angle * draw()).cast<float>()};
    const auto widen = [](const std::vector<Vector3f>& x) {
      return std::vector<Vector3d>{x[0].cast<double>(), x[1].cast<double>()};
    };
    const std::vector<Vector3d> a = widen(first);
    const std::vector<Vector3d> b = widen(second);
    const std::vector<Vector3d> still(2, Vector3d::Zero());
    const EdgeMeeting<float> single{.first = {edges, first, v, sharesSingle},
                                    .second = {edges, second, v, sharesSingle}};
    const EdgeMeeting<double> exact{.first = {edges, a, still, shares}, .second = {edges, b, still, shares}};
    EXPECT_NEAR(FindEdgeView<float>(single, 0, 0, Vector3f::Zero()).distance,
                FindEdgeView<double>(exact, 0, 0, Vector3d::Zero()).distance, 1e-6)
        << trial << " angle " << angle;
  }
}

// An end that is carried round another edge's end leaves it as far as it is, whatever side it came from.
TEST(EdgeContact, AnEndThatGoesRoundAnotherIsNotPulledBack) {
  const std::array<EdgeEnds, 1> edges{EdgeEnds{0, 1}};
  const std::vector<Vector3d> fixed{Vector3d::Zero(), Vector3d(-1, 0, 0)};
  const std::vector<Vector3d> still(2, Vector3d::Zero());
  const std::vector<double> shares(2, 1);
  Vector3d normal = -Vector3d::UnitZ();
  for (int degree = -80; degree <= 80; degree += 40) {
    const double angle = degree * std::numbers::pi / 180;
    const Vector3d out(std::cos(angle), 0, std::sin(angle));
    const std::vector<Vector3d> moving{0.05 * out, out};
    const EdgeMeeting<double> meeting{.first = {edges, moving, still, shares}, .second = {edges, fixed, still, shares}};
    const EdgeView<double> view = FindEdgeView<double>(meeting, 0, 0, normal);
    EXPECT_NEAR(view.distance, 0.05, 1e-9) << degree;
    normal = -view.normal;  // the worst that a substep can leave behind
  }
}

// A rod's end near one triangle, which is an open skin.
struct EndAtBorder {
  static constexpr double kRadius = 0.03;
  std::array<Face, 1> faces{Face{0, 1, 2}};
  Topology topology = MakeTopology(faces, 3);
  std::vector<Vector3d> corners{Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY()};
  std::vector<Vector3d> still = std::vector<Vector3d>(3, Vector3d::Zero());
  std::vector<double> shares{1};
  std::vector<Vector3d> x;
  BodyContact<double> contact;

  explicit EndAtBorder(const Vector3d& at) : x{at} {}
  void Update() {
    Material material;
    material.stiffness = 1000;
    const Meeting<double> meeting{.x = x,
                                  .v = std::span(still).first(1),
                                  .shares = shares,
                                  .skin = {.faces = faces, .topology = &topology, .x = corners, .offset = kRadius},
                                  .skinV = still};
    UpdateBodyContacts<double>(MakeContactParameters(material, 1, 0.5), meeting, 1e-3, {&contact, 1});
  }
};

// Past the border of an open skin a rod's end belongs to the side that it is on, and is as deep as the border is nearer
// than its radius.
TEST(EdgeContact, ARodThatRoundsABorderIsNoDeeperOnTheOtherSide) {
  for (const double height : {0.027, 0.02, 0.001, -0.001, -0.02}) {
    EndAtBorder end(Vector3d(0.4, -0.01, height));
    const double depth = EndAtBorder::kRadius - std::hypot(height, 0.01);
    end.contact = {.phase = ContactPhase::kTouching, .maxDepth = 1, .depth = depth, .foot = Vector3d(0.61, 0.4, -0.01)};
    end.Update();
    EXPECT_EQ(end.contact.side, height > 0 ? SkinSide::kFront : SkinSide::kBack) << height;
    EXPECT_NEAR(end.contact.depth, depth, 1e-9) << height;
  }
}

// Past the border it is not pushed, however near it is to the plane; when it comes in from there faster than it can
// have moved, nobody has pressed the spring that its depth would be.
TEST(EdgeContact, ARodThatComesInFromBesideIsNotDeep) {
  EndAtBorder end(Vector3d(0.4, -0.05, 0.01));
  end.contact = {.phase = ContactPhase::kArmed, .maxDepth = 1, .foot = Vector3d(0.65, 0.4, -0.05)};
  end.Update();
  EXPECT_EQ(end.contact.phase, ContactPhase::kArmed);
  end.x[0].y() = -0.02;
  end.Update();
  EXPECT_LT(end.contact.depth, 1e-9);
  end.x[0].z() = 0.006;
  end.Update();
  EXPECT_NEAR(end.contact.depth, std::hypot(0.02, 0.01) - std::hypot(0.02, 0.006), 1e-9)
      << "what it presses itself counts";
  EXPECT_EQ(end.contact.phase, ContactPhase::kTouching);
}

// A rod that turns has other nearest points before the tick is over: its contact asks for substeps though the present
// ones do not come nearer.
TEST(EdgeContact, ATurningRodIsReckonedWith) {
  std::mt19937 random(5);
  TwoEdges two(random);
  two.x = {Vector3d(-0.5, 0, 0.1), Vector3d(0.5, 0, 0.1), Vector3d(0, -0.5, 0), Vector3d(0, 0.5, 0)};
  two.v = {Vector3d(0, 0, -10), Vector3d(0, 0, 10), Vector3d::Zero(), Vector3d::Zero()};
  const EdgeView<double> view = two.See(Vector3d::Zero());
  ASSERT_NEAR(view.distance, 0.1, 1e-9);
  ASSERT_NEAR(view.velocity.norm(), 0, 1e-9);
  two.contact = {.s = view.s, .t = view.t, .normal = view.normal};
  std::vector<VertexLoad> loads(4);
  const int substeps = AddEdgeContactLoads<double>(two.parameters, two.Meet(), {&two.contact, 1}, kPace, loads, loads);
  EXPECT_GE(substeps, 4) << "two for each radius of the way";
  for (const VertexLoad& load : loads) EXPECT_GT(load.stiffness, 0);
}

std::uint8_t AddRodBlueprint(World& world, const Vector3d& direction) {
  PairDefinition rod;
  rod.direction = direction;
  rod.material.stiffness = 3000;
  return world.AddBlueprint(MakePair(rod));
}

// A square net of n × n particles, 0.25 m apart, whose rim is fixed.
GraphDefinition MakeNet(int n) {
  GraphDefinition net;
  constexpr double kSpacing = 0.25;
  const auto indexOf = [n](int i, int j) { return i * n + j; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const bool isRim = i == 0 || j == 0 || i == n - 1 || j == n - 1;
      net.particles.push_back({.position = kSpacing * Vector3d(i, j, 0), .mass = 0.2, .fixed = isRim});
      if (i > 0) net.springs.push_back({.a = indexOf(i - 1, j), .b = indexOf(i, j), .stiffness = 4000, .damping = 4});
      if (j > 0) net.springs.push_back({.a = indexOf(i, j - 1), .b = indexOf(i, j), .stiffness = 4000, .damping = 4});
    }
  }
  return net;
}

WorldSettings InFreeSpace() {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  return settings;
}

// Rods that are shot crosswise at one another in free space, at 1 to 50 m/s, and never come through.
TEST(EdgeContact, RodsDoNotPassThroughOneAnother) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> of(-1, 1);
  for (int shot = 0; shot < 60; ++shot) {
    World world(InFreeSpace());
    const double speed = std::pow(50.0, shot / 59.0);
    const Vector3d across(0.3 * of(random), 1, 0.3 * of(random));
    const std::uint8_t along = AddRodBlueprint(world, {1, 0, 0}), crosswise = AddRodBlueprint(world, across);
    const BodyId still = world.AddBody(along, Vector3d::Zero());
    const BodyId flying = world.AddBody(crosswise, Vector3d(0.2 * of(random), 0.2 * of(random), 0.5), {0, 0, -speed});
    const int ticks = static_cast<int>(std::ceil(2 / speed / kPace));
    for (int i = 0; i < ticks; ++i) world.Step();
    // In the frame of both the flying rod stays above the other.
    EXPECT_GT(world.FindCentre(world.ReadBody(flying)).z(), world.FindCentre(world.ReadBody(still)).z()) << speed;
  }
}

TEST(EdgeContact, ParticlesRestAtTheirRadius) {
  World world(WorldSettings{});
  world.AddObstacle({});
  GraphDefinition one;
  one.particles = {{.position = Vector3d::Zero(), .mass = 1}};
  one.radius = 0.1;
  const BodyId particle = world.AddBody(world.AddBlueprint(MakeGraph(one)), {0, 0, 0.3});
  for (int i = 0; i < 240; ++i) world.Step();
  EXPECT_NEAR(world.FindCentre(world.ReadBody(particle)).z(), 0.1, 0.015);
}

// A net of springs with holes of 25 cm holds a ball of 1 m whose vertices all fit through the holes.
TEST(EdgeContact, ANetHoldsABall) {
  World world(WorldSettings{});
  BallDefinition ball;
  ball.subdivisions = 1;
  const std::uint8_t net = world.AddBlueprint(MakeGraph(MakeNet(9))), balls = world.AddBlueprint(MakeBall(ball));
  world.AddBody(net, {0, 0, 1});
  const BodyId caught = world.AddBody(balls, {0.1, 0.05, 2});
  for (int i = 0; i < 300; ++i) world.Step();
  const double height = world.FindCentre(world.ReadBody(caught)).z();
  EXPECT_GT(height, 0.3);
  EXPECT_LT(height, 1.7);
}

// A rod that lies on a cube of jelly: its ends are beyond the sides, so only its spring meets the edges of the cube.
TEST(EdgeContact, ARodLiesAcrossACube) {
  World world(WorldSettings{});
  world.AddObstacle({});
  const std::uint8_t cubes = world.AddBlueprint(MakeLattice(MakeJellyCube(0.3)));
  PairDefinition definition;
  definition.length = 1.4;
  definition.direction = {1, 0.3, 0};
  definition.material.stiffness = 3000;
  definition.material.mass = 1;
  const std::uint8_t rods = world.AddBlueprint(MakePair(definition));
  world.AddBody(cubes, {0, 0, 0.4});
  const BodyId rod = world.AddBody(rods, {0, 0, 1.2});
  for (int i = 0; i < 180; ++i) world.Step();
  EXPECT_GT(world.FindCentre(world.ReadBody(rod)).z(), 0.7);
}

// Planar bodies stack in their plane, between two walls.
TEST(EdgeContact, PlanarBodiesStack) {
  World world(WorldSettings{});
  world.AddObstacle({});
  for (const double side : {-1.0, 1.0}) world.AddObstacle({.normal = {side, 0, 0}, .offset = -0.6});
  LatticeDefinition sheet;
  sheet.cells = {3, 0, 3};
  sheet.poissonRatio = FindPoissonRatio(sheet.cells);
  sheet.dampingRatio = 0.3;
  RingDefinition ring;
  ring.material.dampingRatio = 0.3;
  const std::uint8_t sheets = world.AddBlueprint(MakeLattice(sheet)), rings = world.AddBlueprint(MakeRing(ring));
  const BodyId lower = world.AddBody(sheets, {0, 0, 0.5});
  const BodyId upper = world.AddBody(sheets, {0.05, 0, 1.5});
  const BodyId top = world.AddBody(rings, {0.02, 0, 2.7});
  for (int i = 0; i < 300; ++i) world.Step();
  const auto height = [&](BodyId id) { return world.FindCentre(world.ReadBody(id)).z(); };
  EXPECT_GT(height(upper), height(lower) + 0.6);
  EXPECT_GT(height(top), height(upper) + 0.5);
}

// Momentum of a tumble of rods, nets and a ball in free space.
TEST(EdgeContact, ATumbleKeepsMomentum) {
  WorldSettings settings = InFreeSpace();
  settings.precision = Precision::kDouble;
  World world(settings);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> of(-1, 1);
  const auto draw = [&] { return Vector3d(of(random), of(random), of(random)); };
  std::vector<Vector3d> places;
  for (int i = 0; i < 12; ++i) {
    places.push_back(0.8 * draw());
    AddRodBlueprint(world, draw());
  }
  for (std::uint8_t i = 0; i < 12; ++i) world.AddBody(i, places[i], -3 * places[i]);
  const auto addUp = [&](Vector3d& linear, Vector3d& angular) {
    linear.setZero();
    angular.setZero();
    for (const Body& body : world.Bodies()) {
      const std::vector<double>& masses = world.BlueprintOf(body).full.masses;
      const auto& state = std::get<State<double>>(body.state);
      VisitVertices(body, [&](std::size_t i, const Vector3d& x) {
        linear += masses[i] * state.velocities[i];
        angular += masses[i] * x.cross(state.velocities[i]);
      });
    }
  };
  Vector3d linear, angular;
  addUp(linear, angular);
  for (int i = 0; i < 120; ++i) world.Step();
  Vector3d linearAfter, angularAfter;
  addUp(linearAfter, angularAfter);
  EXPECT_LT((linearAfter - linear).norm(), 1e-9);
  // RK4 keeps linear invariants to rounding, others to its order; 12 rods of 2 kg at 3 m/s and 0.8 m have some 50
  // N·m·s.
  EXPECT_LT((angularAfter - angular).norm(), 1e-5 * 50);
}

}  // namespace
}  // namespace wobble::physics
