// The slope at which a cube begins to slide. By Coulomb's law tan θ = μ, independent of its weight.
//
// Gravity is tilted instead of the plane. The cube comes to rest on the level, then the slope grows slowly; a second
// later the cube slides if its centre moves farther in the next second than creep explains. The angle is bisected
// between one that holds and one that does not.
//
// The same on a slab that is held by much more friction (contact between bodies, whose coefficient is the geometric
// mean) has its own figure.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kSettle = 1;     // s
constexpr double kWatch = 1;      // s
constexpr double kCreep = 0.004;  // m in kWatch
constexpr int kBisections = 8;    // of kSpan either way: to 0.04°
constexpr double kSpan = 10;      // around the angle of Coulomb's law, degrees

struct Slope {
  bool onSlab = false;
  double friction = 0;
  double angle = 0;  // measured, degrees
};

// Distance travelled in kWatch after kSettle, m, and the speed at its end, m/s.
struct Motion {
  double way = 0;
  double speed = 0;
};

Motion PlaySlope(bool onSlab, double friction, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  WorldSettings settings;
  settings.gravity = Vector3d(0, 0, -kContactGravity);
  World world(settings);
  LatticeDefinition cube = DescribeCube(20000, friction);
  cube.cells = {2, 2, 2};
  cube.cellSize = 0.2;
  world.AddBlueprint(MakeLattice(cube));
  Obstacle plane;
  plane.friction = onSlab ? 20 / friction : 1;
  world.AddObstacle(plane);
  double floor = 0;
  if (onSlab) {
    LatticeDefinition slab = cube;
    slab.cells = {7, 5, 1};
    world.AddBlueprint(MakeLattice(slab));
    world.AddBody(1, Vector3d(0.3, 0, 0.1));
    floor = 0.2;
  }
  const BodyId id = world.AddBody(0, Vector3d(0, 0, floor + 0.2));
  const auto step = [&world](double duration) {
    for (int i = 0; i < std::lround(60 * duration); ++i) world.Step();
  };
  const auto findX = [&] {
    const double base = onSlab ? world.FindCentre(world.Bodies()[0]).x() : 0;
    return world.FindCentre(world.ReadBody(id)).x() - base;
  };
  step(kSettle);
  constexpr int kTiltTicks = 120;  // a sudden tilt would shake the cube loose
  for (int i = 1; i <= kTiltTicks; ++i) {
    const double now = angle * i / kTiltTicks;
    world.SetGravity(kContactGravity * Vector3d(std::sin(now), 0, -std::cos(now)));
    world.Step();
  }
  step(kSettle);
  const double from = findX();
  step(kWatch);
  return {findX() - from, FindVelocity(world, world.ReadBody(id)).x()};
}

double FindAngle(const Slope& each) {
  const double theory = std::atan(each.friction) * 180 / std::numbers::pi;
  double holds = theory - kSpan;
  double slides = theory + kSpan;
  const auto slidesAt = [&](double angle) { return PlaySlope(each.onSlab, each.friction, angle).way > kCreep; };
  if (slidesAt(holds)) return holds;
  if (!slidesAt(slides)) return slides;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = (holds + slides) / 2;
    (slidesAt(middle) ? slides : holds) = middle;
  }
  return (holds + slides) / 2;
}

// Plots the speed after the two seconds over the slope, as played and by Coulomb's law.
void AddPlot(Bench& bench, double friction) {
  Series played{"played", Stroke::kPoints, {}};
  Series theory{"g (sin θ − μ cos θ) t", Stroke::kLine, {}};
  std::vector<double> angles;
  for (double angle = 10; angle <= 34; angle += bench.options.quick ? 4 : 1) angles.push_back(angle);
  played.points.resize(angles.size());
  theory.points.resize(angles.size());
  const bool done = RunTrials(bench, angles.size(), [&](std::size_t i) {
    const double angle = angles[i] * std::numbers::pi / 180;
    const double acceleration = std::max(0.0, kContactGravity * (std::sin(angle) - friction * std::cos(angle)));
    played.points[i] = {angles[i], PlaySlope(false, friction, angles[i]).speed};
    theory.points[i] = {angles[i], acceleration * (kSettle + kWatch)};
  });
  if (!done) return;
  bench.results.plots.push_back(
      {"slide", "A cube on a slope, μ = 0.4, after 2 s", "slope, degrees", "speed, m/s", {played, theory}});
}

}  // namespace

void MeasureSlides(Bench& bench) {
  std::vector<Slope> cases;
  for (const double friction : {0.2, 0.4, 0.6, 0.8}) {
    if (bench.options.quick && friction != 0.4) continue;
    for (const bool onSlab : {false, true}) cases.push_back({onSlab, friction});
  }
  if (!RunTrials(bench, cases.size(), [&](std::size_t i) { cases[i].angle = FindAngle(cases[i]); })) return;
  double worst = 0;
  double worstOnSlab = 0;
  for (const Slope& each : cases) {
    const double theory = std::atan(each.friction) * 180 / std::numbers::pi;
    double& worstThere = each.onSlab ? worstOnSlab : worst;
    worstThere = std::max(worstThere, std::fabs(each.angle - theory));
    bench.results.rows.push_back({{"experiment", "slide"},
                                  {"on", each.onSlab ? "slab" : "plane"},
                                  {"friction", each.friction},
                                  {"must_be_deg", theory},
                                  {"played_deg", each.angle}});
  }
  bench.results.AddFigureAtMost("slide_angle_error_deg", worst, 0.5);
  bench.results.AddFigureAtMost("slide_angle_error_on_slab_deg", worstOnSlab, 0.5);
  AddPlot(bench, 0.4);
}

}  // namespace wobble::bench
