// The two other laws of contacts with obstacles: magnetic and backtracking.
#include <gtest/gtest.h>

#include "server/physics/contact/backtracking.h"
#include "server/physics/methods/integrator_step.h"
#include "server/physics/methods/stability.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kPi = 3.14159265358979;

// A single particle, without springs and faces.
Blueprint MakeParticle(ContactLaw law, double friction = 0.5, double restitution = 0.5, double strength = 0.01) {
  Material material;
  material.friction = friction;
  material.restitution = restitution;
  Blueprint particle;
  particle.rest = {Vector3d::Zero()};
  particle.full.masses = {0.1};
  particle.full.contact = MakeContactParameters(material, 0.1, 1);
  FinishBlueprint(particle);
  particle.size = particle.reach = 1;
  SetContactLaw(particle, law, strength);
  return particle;
}

TEST(MagneticLaw, IsSmoothBoundedAndEndsAtItsRange) {
  for (const double strength : {1.0, 1e-1, 1e-2, 1e-4}) {
    const Blueprint particle = MakeParticle(ContactLaw::kMagnetic, 0.5, 0.5, strength);
    const ContactParameters<double>& law = particle.full.contact;
    ASSERT_LT(law.floorDistance, law.range / 2);
    EXPECT_DOUBLE_EQ(ComputeMagneticForce(law, law.range / 3), strength / (law.range * law.range / 9));
    EXPECT_EQ(ComputeMagneticForce(law, law.range), 0);
    EXPECT_NEAR(ComputeMagneticForce(law, 0.0), 3 * strength / std::pow(law.floorDistance, 2), 1e-9);
    EXPECT_NEAR(ComputeMagneticSlope(law, -1.0), law.stiffness, 1e-9 * law.stiffness) << "no stiffer than the penalty";
    double before = ComputeMagneticForce(law, -0.1);
    for (double d = -0.1; d < 1.1 * law.range; d += law.range / 1777) {
      const double force = ComputeMagneticForce(law, d);
      const double epsilon = 1e-7 * law.range;
      const double slope =
          (ComputeMagneticForce(law, d - epsilon) - ComputeMagneticForce(law, d + epsilon)) / (2 * epsilon);
      ASSERT_LE(force, before * (1 + 1e-12)) << "falls with the distance";
      ASSERT_NEAR(ComputeMagneticSlope(law, d), slope, 2e-4 * law.stiffness) << "at " << d;
      before = force;
    }
  }
}

TEST(MagneticLaw, CarriesAParticleWhereItsWeightIsBalanced) {
  for (const double strength : {1.0, 1e-1, 1e-2, 1e-4}) {
    WorldSettings settings;
    settings.precision = Precision::kDouble;
    World world(settings);
    world.AddBlueprint(MakeParticle(ContactLaw::kMagnetic, 0.5, 0.5, strength));
    world.AddObstacle(Obstacle{});
    const double height = std::sqrt(strength / (0.1 * 9.81));  // K/d² = m g
    const BodyId still = world.AddBody(0, Vector3d(0, 0, height));
    const BodyId swinging = world.AddBody(0, Vector3d(50, 0, 1.05 * height));
    double sum = 0;
    double lowest = 1e9;
    for (int tick = 0; tick < 1200; ++tick) {
      world.Step();
      const double z = world.FindCentre(world.ReadBody(swinging)).z();
      sum += z / 1200;
      lowest = std::min(lowest, z);
    }
    EXPECT_NEAR(world.FindCentre(world.ReadBody(still)).z() / height, 1, 1e-6) << "K = " << strength;
    EXPECT_NEAR(sum / height, 1, 0.01) << "K = " << strength;
    EXPECT_NEAR(lowest / height, 0.95, 0.01) << "K = " << strength;
  }
}

