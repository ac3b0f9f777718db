// Splits the displayed error by cause: the engine's error against a converged twin, the codec's at the moments that are
// sent, the curve's between them. Each is measured separately. The twin is the world in double precision, in quarter
// ticks with the most substeps, for one second from the same state with the same controls. The curve gets true states
// at 30 moments a second and is read as on a clean link, two and a half intervals later.
#include <cmath>

#include "client/interpolator.h"
#include "tests/bench/codec/play.h"
#include "tests/bench/codec/recording.h"
#include "tests/bench/contact/bodies.h"
#include "tests/bench/interpolation/experiments.h"
#include "tests/bench/interpolation/showing.h"
#include "tests/bench/interpolation/truth.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kActHz = 60;
constexpr int kTwinTicks = 4;  // twin ticks per world tick
constexpr int kTruthHz = 240;
constexpr int kSnapshotHz = 30;
constexpr double kRadiusPercent = 100;  // of a radius of 1 m

std::unique_ptr<World> MakeWorld(int tickHz) {
  WorldSettings settings;
  settings.tickDuration = 1.0 / tickHz;
  auto world = std::make_unique<World>(settings);
  for (const Obstacle& each : MakeArena()) world->AddObstacle(each);
  world->AddBlueprint(MakePlayedBall());
  for (std::size_t i = 0; i < kFixedPlayers; ++i) {
    world->AddBody(0, Vector3d(i % 2 == 0 ? -1.5 : 1.5, i < 2 ? -1.5 : 1.5, 1.5));
  }
  return world;
}

std::vector<Actor> MakeActors(std::uint64_t seed) {
  std::vector<Actor> actors;
  for (std::size_t i = 0; i < kFixedPlayers; ++i) actors.emplace_back(seed, i);
  return actors;
}

void Act(std::vector<Actor>& actors, World& world) {
  for (std::size_t i = 0; i < kFixedPlayers; ++i) {
    world.SetControl(world.Bodies()[i].id, actors[i].Act(Pattern::kChase, world), kPlayLimits);
  }
}

double FindMeanSquare(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return sum / static_cast<double>(a.size());
}

// Distance of each body from its twin after a second, % of the radius, RMS over vertices.
std::vector<double> MeasurePhysics(Bench& bench, int seconds) {
  WorldSettings converged;
  converged.precision = Precision::kDouble;
  converged.tickDuration = 1.0 / (kActHz * kTwinTicks);
  converged.errorTarget = 1e-12;  // unreachable
  const auto world = MakeWorld(kActHz);
  std::vector<Actor> actors = MakeActors(bench.options.seed);
  std::vector<double> errors;
  for (int second = 0; second < seconds && !bench.progress.IsStopAsked(); ++second) {
    World twin(*world, converged);
    for (int tick = 0; tick < kActHz; ++tick) {
      Act(actors, *world);
      for (const Body& body : world->Bodies()) twin.SetControl(body.id, body.control, kPlayLimits);
      (void)world->Step();
      for (int i = 0; i < kTwinTicks; ++i) (void)twin.Step();
    }
    if (second < 2) continue;  // bodies first fall from their initial positions
    for (std::size_t i = 0; i < kFixedPlayers; ++i) {
      const double square = FindMeanSquare(ReadPositions(world->Bodies()[i]), ReadPositions(twin.Bodies()[i]));
      errors.push_back(kRadiusPercent * std::sqrt(square));
    }
    bench.progress.Show(static_cast<std::size_t>(second), static_cast<std::size_t>(seconds));
  }
  return errors;
}

// RMS error of the curve alone, % of the radius.
double MeasureCurve(Bench& bench, int seconds) {
  constexpr double kTick = 1.0 / kTruthHz;
  constexpr double kBehind = 2.5 / kSnapshotHz;
  const auto world = MakeWorld(kTruthHz);
  std::vector<Actor> actors = MakeActors(bench.options.seed);
  Truth truth(kTick);
  const auto size = static_cast<float>(world->Blueprints().front().size);
  std::vector<client::Track> tracks(kFixedPlayers, client::Track(size));
  std::vector<server::CapturedBody> captured(kFixedPlayers);
  std::vector<protocol::Vector3> shown;
  std::vector<Vector3d> positions;
  double sum = 0;
  std::size_t count = 0;
  Random phase(bench.options.seed);
  for (int tick = 0; tick < seconds * kTruthHz && !bench.progress.IsStopAsked(); ++tick) {
    if (tick % (kTruthHz / kActHz) == 0) Act(actors, *world);
    (void)world->Step();
    truth.Add(*world);
    if (world->Tick() % (kTruthHz / kSnapshotHz) != 0) continue;
    const double now = world->Tick() * kTick;
    const double moment = now - kBehind + phase.Draw(0, 1.0 / kSnapshotHz);
    for (std::size_t i = 0; i < kFixedPlayers; ++i) {
      server::CaptureBody(*world, world->Bodies()[i], captured[i]);
      const protocol::Pose& pose = captured[i].pose;
      std::vector<protocol::Vector3> shape;
      for (const protocol::Vector3& vertex : captured[i].vertices) {
        shape.push_back(protocol::Rotate(protocol::Conjugate(pose.rotation), vertex - pose.centroid));
      }
      tracks[i].Insert(now, false, pose, shape, now - 2 * kBehind);
      if (now < 2 || !truth.Find(moment, i, positions)) continue;
      const client::Moment curve = tracks[i].FindMoment(moment);
      shown.clear();
      client::AppendVertices(curve, client::BlendPose(curve), shown);
      std::vector<Vector3d> places;
      for (const protocol::Vector3& v : shown) places.emplace_back(v.x, v.y, v.z);
      sum += FindMeanSquare(places, positions);
      ++count;
    }
  }
  return kRadiusPercent * std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

void MeasureBudget(Bench& bench) {
  const int seconds = bench.options.quick ? 7 : 62;
  const std::vector<double> physics = MeasurePhysics(bench, seconds);
  const double curve = MeasureCurve(bench, seconds);
  const Showing showing = PlayShowing(kSnapshotHz, {{ListLinks().front()}}, bench.options.seed, seconds);
  if (bench.progress.IsStopAsked()) return;
  double squares = 0;
  for (const double error : physics) squares += error * error;
  const double physicsRms = std::sqrt(squares / static_cast<double>(physics.size()));
  bench.results.rows.push_back({{"experiment", "budget"},
                                {"physics_median", FindMedian(physics)},
                                {"physics_rms", physicsRms},
                                {"codec", showing.codecError},
                                {"interpolation", curve},
                                {"displayed", showing.watchers.front().error}});
  bench.results.AddFigure("budget_physics", FindMedian(physics));
  bench.results.AddFigure("budget_physics_rms", physicsRms);
  bench.results.AddFigure("budget_codec", showing.codecError);
  bench.results.AddFigure("budget_interpolation", curve);
  bench.results.AddFigure("budget_displayed", showing.watchers.front().error);
}

}  // namespace wobble::bench
