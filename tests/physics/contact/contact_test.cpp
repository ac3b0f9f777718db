// Contacts with obstacles: the surfaces of boxes, the penalty law, friction, and the search.
#include <gtest/gtest.h>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

TEST(Obstacle, BoxDistanceAndNormalAreRightEverywhereAround) {
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  box.centre = Vector3d(1, 2, 3);
  box.halfExtents = Vector3d(2, 1, 0.5);
  const Surface<double> surface = MakeSurface<double>(box, Vector3d(10, 0, 0));
  const Vector3d centre = box.centre - Vector3d(10, 0, 0);
  const auto at = [&](double x, double y, double z) {
    return FindSurfacePoint(surface, Vector3d(centre + Vector3d(x, y, z)));
  };
  EXPECT_NEAR(at(5, 0, 0).distance, 3, 1e-12);
  EXPECT_EQ(at(5, 0, 0).normal, Vector3d(1, 0, 0));
  EXPECT_NEAR(at(0, 0, 0.4).distance, -0.1, 1e-12);
  EXPECT_EQ(at(0, 0, 0.4).normal, Vector3d(0, 0, 1));
  EXPECT_EQ(at(0, 0, -0.4).normal, Vector3d(0, 0, -1));
  // Off an edge: rounded by kEdgeRadius about the inner box's edge.
  const double inner = std::hypot(1 + kEdgeRadius, 1 + kEdgeRadius);
  EXPECT_NEAR(at(3, 2, 0).distance, inner - kEdgeRadius, 1e-12);
  EXPECT_NEAR(at(3, 2, 0).normal.dot(Vector3d(1, 1, 0).normalized()), 1, 1e-12);
}

// The normal is the gradient of the distance, and the distance has no jump, near edges too, down to the edge radius.
TEST(Obstacle, NormalIsTheGradientOfTheDistance) {
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  const Surface<double> surface = MakeSurface<double>(box, Vector3d::Zero());
  for (double x = 0.97; x < 1.3; x += 0.0137) {
    for (double z = 0.97; z < 1.3; z += 0.0171) {
      const Vector3d p(x, 0.2, z);
      const SurfacePoint<double> point = FindSurfacePoint(surface, p);
      for (int axis = 0; axis < 3; ++axis) {
        Vector3d step = Vector3d::Zero();
        step[axis] = 1e-6;
        const double slope = (FindSurfacePoint(surface, Vector3d(p + step)).distance -
                              FindSurfacePoint(surface, Vector3d(p - step)).distance) /
                             2e-6;
        ASSERT_NEAR(slope, point.normal[axis], 1e-4) << p.transpose();
      }
    }
  }
}

struct Sandbox {
  explicit Sandbox(const BallDefinition& ball, double slopeDegrees = 0, double friction = 1) {
    WorldSettings settings;
    settings.precision = Precision::kDouble;
    const double angle = slopeDegrees * 3.14159265358979 / 180;
    settings.gravity = 9.81 * Vector3d(std::sin(angle), 0, -std::cos(angle));  // tilting gravity tilts the plane
    world = std::make_unique<World>(settings);
    world->AddBlueprint(MakeBall(ball));
    Obstacle plane;
    plane.friction = friction;
    world->AddObstacle(plane);
  }
  void Run(double seconds) {
    for (int i = 0; i < std::lround(seconds * 60); ++i) {
      const StepReport report = world->Step();
      nonFinite += report.nonFinite;
      inverted += report.inverted;
    }
  }
  [[nodiscard]] Vector3d Centre(BodyId body) const { return world->FindCentre(world->ReadBody(body)); }

  std::unique_ptr<World> world;
  unsigned nonFinite = 0;
  unsigned inverted = 0;
};