// The law itself takes no energy: it changes only by RK4's error.
TEST(MagneticLaw, BouncesWithoutLoss) {
  for (const double height : {0.5, 3.0}) {
    WorldSettings settings;
    settings.precision = Precision::kDouble;
    settings.tickDuration = 1.0 / 480;
    World world(settings);
    world.AddBlueprint(MakeParticle(ContactLaw::kMagnetic));
    world.AddObstacle(Obstacle{});
    const BodyId body = world.AddBody(0, Vector3d(0, 0, height));
    double lowest = height;
    double highest = 0;
    for (int tick = 0; tick < 480 * 2.5 * std::sqrt(2 * height / 9.81); ++tick) {
      world.Step();
      const double z = world.FindCentre(world.ReadBody(body)).z();
      lowest = std::min(lowest, z);
      if (lowest < 0.2 * height) highest = std::max(highest, z);
    }
    EXPECT_GT(lowest, -0.03) << "the tangent holds what comes through";
    EXPECT_NEAR(highest / height, 1, 0.01);
  }
}

TEST(MagneticLaw, BodiesFarAwayCostNothing) {
  const Blueprint particle = MakeParticle(ContactLaw::kMagnetic);
  const std::vector<Surface<double>> surfaces{MakeSurface<double>(Obstacle{}, Vector3d::Zero())};
  std::vector<Contact<double>> contacts;
  std::vector<Contact<double>> scratch;
  const double range = particle.full.contact.range;
  const auto count = [&](double height) {
    const std::vector<Vector3d> x{Vector3d(0, 0, height)};
    const std::vector<Vector3d> v{Vector3d::Zero()};
    FindContacts<double>({.surfaces = surfaces,
                          .x = x,
                          .v = v,
                          .survey = MakeSurvey<double>(std::vector<double>(x.size(), 1.0), x, v),
                          .range = range,
                          .duration = 1.0 / 60},
                         contacts, scratch);
    return contacts.size();
  };
  EXPECT_EQ(count(0.99 * range), 1U);
  EXPECT_EQ(count(range + 0.03), 0U);
}

// One particle over a plane, tilted by tilting gravity, stepped by RK4 and put back.
template <class Real>
struct Hopper {
  Hopper(double friction, double restitution)
      : blueprint(MakeParticle(ContactLaw::kBacktracking, friction, restitution)) {
    surfaces = {MakeSurface<Real>(Obstacle{}, Vector3d::Zero())};
    contacts = {{0, 0}};
    load.acceleration = Vector3<Real>(0, 0, Real(-9.81));
  }
  void Step(double h) {
    const std::vector<Vector3<Real>> x0 = x;
    const std::vector<Vector3<Real>> v0 = v;
    const Coefficients<Real>& body = blueprint.Read<Real>();
    const auto accelerate = [&](std::span<const Vector3<Real>> at, std::span<const Vector3<Real>> speed,
                                std::span<Vector3<Real>> a) {
      ComputeAccelerations<Real>(body, load, surfaces, contacts, at, speed, a);
      HoldResting<Real>(body, surfaces, contacts, at, a);
    };
    StepRungeKutta<Real>(kClassicRungeKutta, static_cast<Real>(h), accelerate, std::span(x), std::span(v), buffers);
    PutBack<Real>(body, static_cast<Real>(h), surfaces, x0, v0, contacts, x, v);
  }

  Blueprint blueprint;
  Load<Real> load;
  std::vector<Surface<Real>> surfaces;
  std::vector<Contact<Real>> contacts;
  std::vector<Vector3<Real>> x{Vector3<Real>::Zero()};
  std::vector<Vector3<Real>> v{Vector3<Real>::Zero()};
  StageBuffers<Real, 4> buffers;
};

// A bounce gives back e² of the energy, however coarse the step and wherever in it the surface is met.
TEST(Backtracking, RestitutionIsExact) {
  for (const double restitution : {0.2, 0.5, 1.0}) {
    for (const double height : {0.7, 1.0, 2.345}) {
      for (const double h : {1.0 / 60, 1.0 / 97, 1.0 / 240}) {
        Hopper<double> particle(0, restitution);
        particle.x[0].z() = height;
        while (!(particle.v[0].z() > 0)) particle.Step(h);
        const double energy = 9.81 * particle.x[0].z() + 0.5 * particle.v[0].z() * particle.v[0].z();
        EXPECT_NEAR(energy / (9.81 * height), restitution * restitution, 1e-6);
      }
    }
  }
}

