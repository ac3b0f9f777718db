// Bounce height. A body falls on a plane; the height of its centre at the top of the first rebound, above its height
// when the body just touches, is compared with
//   particles without loss: the height of the fall, by conservation of energy;
//   particles with restitution: the law of contact.h, written again as one equation, m z'' = −mg + N(−z, −z'), and
//     solved in steps of a microsecond;
//   balls and lattices: their own equations, all vertices against the plane, by RK4 in steps so fine that half as many
//     give the same height (the difference is in the row).
// A rebound is well-posed: it ends after one impact, which lasts a few of the slowest periods.
#include <algorithm>
#include <cmath>

#include "server/physics/methods/forces.h"
#include "server/physics/methods/runge_kutta.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/step/losses.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

struct Bounce {
  std::string body;
  Blueprint blueprint;
  double fall;          // of the lowest vertex, m
  double height = -1;   // expected rebound height, m; negative: to be solved in fine steps
  double rebound = 0;   // as played
  double coarser = 0;   // reference with half as many steps
  double substeps = 0;  // the most in any tick of play
  std::vector<std::array<double, 2>> played, reference;  // height of the centre over time
};

// Finds the top of the first rebound from successive heights and velocities of the centre, m. In flight the centre is a
// particle: its top is at z + v²/2g from any point of the flight.
class TopFinder {
 public:
  // False once the top has been passed.
  bool Add(double z, double v) {
    m_falls |= v < 0 && !m_rose;
    if (m_falls && v > 0) m_rose = true;
    if (!m_rose) return true;
    if (z > m_highest) {
      m_highest = z;
      m_top = z + v * std::fabs(v) / (2 * kContactGravity);
      if (v < 0) m_top = z + v * v / (2 * kContactGravity);
    }
    return v > 0;
  }
  double Top() const { return m_top; }

 private:
  bool m_falls = false;
  bool m_rose = false;
  double m_highest = -1e9;
  double m_top = 0;
};

double FindLowest(const Blueprint& blueprint) {
  double lowest = 0;
  for (const Vector3d& x : blueprint.rest) lowest = std::min(lowest, x.z());
  return lowest;
}

void PlayBounce(Bounce& each) {
  WorldSettings settings;
  settings.gravity = Vector3d(0, 0, -kContactGravity);
  World world(settings);
  world.AddBlueprint(each.blueprint);
  world.AddObstacle(Obstacle{});
  const double touching = -FindLowest(each.blueprint);
  world.AddBody(0, Vector3d(0, 0, touching + each.fall));
  TopFinder top;
  const Body& body = world.Bodies()[0];
  for (int tick = 1; tick < 600; ++tick) {
    each.substeps = std::max(each.substeps, static_cast<double>(world.Step().substeps));
    const double z = world.FindCentre(body).z() - touching;
    each.played.push_back({tick * kContactTick, z});
    if (!top.Add(z, FindVelocity(world, body).z())) break;
  }
  each.rebound = top.Top();
}

double SumZ(const Blueprint& blueprint, const std::vector<Vector3d>& values) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) sum += blueprint.full.masses[i] * values[i].z();
  return sum / blueprint.totalMass;
}

// Uses only the engine's forces and losses: no choice of steps, no candidate lists, no single precision.
double SolveFinely(const Blueprint& blueprint, double fall, int stepsATick, std::vector<std::array<double, 2>>* track) {
  const double touching = -FindLowest(blueprint);
  State<double> state = MakeState<double>(blueprint, Vector3d::Zero(), Vector3d::Zero());
  for (std::size_t i = 0; i < blueprint.rest.size(); ++i) {
    state.positions[i] = blueprint.rest[i] + Vector3d(0, 0, touching + fall);
    state.contacts.push_back({.surface = 0, .vertex = static_cast<std::uint32_t>(i)});
  }
  const std::vector<Surface<double>> surfaces{MakeSurface<double>(Obstacle{}, Vector3d::Zero())};
  Load<double> load;
  load.acceleration = Vector3d(0, 0, -kContactGravity);
  const auto accelerate = [&](std::span<const Vector3d> atX, std::span<const Vector3d> atV, std::span<Vector3d> a) {
    ComputeAccelerations<double>(blueprint.full, load, surfaces, state.contacts, atX, atV, a);
  };
  StageBuffers<double, 4> buffers;
  std::vector<double> scratch;
  TopFinder top;
  for (int step = 1; step < 600 * stepsATick; ++step) {
    if (step % stepsATick == 1) ApplyLosses<double>(blueprint, surfaces, kContactTick, scratch, state);
    StepRungeKutta<double>(kClassicRungeKutta, kContactTick / stepsATick, accelerate, std::span(state.positions),
                           std::span(state.velocities), buffers);
    UpdateAnchors<double>(blueprint.full.contact, surfaces, state.contacts, kContactTick / stepsATick, state.positions,
                          state.velocities);
    const double z = SumZ(blueprint, state.positions) - touching;
    if (track != nullptr && step % (stepsATick / 4) == 0) track->push_back({step * kContactTick / stepsATick, z});
    if (!top.Add(z, SumZ(blueprint, state.velocities))) break;
  }
  return top.Top();
}

