// The same balls in Bullet, on the ground and pressed together; whole ticks on both sides.
//
// Both engines begin with the same balls in the same places and are timed over the same ticks from there, in turns and
// equally often: the fastest time of each tick counts, and the figure is their mean. Bullet's balls fall by themselves:
// placed where ours lie, its margin of 0.25 m would make them burst apart. It runs with its default settings, one step
// per tick, and moves vertices along links in one iteration; its accuracy is not measured here. Ours take four
// substeps, more than most balls need when apart: the number chosen by the default error target has its own row.
// Pressed balls take as many more as stability requires, which is stated beside the figure.
#include "tests/bench/throughput/bullet.h"
#include "tests/bench/throughput/experiments.h"
#include "tests/bench/throughput/worlds.h"

namespace wobble::bench {
namespace {

using namespace physics;
using Contacts = BulletSettings::Contacts;

constexpr std::size_t kApart = 64;
constexpr std::size_t kPressed = 128;
constexpr std::size_t kPressedQuick = 16;

// Times Bullet after as many ticks as the engine had played.
Replay MakeBulletReplay(const World& beginning, const BulletSettings& settings, int lead) {
  Replay replay;
  replay.lead = lead + Replay{}.lead;
  replay.ticks = kTimedTicks;
  replay.begin = [&beginning, settings] {
    return [world = std::make_shared<BulletWorld>(beginning, settings)] { world->Step(); };
  };
  return replay;
}

void AddRaceRow(Bench& bench, const std::string& experiment, const std::string& engine, std::size_t bodies,
                const TickTimes& times, const Peak& peak) {
  bench.results.rows.push_back({{"experiment", experiment},
                                {"engine", engine},
                                {"bodies", bodies},
                                {"ms_per_tick", times.FindMean() * 1e3},
                                {"least_ms_per_tick", times.FindLeast() * 1e3},
                                {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
}

}  // namespace

// Bullet's soft bodies ignore each other unless configured otherwise, as here; the engine always searches for contact.
void MeasureBulletApart(Bench& bench) {
  const auto fixed = MakeBallsApart(kApart, FixSubsteps(kTimedSubsteps));
  const auto chosen = MakeBallsApart(kApart, WorldSettings{});
  const auto beginning = MakeBallsApart(kApart, WorldSettings{}, 0);
  const Replay replays[] = {MakeReplay(*fixed, fixed->Settings(), kTimedTicks),
                            MakeReplay(*chosen, chosen->Settings(), kTimedTicks),
                            MakeBulletReplay(*beginning, {}, kTicksToFall),
                            MakeBulletReplay(*beginning, {.contacts = Contacts::kVertexFace}, kTicksToFall)};
  Peak peak;
  const auto times = TimeReplays(bench, replays, bench.options.quick ? 2 : 20, peak);
  AddRaceRow(bench, "bullet_apart", "wobble, 4 substeps", kApart, times[0], peak);
  AddRaceRow(bench, "bullet_apart", "wobble, 1 mm/s", kApart, times[1], peak);
  AddRaceRow(bench, "bullet_apart", "bullet", kApart, times[2], peak);
  AddRaceRow(bench, "bullet_apart", "bullet, ready to touch", kApart, times[3], peak);
  bench.results.AddFigureAtLeast("speedup_vs_bullet", times[2].FindMean() / times[0].FindMean(), 3.5,
                                 !bench.options.quick);
  bench.results.remarks.push_back(
      FormatLine("speedup_vs_bullet: of %zu balls apart, %.2f ms a tick in %.2f substeps, "
                 "Bullet %.2f ms, %.2f where its balls could touch; by the error target %.2f ms in %.2f",
                 kApart, times[0].FindMean() * 1e3, CountPlayed(*fixed, fixed->Settings(), kTimedTicks).substeps,
                 times[2].FindMean() * 1e3, times[3].FindMean() * 1e3, times[1].FindMean() * 1e3,
                 CountPlayed(*chosen, chosen->Settings(), kTimedTicks).substeps));
}

// The cost of contact is the whole tick minus that of the same balls with the same shapes and velocities, but apart and
// in the air. It comprises the search, contacts with the ground and between bodies, and stepping islands stage by
// stage.
void MeasureBulletTouching(Bench& bench) {
  const std::size_t bodies = bench.options.quick ? kPressedQuick : kPressed;
  const auto pressed = MakeBallsInFunnel(bodies, FixSubsteps(kTimedSubsteps));
  const auto freed = MakeBallsFreed(*pressed, pressed->Settings());
  const auto beginning = MakeBallsInFunnel(bodies, WorldSettings{}, 0);
  const std::string names[] = {"wobble", "wobble, apart in the air", "bullet, vertex-face", "bullet, clusters",
                               "bullet, vertex-face, margin 0.02 m"};
  const Replay replays[] = {
      MakeReplay(*pressed, pressed->Settings(), kTimedTicks), MakeReplay(*freed, freed->Settings(), kTimedTicks),
      MakeBulletReplay(*beginning, {.contacts = Contacts::kVertexFace}, kTicksToPress),
      MakeBulletReplay(*beginning, {.contacts = Contacts::kClusters}, kTicksToPress),
      MakeBulletReplay(*beginning, {.contacts = Contacts::kVertexFace, .margin = 0.02}, kTicksToPress)};
  Peak peak;
  const auto times = TimeReplays(bench, replays, bench.options.quick ? 2 : 3, peak);
  for (std::size_t i = 0; i < times.size(); ++i) AddRaceRow(bench, "bullet_touching", names[i], bodies, times[i], peak);
  const double contact = times[0].FindMean() - times[1].FindMean();
  Results& results = bench.results;
  results.AddFigureAtMost("touching_ms_per_tick", contact * 1e3 * static_cast<double>(kPressed / bodies), 3,
                          !bench.options.quick);
  results.AddFigureAtLeast("speedup_vs_bullet_touching", times[2].FindMean() / times[0].FindMean(), 15,
                           !bench.options.quick);
  results.remarks.push_back(FormatLine(
      "touching: %zu pressed balls%s, %.2f ms a tick in %.2f substeps, %.2f of it contact; Bullet %.1f ms, %.1f with "
      "clusters, %.1f with a margin of 0.02 m",
      bodies, bench.options.quick ? " (touching_ms_per_tick: times eight)" : "", times[0].FindMean() * 1e3,
      CountPlayed(*pressed, pressed->Settings(), kTimedTicks).substeps, contact * 1e3, times[2].FindMean() * 1e3,
      times[3].FindMean() * 1e3, times[4].FindMean() * 1e3));
}

}  // namespace wobble::bench