TEST(Backtracking, FrictionTakesItsImpulseFromABounce) {
  Hopper<double> particle(0.1, 0.5);
  particle.x[0].z() = 1;
  particle.v[0].x() = 3;
  while (!(particle.v[0].z() > 0)) particle.Step(1.0 / 60);
  EXPECT_NEAR(particle.v[0].x(), 3 - 0.1 * 1.5 * std::sqrt(2 * 9.81), 1e-9);
  particle = Hopper<double>(10, 0.5);
  particle.x[0].z() = 1;
  particle.v[0].x() = 3;
  while (!(particle.v[0].z() > 0)) particle.Step(1.0 / 60);
  EXPECT_NEAR(particle.v[0].x(), 0, 1e-9) << "but never turns it round";
}

TEST(Backtracking, FrictionEndsASlideWhereItMust) {
  for (const double h : {1.0 / 60, 1.0 / 240}) {
    for (const double friction : {0.3, 0.8}) {
      Hopper<double> particle(friction, 0.5);
      particle.v[0].x() = 3;
      for (int i = 0; i < 4 / h; ++i) particle.Step(h);
      const double exact = 9 / (2 * friction * 9.81);
      EXPECT_NEAR(particle.x[0].x() / exact, 1, 1e-3) << "h = " << h;
      EXPECT_EQ(particle.v[0].x(), 0);
    }
  }
}

TEST(Backtracking, FrictionSticksBelowItsAngleAndSlidesAbove) {
  const double friction = 0.5;
  const double limit = std::atan(friction);
  for (const double degrees : {-0.5, 0.5}) {
    const double angle = limit + degrees * kPi / 180;
    Hopper<double> particle(friction, 0.5);
    particle.load.acceleration = 9.81 * Vector3d(std::sin(angle), 0, -std::cos(angle));
    for (int i = 0; i < 600; ++i) particle.Step(1.0 / 60);
    if (degrees < 0) {
      EXPECT_LT(std::fabs(particle.x[0].x()), 1e-9) << "m in 10 s";
    } else {
      const double acceleration = 9.81 * (std::sin(angle) - friction * std::cos(angle));
      EXPECT_NEAR(particle.x[0].x() / (0.5 * acceleration * 100), 1, 1e-3);
    }
  }
}

TEST(Backtracking, HopsEndAndNothingSinks) {
  Hopper<float> particle(0.5, 0.8);
  particle.x[0].z() = 1;
  for (int i = 0; i < 1200; ++i) {
    particle.Step(1.0 / 60);
    ASSERT_GT(particle.x[0].z(), -1e-6F);
  }
  for (int i = 0; i < 600; ++i) {
    particle.Step(1.0 / 60);
    ASSERT_LT(std::fabs(particle.x[0].z()), 1e-6F) << "lies still";
    ASSERT_LT(std::fabs(particle.v[0].z()), 1e-6F);
    ASSERT_TRUE(particle.contacts[0].touching);
  }
}

TEST(Backtracking, CornersHoldToo) {
  Hopper<double> particle(0.2, 0.5);
  for (const double side : {1.0, -1.0}) {
    Obstacle slope;
    slope.normal = Vector3d(side, 0, 1).normalized();
    particle.surfaces.push_back(MakeSurface<double>(slope, Vector3d::Zero()));
  }
  particle.contacts = {{1, 0}, {2, 0}};
  particle.x[0] = Vector3d(0.3, 0, 1);
  for (int i = 0; i < 1200; ++i) {
    particle.Step(1.0 / 60);
    for (const auto& surface : particle.surfaces) {
      ASSERT_GT(FindSurfacePoint(surface, particle.x[0]).distance, -1e-4);
    }
  }
  EXPECT_LT(particle.x[0].norm(), 1e-3);
  EXPECT_LT(particle.v[0].norm(), 1e-3);
}

