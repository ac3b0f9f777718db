// The cost of a server without players whose world is paused: it only listens. The scene is the one with the most
// bodies. The server is told to pause soon, and measurement starts after that; its summary must confirm that the world
// was paused the whole time, otherwise the run is invalid.
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
constexpr double kBegin = 2;                // s, by when the world is built and paused

void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

// Paused time from the summary, s; 0 without a summary.
double ReadPausedTime(const std::filesystem::path& summary) {
  std::ifstream file(summary);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  return json.is_object() ? json.value("paused_s", 0.0) : 0;
}

struct Observation {
  double time = 0;  // wall time, s
  double work = 0;  // processor time of all threads, s
};

Observation WatchServer(const std::filesystem::path& summary, double seconds) {
  // A port of the ephemeral range, seldom in use; a server that finds it taken ends at once.
  const int port = 40000 + getpid() % 10000;
  // Untrained: training takes longer than kBegin on a slow machine, and a server without players sends no basis.
  const Running server({FindProgram("wobbled"), "--scene", "crowd", "--untrained", "--port", std::to_string(port),
                        "--pause-after", kPauseAfter, "--log-level", "off", "--summary", summary});
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