TEST(Contact, BallComesToRestWithItsWeightCarried) {
  Sandbox sandbox{BallDefinition{}};
  const BodyId ball = sandbox.world->AddBody(0, Vector3d(0, 0, 2));
  sandbox.Run(60);
  const Vector3d before = sandbox.Centre(ball);
  sandbox.Run(1);
  const Vector3d after = sandbox.Centre(ball);
  EXPECT_LT((after - before).norm(), 1e-3) << "moves no more than 1 mm in a second";
  EXPECT_GT(after.z(), 0.2);
  VisitVertices(sandbox.world->ReadBody(ball), [](std::size_t i, const Vector3d& x) {
    EXPECT_GT(x.z(), -0.01) << "vertex " << i << " sinks in by 2 % of the radius";
  });
}

TEST(Contact, SurfaceIsNotLeftFasterThanItIsHit) {
  for (const double height : {1.0, 3.0, 10.0}) {
    Sandbox sandbox{BallDefinition{}};
    const BodyId ball = sandbox.world->AddBody(0, Vector3d(0, 0, height));
    double highest = 0;
    bool hit = false;
    for (int i = 0; i < 600; ++i) {
      sandbox.Run(1.0 / 60);
      const double z = sandbox.Centre(ball).z();
      hit = hit || z < 0.4;
      if (hit) highest = std::max(highest, z);
    }
    EXPECT_TRUE(hit);
    EXPECT_LT(highest, height) << "bounces no higher than it fell from";
    EXPECT_EQ(sandbox.nonFinite + sandbox.inverted, 0U);
  }
}

struct Slide {
  double distance = 0;      // m
  double acceleration = 0;  // mean, m/s²
};

// A particle of 0.1 kg that lies on a slope by its own weight, from a second after the slope was tilted, for `seconds`.
Slide MeasureSlide(double slopeDegrees, double friction, double seconds) {
  Material material;
  material.friction = friction;
  Coefficients<double> body;
  body.masses = {0.1};
  body.inverseMasses = {10};
  body.contactShares = {1};
  body.contact = MakeContactParameters(material, 0.1, 1);
  const double angle = slopeDegrees * 3.14159265358979 / 180;
  Load<double> load;
  load.acceleration = 9.81 * Vector3d(0, 0, -1);
  const std::vector<Surface<double>> surfaces{MakeSurface<double>(Obstacle{}, Vector3d::Zero())};
  std::vector<Contact<double>> contacts{{0, 0}};
  std::vector<Vector3d> x{Vector3d::Zero()};
  std::vector<Vector3d> v{Vector3d::Zero()};
  StageBuffers<double, 4> buffers;
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    ComputeAccelerations<double>(body, load, surfaces, contacts, at, speed, a);
  };
  const auto run = [&](double duration) {
    for (int i = 0; i < std::lround(duration * 240); ++i) {
      StepRungeKutta<double>(kClassicRungeKutta, 1.0 / 240, accelerate, std::span(x), std::span(v), buffers);
      UpdateAnchors<double>(body.contact, surfaces, contacts, 1.0 / 240, x, v);
    }
  };
  run(3);  // settles on the level
  load.acceleration = 9.81 * Vector3d(std::sin(angle), 0, -std::cos(angle));
  run(1);
  const Vector3d from = x[0];
  const Vector3d before = v[0];
  run(seconds);
  return {x[0].x() - from.x(), (v[0].x() - before.x()) / seconds};
}

// Coulomb: sticks below arctan μ without creeping, slides above with g (sin − μ cos).
TEST(Contact, FrictionSticksBelowItsAngleAndSlidesAbove) {
  for (const double friction : {0.3, 0.8}) {
    const double limit = std::atan(friction) * 180 / 3.14159265358979;
    EXPECT_LT(std::fabs(MeasureSlide(limit - 0.5, friction, 10).distance), 1e-6) << "m in 10 s, half a degree below";
    const double angle = (limit + 0.5) * 3.14159265358979 / 180;
    const double acceleration = 9.81 * (std::sin(angle) - friction * std::cos(angle));
    EXPECT_NEAR(MeasureSlide(limit + 0.5, friction, 2).acceleration, acceleration, 0.02 * acceleration);
  }
}