// A cube lies still on a slope below the angle of friction, to the last vertex, and slides above it. The slope is a
// tilted plane, or a level plane under tilted gravity.
TEST(Backtracking, BodiesStickAndSlideAsParticlesDo) {
  const double angle = 10 * kPi / 180;
  const Vector3d down(std::sin(angle), 0, -std::cos(angle));
  for (const auto& [friction, planeIsTilted] : {std::pair(0.3, false), {0.3, true}, {0.1, false}, {0.1, true}}) {
    WorldSettings settings;
    if (!planeIsTilted) settings.gravity = 9.81 * down;
    World world(settings);
    LatticeDefinition definition = MakeJellyCube(0.1);
    definition.friction = friction;
    Blueprint cube = MakeLattice(definition);
    SetContactLaw(cube, ContactLaw::kBacktracking);
    world.AddBlueprint(std::move(cube));
    Obstacle plane;
    if (planeIsTilted) plane.normal = Vector3d(std::sin(angle), 0, std::cos(angle));
    world.AddObstacle(plane);
    const BodyId body = world.AddBody(0, 0.45 * plane.normal);
    for (int tick = 0; tick < 600; ++tick) world.Step();
    const Vector3d before = world.FindCentre(world.ReadBody(body));
    const auto& state = std::get<State<float>>(world.ReadBody(body).state);
    const double speed = FindMeanVelocity(world.Blueprints()[0], state).norm();
    for (int tick = 0; tick < 120; ++tick) world.Step();
    const double way = (world.FindCentre(world.ReadBody(body)) - before).norm();
    if (friction > std::tan(angle)) {
      EXPECT_LT(way, 5e-5) << "m in 2 s";
      for (const Vector3f& v : state.velocities) EXPECT_LT(v.norm(), 2e-3F);
    } else {
      const double acceleration = 9.81 * (std::sin(angle) - friction * std::cos(angle));
      EXPECT_NEAR(way - 2 * speed, 0.5 * acceleration * 4, 0.02 * 2 * acceleration);
    }
  }
}

// Balls and cubes of each law, in both precisions, dropped on a plane.
class LawTest : public testing::TestWithParam<ContactLaw> {};

TEST_P(LawTest, BodiesBounceAndComeToRestAboveThePlane) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    WorldSettings settings;
    settings.precision = precision;
    World world(settings);
    BallDefinition ball;
    ball.subdivisions = 1;
    for (Blueprint blueprint : {MakeBall(ball), MakeLattice(MakeJellyCube(0.1))}) {
      SetContactLaw(blueprint, GetParam());
      world.AddBlueprint(std::move(blueprint));
    }
    world.AddObstacle(Obstacle{});
    world.AddBody(0, Vector3d(0, 0, 3));
    world.AddBody(1, Vector3d(3, 0, 3));
    double turned[2] = {0, 0};
    double lowest = 0;
    for (int tick = 0; tick < 3600; ++tick) {
      const StepReport report = world.Step();
      ASSERT_EQ(report.nonFinite + report.inverted, 0U) << "tick " << tick;
      for (const Body& body : world.Bodies()) {
        const double speed = std::visit(
            [&](const auto& state) { return FindMeanVelocity(world.BlueprintOf(body), state).z(); }, body.state);
        turned[body.id - 1] = std::max(turned[body.id - 1], speed);
        VisitVertices(body, [&](std::size_t, const Vector3d& x) { lowest = std::min(lowest, x.z()); });
      }
    }
    EXPECT_GT(turned[0], 1) << "bounces";
    EXPECT_GT(turned[1], 1) << "bounces";
    if (GetParam() == ContactLaw::kBacktracking) {
      EXPECT_GT(lowest, -1e-6);
    }
    for (const Body& body : world.Bodies()) {
      const double before = world.FindCentre(body).z();
      EXPECT_GT(before, 0.2);
      double least = before;
      double most = before;
      for (int tick = 0; tick < 60; ++tick) {
        world.Step();
        least = std::min(least, world.FindCentre(body).z());
        most = std::max(most, world.FindCentre(body).z());
      }
      EXPECT_LT(most - least, 1e-3) << "body " << body.id << " rests";
    }
  }
}
INSTANTIATE_TEST_SUITE_P(All, LawTest,
                         testing::Values(ContactLaw::kPenalty, ContactLaw::kMagnetic, ContactLaw::kBacktracking));

}  // namespace
}  // namespace wobble::physics
