// A fictitious external force compresses a body for half a second and then vanishes. With internal friction, every body
// returns to its rest shape; this experiment shows whether it does under each method at the same step.
//
// The force on a vertex is proportional to its mass and to its height above the centre, downwards above and upwards
// below: it neither moves nor turns the body, so the distance from the rest shape is the whole effect. (Forces tied to
// the vertices would tip over a body that is stiff enough.) A step of 1/240 s is well within the limits of RK4 and the
// Verlet family for both bodies; explicit Euler is stable only where damping exceeds the energy that it adds, h ω² < γ,
// and gas has no damping.
//
// Position Verlet has no spring forces that restore the shape, only lengths that it restores one after another: the
// body keeps moving as a whole long after its release, which counts as displacement here. Its row shows that and is not
// judged.
#include <cmath>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/lattice.h"
#include "tests/bench/accuracy/equations.h"
#include "tests/bench/accuracy/fixed_steps.h"
#include "tests/bench/stability/experiments.h"
#include "tests/bench/stability/free_body.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kStep = 1.0 / 240;
constexpr double kPushed = 0.5;  // s
constexpr double kWatched = 12;  // s, from the beginning of the force
constexpr double kExploded = 5;  // in sizes of the body
constexpr int kStepsASample = 3;
constexpr double kReturned = 0.01;  // of the largest displacement

struct PushedBody {
  std::string name;
  Blueprint blueprint;
  double push;  // acceleration at the body's extent, m/s²
};

struct PushTrial {
  const PushedBody* subject;
  Integrator integrator;
  double peak = 0;                                // largest displacement, RMS over vertices, m
  double left = 0;                                // final displacement over the largest
  double energyLeft = 0;                          // final energy over that at the release
  double explodedAt = NAN;                        // when vertices were kExploded sizes from their rest positions, s
  std::vector<std::array<double, 2>> track = {};  // s, displacement, m
};

PushedBody MakeCube() {
  LatticeDefinition cube;
  cube.dampingRatio = 0.1;
  return {"lattice of 64", MakeLattice(cube), 600};
}

PushedBody MakeGasBall() {
  BallDefinition ball;
  ball.radius = 1;
  ball.material.mass = 0.25 * static_cast<double>(CountVertices(ball.subdivisions));
  ball.material.stiffness = 750;
  ball.material.gas = 1000;
  return {"gas ball of 162", MakeBall(ball), 30};
}

void SetPushes(const PushedBody& subject, const std::vector<Vector3d>& x, std::vector<VertexForce<double>>& pushes) {
  pushes.clear();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double force = -subject.blueprint.full.masses[i] * subject.push * x[i].z() / subject.blueprint.reach;
    pushes.push_back({static_cast<std::uint16_t>(i), Vector3d(0, 0, force)});
  }
}

void PlayPush(PushTrial& trial) {
  const PushedBody& subject = *trial.subject;
  FreeBody body(subject.blueprint, trial.integrator);
  Equations equations;
  equations.blueprint = &subject.blueprint;
  const double atRest = FindEnergy(equations, body.x, body.v);
  std::vector<VertexForce<double>> pushes;
  double released = 0;
  double displacement = 0;
  for (int step = 1; step <= std::lround(kWatched / kStep); ++step) {
    const bool isPushed = step <= std::lround(kPushed / kStep);
    if (isPushed) SetPushes(subject, body.x, pushes);
    body.load.pushes = isPushed ? pushes : std::span<const VertexForce<double>>();
    body.Step(kStep);
    displacement = FindDisplacement(body);
    if (!(displacement < kExploded * subject.blueprint.size)) {
      trial.explodedAt = step * kStep;
      break;
    }
    trial.peak = std::max(trial.peak, displacement);
    if (isPushed) released = FindEnergy(equations, body.x, body.v) - atRest;
    if (step % kStepsASample == 0) trial.track.push_back({step * kStep, displacement});
  }
  trial.left = displacement / trial.peak;
  trial.energyLeft = (FindEnergy(equations, body.x, body.v) - atRest) / released;
}

bool HasExploded(const PushTrial& trial) { return !std::isnan(trial.explodedAt); }

void AddPushRow(Bench& bench, const PushTrial& trial) {
  nlohmann::ordered_json row = {{"experiment", "perturbation"},
                                {"method", FindName(trial.integrator)},
                                {"body", trial.subject->name},
                                {"step", kStep},
                                {"peak", trial.peak}};
  if (HasExploded(trial)) {
    row["exploded_s"] = trial.explodedAt;
  } else {
    row["left"] = trial.left;
    row["energy_left"] = trial.energyLeft;
  }
  row["returned"] = !HasExploded(trial) && trial.left <= kReturned;
  bench.results.rows.push_back(std::move(row));
}

void AddPushPlot(Bench& bench, const std::vector<PushTrial>& trials, const PushedBody& subject,
                 const std::string& name) {
  Plot plot{.name = name,
            .title = "A " + subject.name + " is pressed together for 0.5 s and let go, steps of 1/240 s",
            .xLabel = "time, s",
            .yLabel = "RMS way of the vertices from rest, m"};
  plot.logY = true;
  for (const PushTrial& trial : trials) {
    if (trial.subject != &subject) continue;
    plot.series.push_back({FindName(trial.integrator), Stroke::kLine, trial.track});
  }
  bench.results.plots.push_back(std::move(plot));
}

}  // namespace

void MeasurePerturbations(Bench& bench) {
  const PushedBody cube = MakeCube();
  const PushedBody ball = MakeGasBall();
  std::vector<PushTrial> trials;
  for (const PushedBody* subject : {&cube, &ball}) {
    for (const Integrator integrator : kIntegrators) trials.push_back({subject, integrator});
  }
  if (!RunTrials(bench, trials.size(), [&](std::size_t i) { PlayPush(trials[i]); })) return;
  double left = 0;
  double explodedAt = 0;
  for (const PushTrial& trial : trials) {
    AddPushRow(bench, trial);
    if (trial.integrator == Integrator::kRungeKutta4) left = std::max(left, HasExploded(trial) ? NAN : trial.left);
    if (trial.integrator == Integrator::kExplicitEuler && trial.subject == &cube) explodedAt = trial.explodedAt;
  }
  bench.results.AddFigureAtMost("perturbation_rk4_left", left, kReturned);
  bench.results.AddFigureAtMost("perturbation_euler_exploded_s", explodedAt, kWatched);
  AddPushPlot(bench, trials, cube, "stability_perturbation");
  AddPushPlot(bench, trials, ball, "stability_perturbation_ball");
}

}  // namespace wobble::bench