TEST(Contact, NoFrictionNoGrip) {
  BallDefinition slick;
  slick.material.friction = 0;
  Sandbox sandbox{slick, 10};
  const BodyId ball = sandbox.world->AddBody(0, Vector3d(0, 0, 0.5));
  sandbox.Run(3);
  // Free sliding: ½ g sin 10° t² = 7.7 m, without turning.
  EXPECT_NEAR(sandbox.Centre(ball).x(), 0.5 * 9.81 * std::sin(10 * 3.14159265 / 180) * 9, 0.05);
}

// The far side of a thin wall is nearer to a vertex past the wall's middle; the side that the vertex came from still
// counts, until the vertex has gone round the wall.
TEST(Contact, AWallKeepsTheSideThatAVertexCameFrom) {
  Obstacle wall;
  wall.kind = Obstacle::Kind::kBox;
  wall.halfExtents = Vector3d(2, 2, 0.1);
  const Surface<double> surface = MakeSurface<double>(wall, Vector3d::Zero());
  Contact<double> contact;
  const Vector3d past(0, 0, -0.06);
  EXPECT_EQ(FindContactPoint(surface, contact, past).normal, Vector3d(0, 0, -1)) << "nothing known of it";
  contact.side = Vector3d(0, 0, 1);
  for (const double z : {0.05, -0.06, -0.3}) {
    const SurfacePoint<double> point = FindContactPoint(surface, contact, Vector3d(0.5, -1, z));
    EXPECT_EQ(point.normal, Vector3d(0, 0, 1)) << z;
    EXPECT_NEAR(point.distance, z - 0.1, 1e-12) << z;
  }
  const SurfacePoint<double> round = FindContactPoint(surface, contact, Vector3d(2.2, 0, -0.3));
  EXPECT_LT(round.normal.z(), 0);
  EXPECT_GT(round.distance, 0);
}

// The ball moves several wall thicknesses a tick.
TEST(Contact, NothingFastPassesAWall) {
  for (const double speed : {20.0, 35.0, 50.0}) {
    WorldSettings settings;
    settings.gravity = Vector3d::Zero();
    World world(settings);
    BallDefinition ball;
    ball.subdivisions = 1;
    ball.material.stiffness *= 50;
    ball.material.gas *= 50;
    world.AddBlueprint(MakeBall(ball));
    Obstacle wall;
    wall.kind = Obstacle::Kind::kBox;
    wall.halfExtents = Vector3d(5, 5, 0.1);
    world.AddObstacle(wall);
    world.AddBody(0, Vector3d(0, 0, 0.9), Vector3d(0, 0, -speed));
    for (int i = 0; i < 20; ++i) world.Step();
    VisitVertices(world.Bodies()[0], [&](std::size_t, const Vector3d& x) { EXPECT_GT(x.z(), 0) << speed; });
  }
}

// Two heavy particles on a soft contact go two metres behind a thin wall before they stop there, far from it, and come
// back.
TEST(Contact, AWallPullsBackWhatGoesFarBehindIt) {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  World world(settings);
  PairDefinition pair;
  pair.material.mass = 2;
  pair.material.stiffness = 150;
  world.AddBlueprint(MakePair(pair));
  Obstacle wall;
  wall.kind = Obstacle::Kind::kBox;
  wall.halfExtents = Vector3d(50, 50, 0.1);
  world.AddObstacle(wall);
  world.AddBody(0, Vector3d(0, 0, 1), Vector3d(0, 0, -80));
  double deepest = 0;
  for (int i = 0; i < 60; ++i) {
    world.Step();
    deepest = std::min(deepest, world.FindCentre(world.Bodies()[0]).z());
  }
  EXPECT_LT(deepest, -1);
  EXPECT_GT(world.FindCentre(world.Bodies()[0]).z(), 1);
}

