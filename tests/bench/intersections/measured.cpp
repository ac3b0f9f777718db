// How often skins intersect in play, counted exactly at the end of every sixth tick: over all shipped scenes, and over
// the first of the random trials of `wobble_lab stability`.
//
// Scenes are played by their own drives, without players; where a scene has no bodies of its own, eight players chase
// one another. Skins push from a gap on, so what lies at rest intersects nothing; a hit may use the gap up.
//
// A rate is pairs of triangles over vertex-ticks: a pair is counted anew at every look, and so is a vertex. Pairs
// between fine bodies (kFineVertices) go over the vertices of fine bodies, all others over the vertices of all bodies
// with faces. Depths, once a second, are those of the random trials: winding numbers, independent of both the engine
// and the count of pairs.
#include <algorithm>
#include <cmath>
#include <memory>

#include "server/scenes/loader.h"
#include "tests/bench/contact/insides.h"
#include "tests/bench/intersections/experiments.h"
#include "tests/bench/intersections/skins.h"
#include "tests/bench/stability/random_world.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

constexpr double kMostBetweenOthers = 1e-6;  // pairs a vertex-tick
constexpr int kTicksBetweenCounts = 6;
constexpr int kTicksBetweenDepths = 60;
constexpr int kSceneHz = 60;
constexpr std::uint32_t kChasers = 8;

// What was seen over a whole run.
struct Sightings {
  std::size_t looks = 0;
  std::size_t looksWith = 0;  // with a pair of any kind
  double betweenFine = 0;
  double betweenOthers = 0;
  double within = 0;
  double vertexTicks = 0;
  double fineVertexTicks = 0;
  double deepest = 0;  // over the body's size
  double exact = 0;    // signs that doubles could not tell
  double asked = 0;

  void Add(const Intersections& found) {
    ++looks;
    looksWith += found.betweenFine + found.betweenOthers + found.within > 0 ? 1 : 0;
    betweenFine += static_cast<double>(found.betweenFine);
    betweenOthers += static_cast<double>(found.betweenOthers);
    within += static_cast<double>(found.within);
    vertexTicks += static_cast<double>(found.vertices);
    fineVertexTicks += static_cast<double>(found.fineVertices);
    exact += static_cast<double>(found.signs.exact);
    asked += static_cast<double>(found.signs.asked);
  }
  void Add(const Sightings& other) {
    looks += other.looks;
    looksWith += other.looksWith;
    betweenFine += other.betweenFine;
    betweenOthers += other.betweenOthers;
    within += other.within;
    vertexTicks += other.vertexTicks;
    fineVertexTicks += other.fineVertexTicks;
    deepest = std::max(deepest, other.deepest);
    exact += other.exact;
    asked += other.asked;
  }
};

double FindRate(double pairs, double vertexTicks) { return vertexTicks > 0 ? pairs / vertexTicks : 0; }

// After a tick; a world that has not moved since the last look is not looked at anew, but what was seen counts again.
class Watch {
 public:
  void Look(const physics::World& world, const physics::StepReport& report) {
    m_moved = m_moved || report.awake > 0;
    const auto tick = static_cast<int>(world.Tick());
    if (tick % kTicksBetweenDepths == 0 && (m_moved || report.awake > 0)) {
      for (const float depth : ListDepths(world)) seen.deepest = std::max(seen.deepest, static_cast<double>(depth));
    }
    if (tick % kTicksBetweenCounts != 0) return;
    if (m_moved) m_last = CountIntersections(world);
    m_moved = false;
    seen.Add(m_last);
  }

  Sightings seen;

 private:
  bool m_moved = true;
  Intersections m_last;
};

struct WatchedScene {
  std::string name;
  bool isPlayed = false;
  std::size_t bodies = 0;
  Sightings seen{};
};

// Everybody runs at the next one.
void ChaseNext(physics::World& world, const physics::ControlLimits& limits) {
  const std::span<const physics::Body> bodies = world.Bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const physics::Vector3d way = world.FindCentre(bodies[(i + 1) % bodies.size()]) - world.FindCentre(bodies[i]);
    const double length = std::max(1e-3, std::hypot(way.x(), way.y()));
    world.SetControl(bodies[i].id, {.moveX = 0.99 * way.x() / length, .moveY = 0.99 * way.y() / length}, limits);
  }
}

void PlayWatched(std::uint64_t seed, int seconds, WatchedScene& watched) {
  const scenes::LoadResult loaded = scenes::LoadScene(watched.name, scenes::FindShippedScenes());
  if (!loaded.errors.empty()) return;
  const scenes::Scene& scene = loaded.scene;
  physics::World world(scenes::MakeWorldSettings(scene, 1.0 / kSceneHz, 1));
  (void)scenes::FillWorld(scene, seed, world);
  const bool hasChasers = world.Bodies().empty();
  for (std::uint32_t i = 0; hasChasers && i < kChasers; ++i) {
    world.AddBody(static_cast<std::uint8_t>(scene.player.blueprint), scenes::FindFreeSpawn(scene.player, i, world));
  }
  watched.bodies = world.Bodies().size();
  Watch watch;
  for (int tick = 0; tick < seconds * kSceneHz; ++tick) {
    if (hasChasers && tick % kSceneHz == 0) ChaseNext(world, scene.player.limits);
    const physics::StepReport report = world.Step();
    watch.Look(world, report);
  }
  watched.seen = watch.seen;
  watched.isPlayed = true;
}

