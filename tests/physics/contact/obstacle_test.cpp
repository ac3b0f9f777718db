// Static obstacles: distances against a search over the surface itself, and bodies that lie on obstacles, roll off them
// and are shot at them.
#include "server/physics/contact/obstacle.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "server/physics/contact/contact.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"
#include "tests/support/pace.h"

namespace wobble::physics {
namespace {

Obstacle MakeSphere(const Vector3d& centre, double radius) {
  Obstacle sphere;
  sphere.kind = Obstacle::Kind::kSphere;
  sphere.centre = centre;
  sphere.radius = radius;
  return sphere;
}

Obstacle MakeCapsule(const Vector3d& from, const Vector3d& to, double radius) {
  Obstacle capsule = MakeSphere(from, radius);
  capsule.kind = Obstacle::Kind::kCapsule;
  capsule.end = to;
  return capsule;
}

// Ground with nodes at corner + cellSize · (i, j) and heights given by `height` at their place in the world.
Obstacle MakeGround(const Vector3d& corner, int nodes, double cellSize,
                    const std::function<double(double, double)>& height) {
  std::vector<double> heights;
  for (int row = 0; row < nodes; ++row) {
    for (int column = 0; column < nodes; ++column) {
      heights.push_back(height(corner.x() + cellSize * column, corner.y() + cellSize * row) - corner.z());
    }
  }
  Obstacle ground;
  ground.kind = Obstacle::Kind::kHeightField;
  ground.centre = corner;
  ground.field = MakeHeightField(nodes, cellSize, heights);
  return ground;
}

double Hills(double x, double y) { return 0.8 * std::sin(0.7 * x) * std::cos(0.9 * y) + 0.2 * x; }

Obstacle MakeHills() { return MakeGround(Vector3d(-5, -5, 0.25), 41, 0.25, Hills); }

double HeightOf(const Obstacle& ground, const Vector3d& x) {
  return ground.centre.z() + FindHeight(*ground.field, x.x() - ground.centre.x(), x.y() - ground.centre.y());
}

// The distance from x to the nearest of many points of the ground within `reach`, m.
double SearchGround(const Obstacle& ground, const Vector3d& x, double reach) {
  double nearest = 1e9;
  Vector3d best = x;
  for (double step = reach / 40; step > 1e-4; step /= 10) {
    const Vector3d middle = best;
    for (int i = -40; i <= 40; ++i) {
      for (int j = -40; j <= 40; ++j) {
        Vector3d place = middle + step * Vector3d(i, j, 0);
        place.z() = HeightOf(ground, place);
        if ((place - x).norm() < nearest) nearest = (place - x).norm(), best = place;
      }
    }
  }
  return nearest;
}

TEST(Obstacle, SphereAndCapsuleAreAsFarAsTheirNearestPoint) {
  const Obstacle capsule = MakeCapsule(Vector3d(1, 2, 3), Vector3d(2, 0, 3.5), 0.6);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(-3, 3);
  for (int i = 0; i < 500; ++i) {
    const Vector3d x = Vector3d(1.5, 1, 3) + Vector3d(within(random), within(random), within(random));
    double toAxis = 1e9;
    for (int step = 0; step <= 100000; ++step) {
      const double share = step * 1e-5;
      toAxis = std::min(toAxis, (capsule.centre + share * (capsule.end - capsule.centre) - x).squaredNorm());
    }
    const Vector3d origin(100, -50, 20);
    const auto surface = MakeSurface<double>(capsule, origin);
    const auto point = FindSurfacePoint(surface, Vector3d(x - origin));
    ASSERT_NEAR(point.distance, std::sqrt(toAxis) - 0.6, 1e-8) << x.transpose();
    // The foot of x along the normal lies on the surface.
    const Vector3d foot = x - origin - point.distance * point.normal;
    ASSERT_NEAR(FindSurfacePoint(surface, foot).distance, 0, 1e-12);
    const auto ball = MakeSurface<double>(MakeSphere(capsule.centre, 0.6), origin);
    ASSERT_NEAR(FindSurfacePoint(ball, Vector3d(x - origin)).distance, (x - capsule.centre).norm() - 0.6, 1e-12);
    ASSERT_EQ(FindClearance(ball, Vector3d(x - origin)), FindSurfacePoint(ball, Vector3d(x - origin)).distance);
  }
  const auto middle = FindSurfacePoint(MakeSurface<double>(MakeSphere(Vector3d::Zero(), 2), Vector3d::Zero()),
                                       Vector3d(Vector3d::Zero()));
  EXPECT_EQ(middle.distance, -2);
  EXPECT_EQ(middle.normal, Vector3d(0, 0, 1)) << "some way out, and no NaN";
}

TEST(HeightField, GoesThroughItsHeightsAndIsExactOnAPlane) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> height(-2, 2);
  std::vector<double> heights;
  for (int i = 0; i < 7 * 4; ++i) heights.push_back(height(random));
  const auto field = MakeHeightField(7, 0.5, heights);
  EXPECT_EQ(field->rows, 4);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 7; ++column) {
      const double given = heights[static_cast<std::size_t>(row * 7 + column)];
      EXPECT_NEAR(FindHeight(*field, 0.5 * column, 0.5 * row), given, 1e-12) << column << ", " << row;
    }
  }
  const Obstacle slope = MakeGround(Vector3d::Zero(), 5, 2, [](double x, double y) { return 3 + x / 2 - y / 4; });
  for (double x = 0; x <= 8; x += 0.31) EXPECT_NEAR(HeightOf(slope, Vector3d(x, 3.3, 0)), 3 + x / 2 - 3.3 / 4, 1e-12);
  EXPECT_NEAR(slope.field->steepest, std::hypot(0.5, 0.25), 1e-12);
}

