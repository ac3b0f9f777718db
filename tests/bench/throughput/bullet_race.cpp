// The same balls in Bullet, on the ground and pressed together, whole ticks on both sides.
//
// Both engines begin with the same balls in the same places and are timed over the same ticks from there, by turns and
// equally often: of each tick the fastest counts, and of these the mean. Bullet's balls fall by themselves: put where
// ours lie, with its margin of 0.25 m about them, they would burst apart. Its settings are its own defaults; it takes
// one step a tick and moves vertices along links that it makes fit in one round; how exact that is nobody asks here.
// Ours take four substeps, which is more than most balls need apart: what they take by the default error target has a
// row too. Pressed balls take as many more as stability asks for, which is said beside the figure.
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

// After as many ticks as ours have had when theirs are timed.
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

// Bullet's soft bodies know nothing of one another unless they are told to, and here they are not; ours always look.
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
  bench.results.AddFigureAtLeast("speedup_vs_bullet", times[2].FindMean() / times[0].FindMean(), 5,
                                 !bench.options.quick);
  bench.results.remarks.push_back(
      FormatLine("speedup_vs_bullet: of %zu balls apart, %.2f ms a tick in %.2f substeps, "
                 "Bullet %.2f ms, %.2f where its balls could touch; by the error target %.2f ms in %.2f",
                 kApart, times[0].FindMean() * 1e3, CountPlayed(*fixed, fixed->Settings(), kTimedTicks).substeps,
                 times[2].FindMean() * 1e3, times[3].FindMean() * 1e3, times[1].FindMean() * 1e3,
                 CountPlayed(*chosen, chosen->Settings(), kTimedTicks).substeps));
}

// What contact costs is the whole tick less that of the same balls in the same shapes and motions, but apart and in the
// air: the search, contacts with the ground and with one another, and stepping stage by stage what touches.
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
  results.AddFigureAtMost("touching_ms_per_tick", contact * 1e3 * static_cast<double>(kPressed / bodies), 6,
                          !bench.options.quick);
  results.AddFigureAtLeast("speedup_vs_bullet_touching", times[2].FindMean() / times[0].FindMean(), 10,
                           !bench.options.quick);
  results.remarks.push_back(FormatLine(
      "touching: %zu pressed balls%s, %.2f ms a tick in %.2f substeps, %.2f of it contact; Bullet %.1f ms, %.1f with "
      "clusters, %.1f with a margin of 0.02 m",
      bodies, bench.options.quick ? " (touching_ms_per_tick: times eight)" : "", times[0].FindMean() * 1e3,
      CountPlayed(*pressed, pressed->Settings(), kTimedTicks).substeps, contact * 1e3, times[2].FindMean() * 1e3,
      times[3].FindMean() * 1e3, times[4].FindMean() * 1e3));
}

}  // namespace wobble::bench
