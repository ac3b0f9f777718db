// Conservation of momentum and angular momentum in collisions. Pairs in free space collide off centre, with friction,
// at a speed of normal play.
//
// Errors are relative to the exchanged amount: Σ m |v − v̄| for momentum, Σ m |x − x̄| |v − v̄| at the start for
// angular momentum, about the common centre of mass. Double precision, so that the method itself is measured; rows also
// have single precision, where rounding of positions adds its part.
#include <algorithm>
#include <cmath>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

struct Collision {
  std::string bodies;
  Blueprint first, second;
  double speed = 0;   // of each towards the other, m/s
  double offset = 0;  // between their paths, m
  Precision precision = Precision::kDouble;
  double linear = 0;
  double angular = 0;
  double angularFine = 0;  // the same with ticks an eighth as long
  double turned = 0;       // spin given to the first body, as a share of the angular momentum scale
};

struct Sums {
  double mass = 0;
  Vector3d moment = Vector3d::Zero();
  Vector3d momentum = Vector3d::Zero();
  Vector3d angular = Vector3d::Zero();  // about the origin
  double linearScale = 0;
  double angularScale = 0;
};

template <class Visit>
void VisitMasses(const World& world, Visit&& visit) {
  for (const Body& body : world.Bodies()) {
    const std::vector<double>& masses = world.BlueprintOf(body).full.masses;
    const std::vector<Vector3d> x = ReadPositions(body);
    const std::vector<Vector3d> v = ReadVelocities(body);
    for (std::size_t i = 0; i < x.size(); ++i) visit(masses[i], x[i], v[i]);
  }
}

Sums AddUp(const World& world) {
  Sums sums;
  VisitMasses(world, [&](double m, const Vector3d& x, const Vector3d& v) {
    sums.mass += m;
    sums.moment += m * x;
    sums.momentum += m * v;
    sums.angular += m * x.cross(v);
  });
  const Vector3d centre = sums.moment / sums.mass;
  const Vector3d mean = sums.momentum / sums.mass;
  VisitMasses(world, [&](double m, const Vector3d& x, const Vector3d& v) {
    sums.linearScale += m * (v - mean).norm();
    sums.angularScale += m * (x - centre).norm() * (v - mean).norm();
  });
  return sums;
}

struct Drift {
  double linear = 0;
  double angular = 0;
};

Drift PlayCollision(const Collision& each, double tick) {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  settings.precision = each.precision;
  settings.tickDuration = tick;
  World world(settings);
  world.AddBlueprint(each.first);
  world.AddBlueprint(each.second);
  world.AddBody(0, Vector3d(-1, each.offset / 2, 0.03), Vector3d(each.speed, 0, 0));
  world.AddBody(1, Vector3d(1, -each.offset / 2, 0), Vector3d(-each.speed, 0.1 * each.speed, 0));
  const Sums before = AddUp(world);
  Drift drift;
  for (int i = 0; i < std::lround(1.0 / tick); ++i) {
    world.Step();
    const Sums now = AddUp(world);
    drift.linear = std::max(drift.linear, (now.momentum - before.momentum).norm() / before.linearScale);
    drift.angular = std::max(drift.angular, (now.angular - before.angular).norm() / before.angularScale);
  }
  return drift;
}

std::vector<Collision> MakeCollisions(bool quick) {
  const Blueprint ball = MakeBall(DescribeBall(2));
  const Blueprint small = MakeBall(DescribeBall(1));
  const Blueprint cube = MakeLattice(DescribeCube(20000, 0.8));
  std::vector<Collision> cases;
  const auto add = [&](const std::string& bodies, const Blueprint& first, const Blueprint& second) {
    for (const double speed : {2.0, 5.0}) {
      for (const double offset : {0.2, 0.5}) {
        if (quick && (speed != 5 || offset != 0.5)) continue;
        for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
          cases.push_back({bodies, first, second, speed, offset, precision});
        }
      }
    }
  };
  add("ball, ball", ball, ball);
  add("ball of 42, ball", small, ball);
  add("ball, cube", ball, cube);
  add("cube, cube", cube, cube);
  return cases;
}

}  // namespace

void MeasureCollisions(Bench& bench) {
  std::vector<Collision> cases = MakeCollisions(bench.options.quick);
  const bool done = RunTrials(bench, cases.size(), [&](std::size_t i) {
    const Drift drift = PlayCollision(cases[i], kContactTick);
    cases[i].linear = drift.linear;
    cases[i].angular = drift.angular;
    if (!bench.options.quick) cases[i].angularFine = PlayCollision(cases[i], kContactTick / 8).angular;
  });
  if (!done) return;
  double worst = 0;
  for (const Collision& each : cases) {
    const bool isDouble = each.precision == Precision::kDouble;
    if (isDouble) worst = std::max({worst, each.linear, each.angular});
    bench.results.rows.push_back({{"experiment", "collision"},
                                  {"bodies", each.bodies},
                                  {"precision", isDouble ? "double" : "single"},
                                  {"speed", each.speed},
                                  {"offset", each.offset},
                                  {"momentum_drift", each.linear},
                                  {"angular_momentum_drift", each.angular},
                                  {"angular_momentum_drift_eighth_ticks", each.angularFine}});
  }
  bench.results.AddFigureAtMost("momentum_drift", worst, 1e-5);
}

}  // namespace wobble::bench