// The ways cross borders of cells too.
TEST(HeightField, NormalTurnsWithoutAJumpAndIsTheGradientOnTheGround) {
  const Obstacle hills = MakeHills();
  const auto surface = MakeSurface<double>(hills, Vector3d::Zero());
  Vector3d before = Vector3d::Zero();
  for (double t = -4; t < 4; t += 1e-3) {
    Vector3d x(t, 0.37 * t + 0.1, 0);
    x.z() = HeightOf(hills, x);
    const auto point = FindSurfacePoint(surface, x);
    ASSERT_NEAR(point.distance, 0, 1e-12);
    ASSERT_NEAR(point.normal.norm(), 1, 1e-12);
    if (t > -4) {
      ASSERT_LT((point.normal - before).norm(), 2e-3) << "turns by 1 rad/m or so";
    }
    before = point.normal;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = 1e-6 * Vector3d::Unit(axis);
      const double slope = (FindSurfacePoint(surface, Vector3d(x + step)).distance -
                            FindSurfacePoint(surface, Vector3d(x - step)).distance) /
                           2e-6;
      ASSERT_NEAR(slope, point.normal[axis], 1e-5) << x.transpose();
    }
  }
}

TEST(HeightField, DistanceIsRightToTheFirstOrder) {
  const Obstacle hills = MakeHills();
  const auto surface = MakeSurface<double>(hills, Vector3d::Zero());
  double worst = 0;
  for (const double depth : {-0.1, -0.02, 0.02, 0.1}) {
    for (double t = -3.5; t < 3.5; t += 0.43) {
      Vector3d x(t, -0.6 * t, 0);
      x.z() = HeightOf(hills, x);
      x += depth * FindSurfacePoint(surface, x).normal;  // so the ground is |depth| away, or nearer
      const double found = FindSurfacePoint(surface, x).distance;
      const double truth = std::copysign(SearchGround(hills, x, 0.3), depth);
      EXPECT_EQ(found > 0, depth > 0);
      worst = std::max(worst, std::fabs(found - truth) / (depth * depth));
    }
  }
  EXPECT_LT(worst, 0.5) << "times the square of the distance, at radii of curvature from 1.5 m";
}