// A lone particle feels all of an error in the depth over which the force sets in: by the conservation of energy it
// comes back to the height that it fell from.
TEST(Contact, AParticleThatLosesNothingComesBackAsHigh) {
  Material material;
  material.restitution = 1;
  Blueprint particles;
  particles.rest = {Vector3d(1, 0, 0), Vector3d(-1, 0, 0)};
  particles.full.masses = {0.05, 0.05};
  particles.full.contact = MakeContactParameters(material, 0.05, 0.5);
  particles.full.contact.damping = 0;
  FinishBlueprint(particles);
  for (const double height : {0.5, 1.0, 2.0}) {
    World world(WorldSettings{});
    world.AddBlueprint(particles);
    world.AddObstacle(Obstacle{});
    const BodyId id = world.AddBody(0, Vector3d(0, 0, height));
    double top = 0;
    bool rose = false;
    for (int i = 0; i < 200; ++i) {
      world.Step();
      const Body& body = world.ReadBody(id);
      const double z = world.FindCentre(body).z();
      const double v = FindMeanVelocity(world.BlueprintOf(body), std::get<State<float>>(body.state)).z();
      if (rose && v < 0) break;
      rose |= v > 0;
      if (rose && z > 0) top = z + v * v / (2 * 9.81);
    }
    EXPECT_NEAR(top, height, 0.01 * height);
  }
}

TEST(Contact, BodiesStopAtBoxesToo) {
  WorldSettings settings;
  World world(settings);
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddObstacle(Obstacle{});
  Obstacle wall;
  wall.kind = Obstacle::Kind::kBox;
  wall.centre = Vector3d(3, 0, 1);
  wall.halfExtents = Vector3d(0.5, 5, 2);
  world.AddObstacle(wall);
  const BodyId ball = world.AddBody(0, Vector3d(0, 0, 0.6), Vector3d(12, 0, 0));
  double farthest = 0;
  for (int i = 0; i < 240; ++i) {
    world.Step();
    farthest = std::max(farthest, world.FindCentre(world.ReadBody(ball)).x());
  }
  EXPECT_GT(farthest, 1.9) << "reaches the wall";
  EXPECT_LT(farthest, 2.5) << "but its middle never gets into it";
  EXPECT_LT(world.FindCentre(world.ReadBody(ball)).x(), 2.1);
}

// Random trials found a ring that shook so fast that vertices were in the ground at the next search: it was thrown up
// with seven times the energy that it had come with.
TEST(Contact, ABodyThatShakesIsLookedAtAsFarAsItMayReach) {
  const std::vector<Surface<double>> ground{MakeSurface<double>(Obstacle{}, Vector3d::Zero())};
  const std::vector<Vector3d> x{{0, 0, 0.3}, {1, 0, 0.3}, {2, 0, 5}};
  std::vector<Contact<double>> contacts;
  std::vector<Contact<double>> scratch;
  const auto count = [&](const std::vector<Vector3d>& v) {
    FindContacts<double>({.surfaces = ground,
                          .x = x,
                          .v = v,
                          .survey = MakeSurvey<double>(std::vector<double>(x.size(), 1.0), x, v),
                          .duration = 1.0 / 60},
                         contacts, scratch);
    return contacts.size();
  };
  EXPECT_EQ(count({{0, 0, 0}, {0, 0, 60}, {0, 0, -60}}), 2U) << "the next moment it is theirs";
  EXPECT_EQ(count({{0, 0, 60}, {0, 0, 60}, {0, 0, 60}}), 0U) << "it flies up as a whole";
  EXPECT_EQ(count({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}), 0U);
}

TEST(Friction, TheAnchorIsWhereTheVertexCameIn) {
  Material material;
  material.friction = 100;  // nothing drags it along
  const ContactParameters<double> parameters = MakeContactParameters(material, 0.1, 1);
  const std::vector<Surface<double>> surfaces{MakeSurface<double>(Obstacle{}, Vector3d::Zero())};
  const std::vector<Vector3d> v{{3, -2, -4}};
  for (const double since : {0.25, 0.75}) {  // of the substep, s
    std::vector<Contact<double>> contacts{{0, 0}};
    const std::vector<Vector3d> x{Vector3d(0.5, 0.5, 0) + since / 240 * v[0]};
    UpdateAnchors<double>(parameters, surfaces, contacts, 1.0 / 240, x, v);
    ASSERT_TRUE(contacts[0].touching);
    EXPECT_NEAR(contacts[0].anchor.x(), 0.5, 1e-12);
    EXPECT_NEAR(contacts[0].anchor.y(), 0.5, 1e-12);
  }
}

