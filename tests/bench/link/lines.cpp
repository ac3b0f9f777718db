// A player of each kind for a minute over each line; the server and the gateway at its other end. Both take frames 60
// times a second and begin to count after 3 s of play. A gap is 200 ms without a newer snapshot.
//
// The limits are those that the page must keep; UDP is shown beside it. Delays are a percentile over frames; the line's
// draws are seeded, TCP's timing is not.
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "tests/bench/link/experiments.h"

namespace wobble::bench {

#ifdef WOBBLE_EMULATOR

namespace {

struct Line {
  const char* name;
  const char* shows;
  const char* conditions;  // one way
  bool downloads;
  double p50, p99;  // limits of the page's display delay, ms
};
constexpr std::array kLines{
    Line{"clean", "40 ms", "delay=20ms", false, 90, 130},
    Line{"loss2", "2 % lost, 60 ms", "delay=30ms,loss=2%", false, 90, 130},
    Line{"loss5", "5 % lost, 100 ms", "delay=50ms,loss=5%", false, 125, 180},
    Line{"blackouts", "black-outs, 40 ms", "delay=20ms,blackout=250ms/10s", false, 150, 260},
    Line{"shared", "1.5 Mbit/s, shared", "delay=20ms,rate=1.5mbit", true, 180, 330},
};

constexpr double kStart = 2;  // s for the server and the gateway
const std::string kServer = "XDG_STATE_HOME=" WOBBLE_BASES_DIR " " WOBBLE_BIN_DIR
                            "/wobbled --scene arena --log-level error --admit-when-busy --cache " WOBBLE_BASES_DIR;
constexpr int kNotPermitted = 77;

struct Run {
  int code = 0;
  nlohmann::json seen;
};

Run Emulate(const Line& line, const std::string& client, double seconds, std::uint64_t seed) {
  const std::string bin = WOBBLE_BIN_DIR;
  const std::string summary = std::filesystem::temp_directory_path() / ("wobble_link_" + std::to_string(getpid()));
  // The second wait lets the server write its summary.
  const std::string server = "trap : TERM; " + kServer + " --port 4000 --summary " + summary + " & " + bin +
                             "/wobble gateway --http 8080 --server 127.0.0.1:4000 & wait; wait";
  std::string call = std::string(WOBBLE_EMULATOR) + " '" + line.conditions + "' --seed " + std::to_string(seed) +
                     " --limit " + std::to_string(static_cast<int>(seconds) + 30) +
                     (line.downloads ? " --download" : "") + " --server '" + server + "' --client 'sleep " +
                     std::to_string(kStart) + "; " + client + "' 2>/dev/null";
  Run run;
  FILE* pipe = popen(call.c_str(), "r");
  if (pipe == nullptr) return {.code = -1, .seen = {}};
  std::string text;
  std::array<char, 4096> block;
  while (std::fgets(block.data(), block.size(), pipe) != nullptr) text += block.data();
  const int status = pclose(pipe);
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  run.seen = nlohmann::json::parse(text, nullptr, false);
  if (!run.seen.is_object()) run.seen = nlohmann::json::object();
  std::ifstream file(summary);
  const auto told = nlohmann::json::parse(file, nullptr, false);
  if (told.is_object()) run.seen["inputs_starved_percent"] = 100 * told.value("inputs_starved_share", 0.0);
  std::filesystem::remove(summary);
  return run;
}

double Find(const nlohmann::json& seen, const char* key) {
  const auto found = seen.find(key);
  return found != seen.end() && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

// No input comes through while the line is black.
bool IsInterrupted(const Line& line) { return std::string_view(line.name) == "blackouts"; }

void AddRow(Bench& bench, const Line& line, const char* kind, const nlohmann::json& seen) {
  const std::string key = std::string(line.name) + "_" + kind;
  Results& results = bench.results;
  const bool isPage = std::string_view(kind) == "page";
  const bool isHeld = !bench.options.quick;
  const double p50 = Find(seen, "display_delay_ms_p50"), p99 = Find(seen, "display_delay_ms_p99");
  if (isPage) {
    results.AddFigureAtMost(key + "_delay_ms_p50", p50, line.p50, isHeld);
    results.AddFigureAtMost(key + "_delay_ms_p99", p99, line.p99, isHeld);
  } else {
    results.AddFigure(key + "_delay_ms_p50", p50);
    results.AddFigure(key + "_delay_ms_p99", p99);
  }
  results.AddFigure(key + "_stalls_per_minute", Find(seen, "stalls_per_minute"));
  const double gaps = Find(seen, "gaps_per_minute");
  if (isPage && std::string_view(line.name) == "loss5") {
    results.AddFigureAtMost(key + "_gaps_per_minute", gaps, 0, isHeld);
  } else {
    results.AddFigure(key + "_gaps_per_minute", gaps);
  }
  results.AddFigure(key + "_join_ms", Find(seen, "join_ms"));
  const double starved = Find(seen, "inputs_starved_percent");
  if (isPage && !IsInterrupted(line)) {
    results.AddFigureAtMost(key + "_inputs_starved_percent", starved, 0.2, isHeld);
  } else {
    results.AddFigure(key + "_inputs_starved_percent", starved);
  }
  if (isPage) {
    const double low = Find(seen, "low_delay_after_ms");
    const bool isAsked = std::string_view(line.name) == "clean";
    isAsked ? results.AddFigureAtMost(key + "_low_delay_after_ms", low, 2000, isHeld)
            : results.AddFigure(key + "_low_delay_after_ms", low);
  }
  nlohmann::ordered_json row{{"line", line.shows}, {"kind", kind}};
  for (const auto& [name, value] : seen.items()) row[name] = value;
  results.rows.push_back(std::move(row));
}

// The longest time for which bases hold up a frame of play, and anything one of the join: the least of several joins,
// because whatever else this machine does adds to it.
void MeasureCompletion(Bench& bench, const std::string& page) {
  const int joins = bench.options.quick ? 1 : 5;
  double least = std::numeric_limits<double>::infinity(), joining = least;
  for (int i = 0; i < joins && !bench.progress.IsStopAsked(); ++i) {
    const Run run = Emulate(kLines[0], page + "4", 4, bench.options.seed);
    if (run.code == kNotPermitted) return;
    least = std::fmin(least, Find(run.seen, "longest_completing_ms"));
    joining = std::fmin(joining, Find(run.seen, "longest_joining_ms"));
  }
  bench.results.AddFigureAtMost("longest_completing_ms", least, 8, !bench.options.quick);
  bench.results.AddFigure("longest_joining_ms", joining);
}

}  // namespace

void MeasureLines(Bench& bench) {
  const double seconds = bench.options.quick ? 6 : 60;
  const std::string tail = std::to_string(static_cast<int>(seconds));
  const std::string native = std::string(WOBBLE_NATIVE_PLAYER) + " 10.77.0.1 4000 " + tail;
  const std::string page =
      "node " WOBBLE_SOURCE_DIR "/tests/net/emulator/page_player.mjs " WOBBLE_NPM_DIR "/package 10.77.0.1:8080 ";
  Plot plot{.name = "link",
            .title = "Display delay over emulated lines, median and 99th percentile",
            .xLabel = "",
            .yLabel = "ms",
            .series = {{.name = "native, median", .stroke = Stroke::kPoints, .points = {}, .colour = 1},
                       {.name = "native, p99", .stroke = Stroke::kRings, .points = {}, .colour = 1},
                       {.name = "page, median", .stroke = Stroke::kPoints, .points = {}, .colour = 2},
                       {.name = "page, p99", .stroke = Stroke::kRings, .points = {}, .colour = 2}},
            .yFromZero = true};
  for (const Line& line : kLines) plot.xNames.push_back(line.shows);
  // Trains the bases, if nobody has: else the first player would wait for them.
  static_cast<void>(std::system((kServer + " --port 0 --for 0.01 >/dev/null 2>&1").c_str()));
  const std::size_t count = bench.options.quick ? 1 : kLines.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t kind = 0; kind < 2; ++kind) {
      if (bench.progress.IsStopAsked()) return;
      const Run run = Emulate(kLines[i], kind == 0 ? native : page + tail, seconds, bench.options.seed);
      if (run.code == kNotPermitted) {
        bench.results.remarks.push_back(
            "This system permits no network namespaces or TUN devices: nothing was measured.");
        return;
      }
      AddRow(bench, kLines[i], kind == 0 ? "native" : "page", run.seen);
      const double x = static_cast<double>(i + 1) + (kind == 0 ? -0.05 : 0.05);
      plot.series[2 * kind].points.push_back({x, Find(run.seen, "display_delay_ms_p50")});
      plot.series[2 * kind + 1].points.push_back({x, Find(run.seen, "display_delay_ms_p99")});
      bench.progress.Show(2 * i + kind + 1, 2 * count);
    }
  }
  MeasureCompletion(bench, page);
  bench.results.plots.push_back(std::move(plot));
  bench.results.remarks.push_back(
      "Each line is this system's TCP and UDP between two network namespaces; each player plays arena for " + tail +
      " s.");
}

#else

void MeasureLines(Bench& bench) {
  bench.results.remarks.push_back("This build has no emulator: nothing was measured.");
}

#endif

}  // namespace wobble::bench