// The two bounds of FindContacts: the clearance that skips a body, and the approach that judges a vertex.
TEST(HeightField, ClearanceAndApproachPromiseNoMoreThanIsTrue) {
  const Obstacle cliff =
      MakeGround(Vector3d(-2, -2, 0), 17, 0.25, [](double x, double) { return x > 0.5 ? 2.0 : 0.0; });
  const auto surface = MakeSurface<double>(cliff, Vector3d(0.3, 0.1, 1));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> within(-4, 4);
  int near = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d x = Vector3d(within(random), within(random), within(random) + 3);
    double truth = 1e9;
    for (double u = -2; u <= 2; u += 0.02) {
      for (double v = -2; v <= 2; v += 0.02) {
        truth = std::min(truth, (Vector3d(u, v, HeightOf(cliff, Vector3d(u, v, 0))) - x).norm());
      }
    }
    const double clearance = FindClearance(surface, Vector3d(x - Vector3d(0.3, 0.1, 1)));
    EXPECT_LE(clearance, truth + 1e-9) << x.transpose();
    if (clearance > truth / 4) ++near;
    // A vertex that goes straight at 50 m/s in any direction is not in the ground before its approach allows it.
    const auto point = FindSurfacePoint(surface, Vector3d(x - Vector3d(0.3, 0.1, 1)));
    const Vector3d v = 50 * Vector3d(within(random), within(random), within(random)).normalized();
    const double approach = FindApproach(surface, point, v);
    if (point.distance <= 0 || point.distance >= kBeyond) continue;
    const double safe = approach > 0 ? std::min(0.1, 0.999 * point.distance / approach) : 0.1;
    for (int step = 0; step <= 50; ++step) {
      const Vector3d at = x + v * (safe * step / 50);
      if (std::max(std::fabs(at.x()), std::fabs(at.y())) > 2) break;
      EXPECT_GE(at.z(), HeightOf(cliff, at)) << x.transpose() << " going " << v.transpose();
    }
  }
  EXPECT_GT(near, 100) << "a clearance of nothing would be true as well";
  EXPECT_EQ(FindSurfacePoint(surface, Vector3d(5, 0, -3)).distance, kBeyond) << "nothing beyond the rectangle";
}

// Random trials found a ball that had rolled off the edge of the ground and in under it, and was shot out at 15 km/s.
TEST(HeightField, WhatComesInUnderItFromBesideIsLeftAlone) {
  World world{WorldSettings{}};
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddObstacle(MakeGround(Vector3d(-8, -8, 0), 9, 2, [](double, double) { return 0.0; }));
  const BodyId under = world.AddBody(0, Vector3d(10, 0, -3), Vector3d(-8, 0, 0));
  const BodyId over = world.AddBody(0, Vector3d(0, 0, 1));
  const BodyId inside = world.AddBody(0, Vector3d(0, 4, 0.3));  // put there, it is pushed out
  for (int tick = 0; tick < 60; ++tick) {
    world.Step();
    for (const Vector3<float>& v : std::get<State<float>>(world.ReadBody(under).state).velocities) {
      ASSERT_LT(v.norm(), 20) << "tick " << tick;
    }
  }
  EXPECT_LT(world.FindCentre(world.ReadBody(under)).x(), 4) << "it went in";
  EXPECT_LT(world.FindCentre(world.ReadBody(under)).z(), -7) << "and falls on";
  EXPECT_GT(world.FindCentre(world.ReadBody(over)).z(), 0.3);
  EXPECT_GT(world.FindCentre(world.ReadBody(inside)).z(), 0.3);
}

// A ball that quivers faster than it drifts in: its vertices' velocities tell nothing of the way that they have come.
TEST(HeightField, WhatQuiversInUnderItIsLeftAlone) {
  for (const double drift : {-0.05, -0.5, -3.0}) {
    World world{WorldSettings{.gravity = Vector3d::Zero()}};
    BallDefinition ball;
    ball.material.dampingRatio = 0;
    world.AddBlueprint(MakeBall(ball));
    world.AddObstacle(MakeGround(Vector3d(-8, -8, 0), 9, 2, [](double, double) { return 0.0; }));
    const BodyId under = world.AddBody(0, Vector3d(8.52, 0, -30));
    std::vector<Vector3d> positions;
    std::vector<Vector3d> velocities;
    VisitVertices(world.ReadBody(under), [&](std::size_t i, const Vector3d& x) {
      positions.push_back(x);
      velocities.emplace_back(drift + (i % 2 == 0 ? 3 : -3), 0, 0);
    });
    world.SetMotion(under, positions, velocities);
    for (int tick = 0; tick < 120; ++tick) {
      ASSERT_EQ(world.Step().quarantined, 0U) << drift << " m/s, tick " << tick;
      for (const Vector3<float>& v : std::get<State<float>>(world.ReadBody(under).state).velocities) {
        ASSERT_LT(v.norm(), 15) << drift << " m/s, tick " << tick;
      }
    }
    EXPECT_LT(world.FindCentre(world.ReadBody(under)).x(), 8.5) << "it has drifted in";
  }
}

