// wobbled: options, signals, logger and the only clock. Everything below is told what time it is.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <thread>

#include "protocol/transport/enet_transport.h"
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

struct Options {
  server::Config config;
  std::string scene = "arena";
  double runFor = 0;  // s; 0: until a signal
  double statusEvery = 0;
  std::string logLevel = "info";
  std::string summaryFile;
  bool listScenes = false;
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

void DescribeOptions(CLI::App& app, Options& options) {
  server::Config& config = options.config;
  app.description("wobbled hosts a world of soft bodies for many players.");
  app.set_version_flag("--version", "wobbled " WOBBLE_VERSION);
  app.add_option("--scene", options.scene, "Name of a shipped scene, or a path to a .toml file")->capture_default_str();
  app.add_option("--port", config.port, "UDP port")->capture_default_str();
  app.add_option("--tick-hz", config.tickHz, "Steps of the world a second")->capture_default_str();
  app.add_option("--snapshot-hz", config.snapshotHz, "Snapshots a second, at most --tick-hz")->capture_default_str();
  app.add_option("--max-clients", config.maxClients, "Players and spectators at once")->capture_default_str();
  app.add_option("--max-per-address", config.maxPerAddress, "Of one IP address; 0: as many as --max-clients")
      ->capture_default_str();
  app.add_option("--threads", config.threads, "Threads that step bodies")->capture_default_str();
  app.add_option("--client-kbit", config.clientKbit, "Snapshot budget of a client, kbit/s with headers")
      ->capture_default_str();
  app.add_option("--for", options.runFor, "Seconds to run; 0: until Ctrl-C")->capture_default_str();
  app.add_option("--seed", config.seed, "Of the scene's random placement")->capture_default_str();
  app.add_option("--log-level", options.logLevel, "debug, info, warn, error or off")->capture_default_str();
  app.add_option("--status", options.statusEvery, "Seconds between status lines on stdout; 0: none")
      ->default_str("1 on a terminal, else 0");
  app.add_option("--summary", options.summaryFile, "File to write a summary of the run to, as JSON");
  app.add_flag("--list-scenes", options.listScenes, "Names of shipped scenes");
  app.footer(
      "Examples:\n"
      "  wobbled                                  the arena on port 7777\n"
      "  wobbled --scene crowd --client-kbit 2000 a busy scene, more bytes for each client\n"
      "  wobbled --scene my.toml --port 7801      a scene of your own\n"
      "  wobbled --for 30 --summary run.json      half a minute, figures at the end");
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

void Run(server::Server& server, const Options& options, server::TickTimes& times) {
  StatusLine status(options.statusEvery);
  while (g_stop == 0 && (options.runFor <= 0 || ReadClock() < options.runFor)) {
    const double begin = ReadClock();
    const int ticks = server.Tick(begin);
    const double duration = (ReadClock() - begin) / std::max(1, ticks);
    for (int i = 0; i < ticks; ++i) times.Record(duration);
    status.Update(server, times, ReadClock());
    const double wait = server.NextTick() - ReadClock();
    if (wait > 0) std::this_thread::sleep_for(std::chrono::duration<double>(wait));
  }
  status.Finish();
}

void CloseDown(server::Server& server) {
  const double deadline = ReadClock() + kCloseTime;
  server.Close(ReadClock());
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

int RunServer(const Options& options) {
  scenes::LoadResult loaded = scenes::LoadScene(options.scene, FindSceneFolder());
  if (!loaded.errors.empty()) {
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
  auto transport = transport::EnetTransport::Listen(listen, error);
  if (transport == nullptr) {
    Complain({error});
    return kBadUsage;
  }

  server::Server server(options.config, std::move(loaded.scene), std::move(transport), ReadClock());
  server::TickTimes times(1.0 / options.config.tickHz);
  fmt::print("listening on UDP port {}, scene {}\n", options.config.port, options.scene);
  std::fflush(stdout);
  Run(server, options, times);
  const std::string summary = server::MakeSummary(server, times);
  CloseDown(server);
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