TEST(Friction, AnAnchorIsNoOlderThanTheSubstep) {
  Material material;
  material.friction = 100;
  const ContactParameters<double> parameters = MakeContactParameters(material, 0.1, 1);
  const std::vector<Surface<double>> surfaces{MakeSurface<double>(Obstacle{}, Vector3d::Zero())};
  for (const double vz : {-0.1, 0.0, 0.1}) {  // hardly deeper, not at all, and on its way out
    std::vector<Contact<double>> contacts{{0, 0}};
    const std::vector<Vector3d> x{{0, 0, -0.01}};
    const std::vector<Vector3d> v{{1, 0, vz}};
    UpdateAnchors<double>(parameters, surfaces, contacts, 1.0 / 240, x, v);
    EXPECT_NEAR(contacts[0].anchor.x(), -1.0 / 240, 1e-12);
  }
}

struct FrictionCase {
  const char* name;
  bool pair;                 // two balls that meet off centre; else one that is thrown onto the floor
  double atFour, atSixteen;  // bounds of the error, m
};

// Where everything is after half a second of so many substeps a tick.
std::vector<Vector3d> PlayWithFriction(const FrictionCase& played, int substeps, double shift) {
  WorldSettings settings;
  settings.precision = Precision::kDouble;
  settings.errorTarget = 1e9;
  settings.leastSubsteps = substeps;
  World world(settings);
  BallDefinition ball;
  ball.subdivisions = 1;
  world.AddBlueprint(MakeBall(ball));
  if (played.pair) {
    world.SetGravity(Vector3d::Zero());
    world.AddBody(0, Vector3d(-0.6 - shift, 0, 0.15), Vector3d(2, 0, 0));
    world.AddBody(0, Vector3d(0.6, 0.1, -0.15), Vector3d(-2, 0, 0));
  } else {
    world.AddObstacle(Obstacle{});
    world.AddBody(0, Vector3d(0, 0, 0.6 + shift), Vector3d(2, 0.5, -1));
  }
  for (int tick = 0; tick < 30; ++tick) world.Step();
  std::vector<Vector3d> places;
  for (const Body& body : world.Bodies()) {
    VisitVertices(body, [&](std::size_t, const Vector3d& x) { places.push_back(x); });
  }
  return places;
}

class FrictionError : public testing::TestWithParam<FrictionCase> {};

// With anchors where vertices are when the substep ends: landing 1.55e-3 and 3.4e-4 m, collision 3.8e-4 and 7.7e-5.
TEST_P(FrictionError, IsSmallInFewSubsteps) {
  double atFour = 0, atSixteen = 0;
  std::size_t count = 0;
  for (const double shift : {0.0, 0.03, 0.06, 0.09, 0.12, 0.15}) {  // contacts begin elsewhere within the substep
    const std::vector<Vector3d> fine = PlayWithFriction(GetParam(), 128, shift);
    const std::vector<Vector3d> four = PlayWithFriction(GetParam(), 4, shift);
    const std::vector<Vector3d> sixteen = PlayWithFriction(GetParam(), 16, shift);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      atFour += (four[i] - fine[i]).squaredNorm();
      atSixteen += (sixteen[i] - fine[i]).squaredNorm();
    }
    count += fine.size();
  }
  atFour = std::sqrt(atFour / static_cast<double>(count));
  atSixteen = std::sqrt(atSixteen / static_cast<double>(count));
  std::printf("%s: %.2e m off in 4 substeps a tick, %.2e in 16\n", GetParam().name, atFour, atSixteen);
  EXPECT_LT(atFour, GetParam().atFour);
  EXPECT_LT(atSixteen, GetParam().atSixteen);
}

INSTANTIATE_TEST_SUITE_P(Motions, FrictionError,
                         testing::Values(FrictionCase{"Landing", false, 5e-4, 2e-4},
                                         FrictionCase{"Collision", true, 2e-4, 6e-5}),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace wobble::physics