// Far from the field's corner single precision gives what double gives, since both count from the body's origin.
TEST(HeightField, IsAsExactFarFromItsCorner) {
  const Obstacle ground = MakeGround(Vector3d(-2000, -2000, 100), 128, 20, [](double x, double y) {
    return 150 + 20 * std::sin(x / 100) * std::sin(y / 80);
  });
  for (const Vector3d& origin : {Vector3d(31.7, 380.2, 140), Vector3d(411, -1777.7, 155)}) {
    const auto single = MakeSurface<float>(ground, origin);
    const auto full = MakeSurface<double>(ground, origin);
    for (double t = -3; t < 3; t += 0.21) {
      const Vector3d x(t, 0.7 * t, 0.2 * t);
      EXPECT_NEAR(static_cast<double>(FindSurfacePoint(single, Vector3f(x.cast<float>())).distance),
                  FindSurfacePoint(full, x).distance, 1e-5);
    }
  }
}

struct Place {
  explicit Place(std::vector<Obstacle> obstacles, Precision precision = Precision::kSingle)
      : world(WorldSettings{.precision = precision}) {
    world.AddBlueprint(MakeBall(BallDefinition{}));
    for (const Obstacle& obstacle : obstacles) world.AddObstacle(obstacle);
  }
  void Run(double seconds) {
    for (int i = 0; i < std::lround(seconds * 60); ++i) {
      const StepReport report = world.Step();
      EXPECT_EQ(report.nonFinite + report.inverted, 0U) << "tick " << world.Tick();
    }
  }
  [[nodiscard]] Vector3d Centre(BodyId body) const { return world.FindCentre(world.ReadBody(body)); }

  World world;
};

TEST(Obstacle, BallRestsBetweenThreeSpheres) {
  std::vector<Obstacle> spheres;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * 3.14159265358979 * i / 3;
    spheres.push_back(MakeSphere(Vector3d(std::cos(angle), std::sin(angle), 0), 0.8));
  }
  Place place(spheres);
  const BodyId ball = place.world.AddBody(0, Vector3d(0.05, 0, 1.5));
  place.Run(30);
  const Vector3d before = place.Centre(ball);
  place.Run(1);
  EXPECT_LT((place.Centre(ball) - before).norm(), 2e-3);
  EXPECT_GT(before.z(), 0.1) << "carried";
  EXPECT_LT(std::hypot(before.x(), before.y()), 0.1) << "in the middle";
}

TEST(Obstacle, BallRollsOffASphereAndAlongACapsule) {
  Place place(
      {MakeSphere(Vector3d(0, 0, 1), 1), MakeCapsule(Vector3d(10, -5, 2), Vector3d(10, 5, 1), 0.7), Obstacle{}});
  const BodyId onSphere = place.world.AddBody(0, Vector3d(0.05, 0.02, 2.6));
  const BodyId onCapsule = place.world.AddBody(0, Vector3d(10, -4, 3.2));
  place.Run(1.5);
  EXPECT_GT(place.Centre(onSphere).z(), 1.5) << "stays for a moment";
  EXPECT_GT(place.Centre(onCapsule).y(), -3.9) << "down along the capsule";
  place.Run(10);
  EXPECT_LT(place.Centre(onSphere).z(), 0.6) << "down on the floor";
  EXPECT_GT(place.Centre(onSphere).head<2>().norm(), 1);
}