// One particle under the law of contact.h, from its formulas.
double SolveParticle(const ContactParameters<double>& law, double mass, double fall) {
  const auto accelerate = [&](double z, double v) {
    const double d = -z;
    if (d <= 0) return -kContactGravity;
    const double spring =
        d < law.fadeDepth ? law.stiffness * d * d / (2 * law.fadeDepth) : law.stiffness * (d - law.fadeDepth / 2);
    const double s = std::min(1.0, d / law.fadeDepth);
    return -kContactGravity + std::max(0.0, spring - law.damping * s * s * (3 - 2 * s) * v) / mass;
  };
  constexpr double h = 1e-6;
  double z = 0;
  double v = -std::sqrt(2 * kContactGravity * fall);
  do {  // midpoint rule
    const double middleZ = z + h / 2 * v;
    const double middleV = v + h / 2 * accelerate(z, v);
    z += h * middleV;
    v += h * accelerate(middleZ, middleV);
  } while (z < 0);
  return z + v * v / (2 * kContactGravity);
}

std::vector<Bounce> MakeBounces(bool quick) {
  std::vector<Bounce> cases;
  const auto add = [&](const std::string& body, const Blueprint& blueprint, std::initializer_list<double> falls) {
    for (const double fall : falls) {
      cases.push_back({});
      cases.back().body = body;
      cases.back().blueprint = blueprint;
      cases.back().fall = fall;
      if (quick) break;
    }
  };
  const auto addParticles = [&](double restitution) {
    const std::size_t first = cases.size();
    char name[48];
    std::snprintf(name, sizeof name, "particle, restitution %g", restitution);
    add(name, MakeParticles(restitution), {1, 0.3, 3});
    for (std::size_t i = first; i < cases.size(); ++i) {
      Bounce& each = cases[i];
      each.height = restitution == 1
                        ? each.fall
                        : SolveParticle(each.blueprint.full.contact, each.blueprint.full.masses[0], each.fall);
    }
  };
  for (const double restitution : {1.0, 0.8, 0.5}) addParticles(restitution);
  for (const int subdivisions : {1, 2, 3}) {
    if (quick && subdivisions == 3) continue;
    const Blueprint ball = MakeBall(DescribeBall(subdivisions));
    add("ball of " + std::to_string(ball.rest.size()), ball, {1, 0.3, 3});
  }
  // A ground without loss; the body feels the strongest field during its whole fall.
  for (const double strength : {1e-2, 1e-4, 1.0, 1e-1}) {
    if (quick && strength > 1e-2) continue;
    Blueprint ball = MakeBall(DescribeBall(2));
    SetContactLaw(ball, ContactLaw::kMagnetic, strength);
    char name[48];
    std::snprintf(name, sizeof name, "ball of 162, magnetic, K = %g", strength);
    add(name, ball, {3});
  }
  add("hard ball of 162", MakeBall(DescribeHardBall(2, 10)), {1, 3, 5});
  add("lattice cube", MakeLattice(DescribeCube(10000, 0.8)), {0.5, 1});
  return cases;
}

}  // namespace

void MeasureBounces(Bench& bench) {
  std::vector<Bounce> cases = MakeBounces(bench.options.quick);
  const int stepsATick = bench.options.quick ? 256 : 1024;
  const bool done = RunTrials(bench, cases.size(), [&](std::size_t i) {
    Bounce& each = cases[i];
    PlayBounce(each);
    if (each.height >= 0) return;
    each.coarser = SolveFinely(each.blueprint, each.fall, stepsATick / 2, nullptr);
    each.height = SolveFinely(each.blueprint, each.fall, stepsATick, &each.reference);
  });
  if (!done) return;

  double worst = 0;
  for (const Bounce& each : cases) {
    const double error = std::fabs(each.rebound - each.height) / each.height;
    worst = std::isfinite(error) ? std::max(worst, error) : error;
    bench.results.rows.push_back({{"experiment", "bounce"},
                                  {"body", each.body},
                                  {"fall", each.fall},
                                  {"must_be", each.height},
                                  {"played", each.rebound},
                                  {"error", error},
                                  {"reference_change", each.coarser > 0 ? each.height - each.coarser : 0},
                                  {"most_substeps", each.substeps}});
  }
  bench.results.AddFigureAtMost("bounce_error", worst, 0.01);
  const auto shown =
      std::find_if(cases.begin(), cases.end(), [](const Bounce& each) { return each.body == "ball of 162"; });
  bench.results.plots.push_back(
      {"bounce",
       "A ball of 162 vertices dropped from 1 m",
       "time, s",
       "height of the centre above touching, m",
       {{"played", Stroke::kPoints, shown->played}, {"reference", Stroke::kLine, shown->reference}}});
}

}  // namespace wobble::bench
