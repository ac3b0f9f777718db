// What it costs to record a crowd, and how soon one is anywhere in it: 64 players who run into one another on `pitch`,
// each with a new wish every few ticks. Of each tick the time that recording adds to it is taken by itself, so that the
// tick's own noise is not in it; the writing thread's is the rest of the process.
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "server/recording/film.h"
#include "server/recording/recorder.h"
#include "server/scenes/loader.h"
#include "tests/bench/random.h"
#include "tests/bench/skip/experiments.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr server::ClientId kPlayers = 64;
constexpr std::uint32_t kRecordedHz = 60;

// Nearest rank.
double FindPercentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

// Every player wants to go elsewhere three times a second, and jumps now and then.
void MovePlayers(Random& random, server::Playground& ground) {
  for (server::ClientId client = 1; client <= kPlayers; ++client) {
    if (!random.Happens(0.05)) continue;
    server::MoveEntry move{.client = client, .control = {}, .hand = {}};
    const double angle = random.Draw(-M_PI, M_PI);
    move.control.moveX = std::cos(angle);
    move.control.moveY = std::sin(angle);
    move.control.jump = random.Happens(0.05);
    ground.Take(move);
  }
}

struct Costs {
  std::vector<double> added;  // by tick, s of the thread that plays
  double writing = 0;         // s of the writing thread
  double played = 0;          // s of the world
  std::uint64_t bytes = 0;
};

Costs RecordCrowd(Bench& bench, const std::filesystem::path& folder, std::uint32_t ticks) {
  const scenes::LoadResult loaded = scenes::LoadScene(kCapacityScene, scenes::FindShippedScenes());
  server::Playground ground(loaded.scene, {});
  recording::Recorder recorder({.folder = folder, .readUnixTime = [] { return std::uint64_t{0}; }},
                               {.version = "lab", .scene = loaded.source}, ground);
  Costs costs;
  double noting = 0;
  ground.SetListener([&](const server::Entry& entry) {
    const double begin = ReadThreadTime();
    recorder.Note(entry, ground.World().Tick());
    noting += ReadThreadTime() - begin;
  });
  for (server::ClientId client = 1; client <= kPlayers; ++client) ground.Take(server::JoinEntry{client, false, "bot"});
  Random random(bench.options.seed);
  const double others = ReadClock(CLOCK_PROCESS_CPUTIME_ID) - ReadThreadTime();
  for (std::uint32_t tick = 0; tick < ticks && !bench.progress.IsStopAsked(); ++tick) {
    noting = 0;
    MovePlayers(random, ground);
    ground.Step();
    const double begin = ReadThreadTime();
    recorder.FollowTick(ground);
    costs.added.push_back(noting + ReadThreadTime() - begin);
    bench.progress.Show(tick + 1, ticks);
  }
  recorder.Close();
  costs.writing = ReadClock(CLOCK_PROCESS_CPUTIME_ID) - ReadThreadTime() - others;
  costs.played = double{1} * ground.World().Tick() / kRecordedHz;
  costs.bytes = recorder.Counts().bytes;
  return costs;
}

// s of wall time, for jumps to anywhere in the recording once its index is made.
std::vector<double> MeasureSeeks(Bench& bench, const std::filesystem::path& file) {
  recording::Recording recording;
  std::string error = recording.Open(file);
  const auto ground = recording::MakeGround(recording.ReadHead(), {}, error);
  recording::Film film(file, std::move(recording));
  std::vector<double> seeks;
  if (ground == nullptr || !film.Begin(*ground).empty()) return seeks;
  while (film.Index().MadeUpTo() < film.ReadRecording().LastTick() && !bench.progress.IsStopAsked()) usleep(10'000);
  Random random(bench.options.seed);
  const int count = bench.options.quick ? 20 : 200;
  for (int i = 0; i < count && !bench.progress.IsStopAsked(); ++i) {
    const double time = random.Draw(0, film.End());
    const double begin = ReadWallTime();
    film.JumpTo(time);
    seeks.push_back(ReadWallTime() - begin);
  }
  return seeks;
}

}  // namespace

void MeasureRecording(Bench& bench) {
  const auto folder = std::filesystem::temp_directory_path() / ("wobble-lab-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const std::uint32_t ticks = (bench.options.quick ? 5 : 130) * kRecordedHz;
  const Costs costs = RecordCrowd(bench, folder, ticks);
  const std::vector<double> seeks = MeasureSeeks(bench, std::filesystem::directory_iterator(folder)->path());
  std::filesystem::remove_all(folder);
  if (costs.added.size() < ticks || seeks.empty()) return;
  double added = 0;
  for (const double each : costs.added) added += each;
  const double share = (added + costs.writing) / costs.played;
  const double worst = FindPercentile(costs.added, 0.99) * 1e3;
  const double megabytes = static_cast<double>(costs.bytes) / costs.played * 3600 / 1e6;
  const double seek = FindPercentile(seeks, 0.99) * 1e3;
  bench.results.rows.push_back({{"experiment", "recording"},
                                {"players", kPlayers},
                                {"seconds", costs.played},
                                {"tick_us_p50", FindPercentile(costs.added, 0.5) * 1e6},
                                {"tick_us_p99", worst * 1e3},
                                {"tick_us_most", FindPercentile(costs.added, 1) * 1e6},
                                {"playing_thread_share", added / costs.played},
                                {"writing_thread_share", costs.writing / costs.played},
                                {"mb_per_hour", megabytes},
                                {"seek_ms_p50", FindPercentile(seeks, 0.5) * 1e3},
                                {"seek_ms_p99", seek}});
  const bool isHeld = !bench.options.quick;
  bench.results.AddFigureAtMost("recording_core_share", share, 0.01, isHeld);
  bench.results.AddFigureAtMost("recording_tick_ms_p99", worst, 0.1, isHeld);
  bench.results.AddFigureAtMost("recording_mb_per_hour", megabytes, 100, isHeld);
  bench.results.AddFigureAtMost("seek_ms_p99", seek, 500, isHeld);
}

}  // namespace wobble::bench