Sightings PlayWatchedTrial(std::uint64_t seed, std::uint32_t number, int ticks) {
  RandomWorld random(seed, number);
  Watch watch;
  for (int tick = 0; tick < ticks; ++tick) {
    random.Act();
    const physics::StepReport report = random.Engine().Step();
    watch.Look(random.Engine(), report);
  }
  return watch.seen;
}

nlohmann::ordered_json MakeSightingsRow(const char* experiment, const std::string& name, const Sightings& seen) {
  return {{"experiment", experiment},
          {"of", name},
          {"looks", seen.looks},
          {"looks_with", seen.looksWith},
          {"vertex_ticks", seen.vertexTicks},
          {"fine_vertex_ticks", seen.fineVertexTicks},
          {"pairs_fine", seen.betweenFine},
          {"pairs_others", seen.betweenOthers},
          {"pairs_within", seen.within},
          {"depth", seen.deepest},
          {"exact_share", FindRate(seen.exact, seen.asked)}};
}

// Quick runs have no limits: they see some of the same faults in fewer vertices.
void AddSightings(const std::string& prefix, const Sightings& seen, bool quick, Results& results) {
  const double fine = FindRate(seen.betweenFine, seen.fineVertexTicks);
  const double others = FindRate(seen.betweenOthers, seen.vertexTicks);
  results.AddFigureAtMost(prefix + "intersecting_fine", fine, 0, !quick);
  results.AddFigureAtMost(prefix + "intersecting_others", others, kMostBetweenOthers, !quick);
  results.AddFigure(prefix + "intersecting_within", FindRate(seen.within, seen.vertexTicks));
  results.AddFigure(prefix + "intersecting_depth", seen.deepest);
}

}  // namespace

void MeasureIntersections(Bench& bench) {
  const bool quick = bench.options.quick;
  const int seconds = quick ? 1 : 10;
  std::vector<WatchedScene> watched;
  for (const scenes::SceneSummary& each : scenes::ListScenes(scenes::FindShippedScenes())) {
    watched.push_back({.name = each.name});
  }
  std::vector<Sightings> trials(quick ? 100 : 1000);
  const bool done = RunTrials(bench, watched.size() + trials.size(), [&](std::size_t i) {
    if (i < watched.size()) return PlayWatched(bench.options.seed, seconds, watched[i]);
    const auto number = static_cast<std::uint32_t>(i - watched.size());
    trials[number] = PlayWatchedTrial(bench.options.seed, number, quick ? 2 * kSceneHz : kRandomTicks);
  });
  if (!done) return;
  Sightings ofScenes;
  for (const WatchedScene& scene : watched) {
    if (!scene.isPlayed) return bench.results.AddFigureAtMost("scene_intersecting_fine", NAN, 0);
    nlohmann::ordered_json row = MakeSightingsRow("intersections_in_scene", scene.name, scene.seen);
    row["bodies"] = scene.bodies;
    bench.results.rows.push_back(std::move(row));
    ofScenes.Add(scene.seen);
  }
  Sightings ofTrials;
  for (const Sightings& trial : trials) ofTrials.Add(trial);
  nlohmann::ordered_json all = MakeSightingsRow("intersections_in_trials", "all", ofTrials);
  const auto countWith = [&](double Sightings::*pairs) {
    return std::count_if(trials.begin(), trials.end(), [pairs](const Sightings& trial) { return trial.*pairs > 0; });
  };
  all["trials"] = trials.size();
  all["trials_with_fine"] = countWith(&Sightings::betweenFine);
  all["trials_with_others"] = countWith(&Sightings::betweenOthers);
  all["trials_with_within"] = countWith(&Sightings::within);
  bench.results.rows.push_back(std::move(all));
  for (const auto pairs : {&Sightings::betweenFine, &Sightings::betweenOthers, &Sightings::within}) {
    const auto worst = std::max_element(
        trials.begin(), trials.end(), [pairs](const Sightings& a, const Sightings& b) { return a.*pairs < b.*pairs; });
    const std::string number = std::to_string(worst - trials.begin());
    bench.results.rows.push_back(MakeSightingsRow("intersections_in_trials", "trial " + number, *worst));
  }
  AddSightings("scene_", ofScenes, quick, bench.results);
  AddSightings("trial_", ofTrials, quick, bench.results);
}

}  // namespace wobble::bench
