// How long bodies stay awake though they look as if they rested. The shipped scenes play by themselves; a body looks at
// rest from the moment on after which its centre never moves faster than 1 cm/s again. Bodies that touch must stay
// awake together, so an island looks at rest when the last of its bodies does.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/scenes/loader.h"
#include "tests/bench/skip/experiments.h"

namespace wobble::bench {
namespace {

constexpr double kTick = 1.0 / 60;
constexpr int kMostTicks = 120 * 60;
constexpr double kStill = 0.01;  // m/s

struct Settling {
  double stillAt = 0;   // s, of the last centre
  double asleepAt = 0;  // s, of the last body; infinite when one is still awake after two minutes
  double settle = 0;    // s, the longest of an island
};

// The latest of `ticks` over the bodies that are connected with `id` by touch.
int FindLatestTouching(const physics::World& world, physics::BodyId id, const std::vector<int>& ticks) {
  std::vector<physics::BodyId> island{id}, touching;
  int latest = 0;
  for (std::size_t i = 0; i < island.size(); ++i) {
    latest = std::max(latest, ticks[island[i]]);
    world.ListTouching(island[i], touching);
    for (const physics::BodyId each : touching) {
      if (std::find(island.begin(), island.end(), each) == island.end()) island.push_back(each);
    }
  }
  return latest;
}

Settling PlayUntilAsleep(const scenes::Scene& scene, std::uint64_t seed, Bench& bench) {
  physics::World world(scenes::MakeWorldSettings(scene, kTick, 1));
  (void)scenes::FillWorld(scene, seed, world);
  const std::size_t ids = world.Bodies().size() + 1;  // ids count from 1
  std::vector<physics::Vector3d> before(ids);
  std::vector<int> lastMoving(ids, 0), asleepSince(ids, 0);
  for (const physics::Body& body : world.Bodies()) before[body.id] = world.FindCentre(body);
  bool isAwake = true;
  for (int tick = 1; tick <= kMostTicks && isAwake && !bench.progress.IsStopAsked(); ++tick) {
    isAwake = world.Step().awake > 0;
    for (const physics::Body& body : world.Bodies()) {
      const physics::Vector3d centre = world.FindCentre(body);
      if ((centre - before[body.id]).norm() > kStill * kTick) lastMoving[body.id] = tick;
      before[body.id] = centre;
      if (!body.asleep) asleepSince[body.id] = tick + 1;
    }
  }
  Settling settling;
  if (isAwake) settling.asleepAt = settling.settle = std::numeric_limits<double>::infinity();
  for (const physics::Body& body : world.Bodies()) {
    const int still = FindLatestTouching(world, body.id, lastMoving);
    settling.stillAt = std::max(settling.stillAt, still * kTick);
    settling.asleepAt = std::max(settling.asleepAt, asleepSince[body.id] * kTick);
    settling.settle = std::max(settling.settle, (asleepSince[body.id] - still) * kTick);
  }
  return settling;
}

}  // namespace

void MeasureSettling(Bench& bench) {
  const std::vector<std::string> names{"ball_drop", "arena", "scrum", "jelly_stack", "mesh_zoo"};
  double worst = 0;
  for (std::size_t i = 0; i < names.size() && !bench.progress.IsStopAsked(); ++i) {
    const scenes::LoadResult loaded = scenes::LoadScene(names[i], scenes::FindShippedScenes());
    const Settling settling = loaded.errors.empty() ? PlayUntilAsleep(loaded.scene, bench.options.seed, bench)
                                                    : Settling{.settle = std::numeric_limits<double>::quiet_NaN()};
    bench.results.rows.push_back({{"experiment", "settle"},
                                  {"scene", names[i]},
                                  {"still_s", settling.stillAt},
                                  {"asleep_s", settling.asleepAt},
                                  {"settle_s", settling.settle}});
    bench.results.AddFigure("asleep_s_" + names[i], settling.asleepAt);
    worst = std::isnan(settling.settle) ? settling.settle : std::max(worst, settling.settle);
    bench.progress.Show(i + 1, names.size());
  }
  bench.results.AddFigureAtMost("settle_s", worst, 3);
}

}  // namespace wobble::bench