TEST(HeightField, BallFindsTheValleyAndJellyLiesStillInIt) {
  const Obstacle valley =
      MakeGround(Vector3d(-4, -4, -1), 33, 0.25, [](double x, double y) { return 0.15 * ((x - 1) * (x - 1) + y * y); });
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    Place place({valley}, precision);
    const BodyId ball = place.world.AddBody(0, Vector3d(-1.5, 1, 2));
    place.Run(60);
    EXPECT_NEAR(place.Centre(ball).x(), 1, 0.3) << "2.5 m off at first; it rolls to and fro for long";
    EXPECT_NEAR(place.Centre(ball).y(), 0, 0.3);
    VisitVertices(place.world.ReadBody(ball), [&](std::size_t i, const Vector3d& x) {
      EXPECT_GT(x.z() - HeightOf(valley, x), -0.01) << "vertex " << i;
    });
  }
  World world({});
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.5)));
  world.AddObstacle(valley);
  const BodyId cube = world.AddBody(0, Vector3d(0.6, 0.2, 0.8));
  for (int tick = 0; tick < 600; ++tick) world.Step();
  const Vector3d before = world.FindCentre(world.ReadBody(cube));
  for (int tick = 0; tick < 60; ++tick) world.Step();
  EXPECT_LT((world.FindCentre(world.ReadBody(cube)) - before).norm(), 1e-3);
  EXPECT_GT(before.z(), 0.3);
}

// Shots at 10 to 30 m/s at a ridge, a sphere, a capsule and a box: no vertex gets so deep that it could come out
// behind, nor much deeper than into the box. A narrow obstacle is met by few vertices with the whole ball behind them.
TEST(Obstacle, NothingShotAtThemGoesThrough) {
  const Obstacle ridge = MakeGround(Vector3d(-6, -6, 0), 49, 0.25, [](double x, double y) {
    return 3 * std::exp(-(x - 2) * (x - 2)) + 0.3 * std::sin(y);
  });
  const Obstacle sphere = MakeSphere(Vector3d(-40, 0, 2), 2);
  const Obstacle capsule = MakeCapsule(Vector3d(-80, -3, 0), Vector3d(-80, 3, 3), 1.5);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-1, 1);
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  box.centre = Vector3d(-120, 0, 2);
  box.halfExtents = Vector3d(2, 4, 4);
  std::array<double, 4> deepest{};
  for (int shot = 0; shot < test::Shorten(12); ++shot) {
    Place place({ridge, sphere, capsule, box});
    const double speed = 18 + 7 * within(random);  // faster, the ball is crushed flat
    const Vector3d jitter(0, within(random), 0.5 * within(random));
    std::vector<std::pair<BodyId, std::size_t>> balls;
    for (std::size_t target = 0; target < 4; ++target) {
      const Vector3d from = Vector3d(-40.0 * static_cast<double>(target) - 4, 0, 1.6) + jitter;
      balls.emplace_back(place.world.AddBody(0, from, Vector3d(speed, 0, -2)), target);
    }
    for (int tick = 0; tick < 60; ++tick) {
      place.Run(1.0 / 60);
      for (const auto& [body, target] : balls) {
        const auto surface = MakeSurface<double>(place.world.Obstacles()[target], Vector3d::Zero());
        VisitVertices(place.world.ReadBody(body), [&](std::size_t, const Vector3d& x) {
          deepest[target] = std::max(deepest[target], -FindSurfacePoint(surface, x).distance);
        });
      }
    }
  }
  for (std::size_t target = 0; target < 4; ++target) {
    EXPECT_GT(deepest[target], 0) << "target " << target << " was hit";
    EXPECT_LT(deepest[target], std::min(0.3, 2 * deepest[3])) << "m, target " << target;
  }
}

TEST(Contact, FarBodiesAreClearedByOneLook) {
  const Obstacle hills = MakeHills();
  const std::vector<Surface<float>> surfaces{MakeSurface<float>(hills, Vector3d(0, 0, 20)),
                                             MakeSurface<float>(MakeSphere(Vector3d(0, 0, 5), 3), Vector3d(0, 0, 20))};
  EXPECT_GT(FindClearance(surfaces[0], Vector3f(0, 0, 0)), 10);
  EXPECT_GT(FindClearance(surfaces[1], Vector3f(0, 0, 0)), 11.9F);
  EXPECT_GT(FindClearance(surfaces[0], Vector3f(30, 0, -20)), 24.9F) << "beside it";
}

}  // namespace
}  // namespace wobble::physics
