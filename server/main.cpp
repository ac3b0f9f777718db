// wobbled: options, signals, logger and the only clock. Everything below is told what time it is.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <thread>

#include "protocol/transport/enet_transport.h"
#include "server/basis_shelf.h"
#include "server/ops/endpoint.h"
#include "server/ops/trace.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "server/summary.h"

namespace {

using namespace wobble;

constexpr int kBadUsage = 2;

// Places for a few connections more than players, so that one too many hears why it is refused.
constexpr std::size_t kSpareConnections = 8;

// After the last tick, how long goodbyes may take to be acknowledged, s.
constexpr double kCloseTime = 1;

constexpr server::Range kDurationRange{0, 1e6};             // s, eleven days
constexpr server::Range kSeedRange{0, 9007199254740992.0};  // 2^53: exact as a number in JSON too

struct Options {
  server::Config config;
  std::string scene = "arena";
  double runFor = 0;  // s; 0: until a signal
  double statusEvery = 0;
  std::string logLevel = "info";
  std::string summaryFile;
  std::string cacheFolder;
  std::string ops;  // address; empty: none
  std::string traceFile;
  bool isUntrained = false;
  bool listScenes = false;
  std::vector<std::string> errors;  // a line for every number that cannot be used
};

volatile std::sig_atomic_t g_stop = 0;
void RequestStop(int) { g_stop = 1; }

double ReadClock() {
  static const auto start = std::chrono::steady_clock::now();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::filesystem::path FindSceneFolder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "scenes";
}

// A bad number is noted rather than thrown, so that all of them are named at once, each with its range.
template <class Number>
void AddNumber(CLI::App& app, const char* name, server::Range range, Number& value, const char* description,
               std::vector<std::string>& errors) {
  const auto read = [name, range, &value, &errors](const std::string& text) {
    Number number{};
    const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool isWhole = result == std::errc{} && end == text.data() + text.size();
    if (isWhole && static_cast<double>(number) >= range.low && static_cast<double>(number) <= range.high) {
      value = number;
    } else {
      errors.push_back(fmt::format("{} {}: must be {} to {}", name, text, range.low, range.high));
    }
  };
  app.add_option_function<std::string>(name, read, description)
      ->type_name(fmt::format("{} to {}", range.low, range.high))
      ->default_str(fmt::format("{}", value));
}

void DescribeOptions(CLI::App& app, Options& options) {
  server::Config& config = options.config;
  const auto addNumber = [&](const char* name, server::Range range, auto& value, const char* description) {
    AddNumber(app, name, range, value, description, options.errors);
  };
  app.description("wobbled hosts a world of soft bodies for many players.");
  app.set_version_flag("--version", "wobbled " WOBBLE_VERSION);
  app.add_option("--scene", options.scene, "Name of a shipped scene, or a path to a .toml file")->capture_default_str();
  addNumber("--port", server::kPortRange, config.port, "UDP port");
  addNumber("--tick-hz", server::kTickHzRange, config.tickHz, "Steps of the world a second");
  addNumber("--snapshot-hz", server::kSnapshotHzRange, config.snapshotHz, "Snapshots a second, at most --tick-hz");
  addNumber("--max-clients", server::kMaxClientsRange, config.maxClients, "Players and spectators at once");
  addNumber("--max-per-address", server::kMaxPerAddressRange, config.maxPerAddress,
            "Of one IP address; 0: as many as --max-clients");
  addNumber("--threads", server::kThreadsRange, config.threads, "Threads that step bodies");
  addNumber("--client-kbit", server::kClientKbitRange, config.clientKbit,
            "Snapshot budget of a client, kbit/s with headers");
  addNumber("--view-distance", server::kViewDistanceRange, config.viewDistance,
            "Metres from a player's body within which other bodies are sent");
  addNumber("--pause-after", server::kPauseAfterRange, config.pauseAfter,
            "Seconds that a world with nobody connected goes on for, then it waits; 0: it never waits");
  addNumber("--for", kDurationRange, options.runFor, "Seconds to run; 0: until Ctrl-C");
  addNumber("--seed", kSeedRange, config.seed, "Of the scene's random placement");
  app.add_option("--log-level", options.logLevel, "debug, info, warn, error or off")->capture_default_str();
  addNumber("--status", kDurationRange, options.statusEvery, "Seconds between status lines on stdout; 0: none");
  app.add_option("--summary", options.summaryFile, "File to write a summary of the run to, as JSON");
  app.add_option("--ops", options.ops,
                 "HOST:PORT, or PORT for this machine only, that answers /metrics (Prometheus), /healthz and /readyz");
  app.add_option("--trace", options.traceFile, "File to write the phases of every tick to, for chrome://tracing");
  app.add_option("--cache", options.cacheFolder, "Folder that keeps trained bases of shapes from one start to the next")
      ->envname("WOBBLE_CACHE");
  app.add_flag("--untrained", options.isUntrained,
               "Starts at once, without trained bases: shapes take three times the bits")
      ->envname("WOBBLE_UNTRAINED");
  app.add_flag("--list-scenes", options.listScenes, "Names of shipped scenes");
  app.footer(
      "Examples:\n"
      "  wobbled                                  the arena on port 7777\n"
      "  wobbled --scene crowd --client-kbit 2000 a busy scene, more bytes for each client\n"
      "  wobbled --scene my.toml --port 7801      a scene of your own\n"
      "  wobbled --for 30 --summary run.json      half a minute, figures at the end\n"
      "  wobbled --ops 9100                       then: curl 127.0.0.1:9100/metrics\n"
      "  wobbled --for 90 --pause-after 0         the same without players: the world never waits for one");
}

[[nodiscard]] int ListScenes() {
  for (const scenes::SceneSummary& scene : scenes::ListScenes(FindSceneFolder())) {
    fmt::print("{:12} {}\n", scene.name, scene.description);
  }
  return 0;
}

void Complain(const std::vector<std::string>& errors) {
  for (const std::string& error : errors) fmt::print(stderr, "wobbled: {}\n", error);
}

// False when the level is none that spdlog knows.
bool StartLogger(const std::string& level) {
  const auto parsed = spdlog::level::from_str(level == "warn" ? "warning" : level);
  if (parsed == spdlog::level::off && level != "off") return false;
  spdlog::set_default_logger(spdlog::stderr_color_mt("wobbled"));
  spdlog::set_level(parsed);
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
  return true;
}

class StatusLine {
 public:
  explicit StatusLine(double every) : m_every(every), m_isTerminal(isatty(STDOUT_FILENO) == 1) {}

