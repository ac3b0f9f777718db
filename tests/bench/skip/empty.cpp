// A server that nobody has joined, once its world waits for players: it only listens. The scene is the one with the
// most bodies. It is told to wait soon, and not until later does it count; that the world has stood still all the while
// is what its own summary says, and a run of which it does not is no measurement.
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/bench/skip/experiments.h"
#include "tests/bench/skip/programs.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr const char* kPauseAfter = "0.1";  // s
constexpr double kBegin = 2;                // s, by when the world has been made and waits

void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

// That the world stood still, s; 0 when there is no summary.
double ReadPausedTime(const std::filesystem::path& summary) {
  std::ifstream file(summary);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  return json.is_object() ? json.value("paused_s", 0.0) : 0;
}

struct Observation {
  double time = 0;  // of the wall, s
  double work = 0;  // of all threads in it, s
};

Observation WatchServer(const std::filesystem::path& summary, double seconds) {
  // One that the system has for short-lived clients, so seldom anybody's; a server that finds it taken ends at once.
  const int port = 40000 + getpid() % 10000;
  const Running server({FindProgram("wobbled"), "--scene", "crowd", "--port", std::to_string(port), "--pause-after",
                        kPauseAfter, "--log-level", "off", "--summary", summary});
  Sleep(kBegin);
  const double began = ReadWallTime();
  const double before = server.ReadProcessTime();
  Sleep(seconds);
  const double work = server.ReadProcessTime() - before;
  return {ReadWallTime() - began, work};
}

}  // namespace

void MeasureEmpty(Bench& bench) {
  const std::filesystem::path summary =
      std::filesystem::temp_directory_path() / ("wobble_lab_empty_" + std::to_string(getpid()) + ".json");
  const Observation watched = WatchServer(summary, bench.options.quick ? 2 : 20);
  const double paused = ReadPausedTime(summary);
  std::error_code code;
  std::filesystem::remove(summary, code);
  const bool hasWaited = paused >= watched.time;
  const double share = hasWaited ? watched.work / watched.time : std::numeric_limits<double>::quiet_NaN();
  bench.results.rows.push_back(
      {{"experiment", "empty"}, {"scene", "crowd"}, {"paused_s", paused}, {"watched_s", watched.time}, {"cpu", share}});
  bench.results.AddFigureAtMost("empty_cpu", share, 0.005);
}

}  // namespace wobble::bench