  void Update(const server::Server& server, const server::TickTimes& times, double now) {
    if (m_every <= 0 || now < m_next) return;
    m_next = now + m_every;
    const std::uint64_t bytes = server.ReadTransport().bytesOut;
    const auto rate = static_cast<std::uint64_t>(static_cast<double>(bytes - m_lastBytes) / m_every);
    m_lastBytes = bytes;
    const std::string line = server::MakeStatusLine(server, times, now, rate);
    fmt::print("{}{}{}", m_isTerminal ? "\r\x1b[K" : "", line, m_isTerminal ? "" : "\n");
    std::fflush(stdout);
  }
  void Finish() const {
    if (m_every > 0 && m_isTerminal) fmt::print("\n");
  }

 private:
  double m_every;
  bool m_isTerminal;
  double m_next = 0;
  std::uint64_t m_lastBytes = 0;
};

// Whatever watches the ticks; none of it must be there.
struct Watchers {
  server::TickTimes times;
  std::unique_ptr<ops::Endpoint> endpoint;
  std::optional<ops::Gauge> gauge;  // of the endpoint
  std::optional<ops::Trace> trace;

  void Watch(const server::Server& server) {
    for (const server::PhaseTimes& tick : server.LastTicks()) times.Record(tick.Sum());
    if (trace) trace->Write(server.LastTicks(), server.World().Tick());
    if (endpoint == nullptr) return;
    gauge->Read(server, ReadClock());
    endpoint->Tell(gauge->ReadFigures());
  }
};

void Run(server::Server& server, const Options& options, Watchers& watchers) {
  StatusLine status(options.statusEvery);
  while (g_stop == 0 && (options.runFor <= 0 || ReadClock() < options.runFor)) {
    server.Tick(ReadClock());
    watchers.Watch(server);
    status.Update(server, watchers.times, ReadClock());
    const double wait = server.NextCall() - ReadClock();
    if (wait > 0) std::this_thread::sleep_for(std::chrono::duration<double>(wait));
  }
  status.Finish();
}

void CloseDown(server::Server& server, Watchers& watchers) {
  const double deadline = ReadClock() + kCloseTime;
  server.Close(ReadClock());
  watchers.Watch(server);
  while (!server.IsEmpty() && ReadClock() < deadline) {
    server.Poll(ReadClock());
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

// False when it cannot be written.
bool WriteSummary(const std::string& path, const std::string& summary) {
  std::ofstream file(path);
  file << summary;
  return file.good();
}

// False with a line said when what was asked for cannot be had.
bool StartWatching(const Options& options, Watchers& watchers) {
  if (!options.traceFile.empty() && !watchers.trace.emplace().Open(options.traceFile)) {
    Complain({"--trace " + options.traceFile + ": cannot be written"});
    return false;
  }
  if (options.ops.empty()) return true;
  ops::Address address;
  std::string error;
  if (ops::ParseAddress(options.ops, address, error)) {
    watchers.endpoint = ops::Endpoint::Listen(address, WOBBLE_VERSION, options.scene, &ReadClock, error);
  }
  if (watchers.endpoint == nullptr) {
    Complain({"--ops " + error});
    return false;
  }
  watchers.gauge.emplace(options.config);
  return true;
}

int RunServer(const Options& options) {
  scenes::LoadResult loaded = scenes::LoadScene(options.scene, FindSceneFolder());
  if (!options.errors.empty() || !loaded.errors.empty()) {
    Complain(options.errors);
    Complain(loaded.errors);
    return kBadUsage;
  }
  if (const auto errors = server::Validate(options.config, loaded.scene); !errors.empty()) {
    Complain(errors);
    return kBadUsage;
  }
  if (!options.summaryFile.empty() && !WriteSummary(options.summaryFile, "")) {
    Complain({"--summary " + options.summaryFile + ": cannot be written"});
    return kBadUsage;
  }

  transport::ListenOptions listen;
  listen.port = options.config.port;
  listen.maxConnections = static_cast<std::size_t>(options.config.maxClients) + kSpareConnections;
  listen.maxPerAddress = static_cast<std::size_t>(options.config.maxPerAddress);
  std::string error;
  Watchers watchers{server::TickTimes(1.0 / options.config.tickHz), nullptr, {}, {}};
  if (!StartWatching(options, watchers)) return kBadUsage;
  auto transport = transport::EnetTransport::Listen(listen, error);
  if (transport == nullptr) {
    Complain({error});
    return kBadUsage;
  }

  std::vector<server::Bases> bases;
  if (!options.isUntrained) bases = server::LoadBases(loaded.scene, options.cacheFolder, options.config.threads);
  server::Server server(options.config, std::move(loaded.scene), std::move(transport), ReadClock(), std::move(bases),
                        &ReadClock);
  fmt::print("listening on UDP port {}, scene {}\n", options.config.port, options.scene);
  std::fflush(stdout);
  Run(server, options, watchers);
  const std::string summary = server::MakeSummary(server, watchers.times);
  CloseDown(server, watchers);
  if (watchers.trace && !watchers.trace->Close()) {
    Complain({"--trace " + options.traceFile + ": could not be written in full"});
    return 1;
  }
  if (!options.summaryFile.empty() && !WriteSummary(options.summaryFile, summary)) {
    Complain({"--summary " + options.summaryFile + ": cannot be written"});
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.config.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  options.statusEvery = isatty(STDOUT_FILENO) == 1 ? 1 : 0;
  CLI::App app;
  DescribeOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "wobbled: {} (see wobbled --help)\n", error.what());
    return kBadUsage;
  }
  if (options.listScenes) return ListScenes();
  if (!StartLogger(options.logLevel)) {
    Complain({"--log-level " + options.logLevel + ": must be one of debug, info, warn, error, off"});
    return kBadUsage;
  }
  std::signal(SIGINT, RequestStop);
  std::signal(SIGTERM, RequestStop);
  return RunServer(options);
}
