// wobbled: options, signals, logger, and the only clock. All code below main is given the time as a parameter.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

#include "protocol/transport/enet_transport.h"
#include "protocol/transport/vestibule/key_file.h"
#include "protocol/usage/command_line.h"
#include "protocol/usage/terminal.h"
#include "protocol/version.h"
#include "server/admission/open_gate.h"
#include "server/ops/log_format.h"
#include "server/program/options.h"
#include "server/program/order_doors.h"
#include "server/program/replaying.h"
#include "server/program/scene_choice.h"
#include "server/program/watchers.h"
#include "server/scenes/loader.h"
#include "server/server.h"

namespace {

using namespace wobble;
using server::Complain;
using server::Options;
using server::Watchers;
namespace vestibule = transport::vestibule;

constexpr int kBadUsage = 2;

// Connections beyond --max-clients, so that a client too many is told why it is refused.
constexpr std::size_t kSpareConnections = 8;

// How long clients may take to acknowledge goodbyes after the last tick, s.
constexpr double kCloseTime = 1;

volatile std::sig_atomic_t g_stop = 0;
void RequestStop(int) { g_stop = 1; }
volatile std::sig_atomic_t g_hangup = 0;
void NoteHangup(int) { g_hangup = 1; }

std::uint64_t ReadUnixTime() { return static_cast<std::uint64_t>(std::time(nullptr)); }

double ReadClock() {
  static const auto start = std::chrono::steady_clock::now();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

[[nodiscard]] int ListScenes() {
  for (const scenes::SceneSummary& scene : scenes::ListScenes(scenes::FindShippedScenes())) {
    fmt::print("{:12} {}\n", scene.name, scene.description);
  }
  return 0;
}

// Returns false after it has said which option cannot be used.
bool StartLogger(const Options& options) {
  const auto level = spdlog::level::from_str(options.logLevel == "warn" ? "warning" : options.logLevel);
  if (level == spdlog::level::off && options.logLevel != "off") {
    Complain(options, {"--log-level " + options.logLevel + ": must be one of debug, info, warn, error, off"});
    return false;
  }
  const std::optional<ops::LogFormat> format = ops::ParseLogFormat(options.logFormat);
  if (!format) {
    Complain(options, {"--log-format " + options.logFormat + ": must be text or json"});
    return false;
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("wobbled"));
  spdlog::set_level(level);
  spdlog::set_formatter(ops::MakeLogFormatter(*format));
  return true;
}

// SIGHUP: a terminal that is closed ends its server, with a goodbye. Else files that others have changed are read
// again.
void HandleHangup(const Options& options, admission::Gate& gate, bool hadTerminal) {
  if (g_hangup == 0) return;
  g_hangup = 0;
  if (hadTerminal && !usage::HasTerminal()) {
    g_stop = 1;
    return;
  }
  std::string error;
  if (admission::ReloadGate(options.gate, gate, error)) {
    spdlog::info("password, keys, bans and invites are read again");
  } else {
    spdlog::error("nothing is read again: {}", error);
  }
}

// The end of a match ends the server, unless a fleet manager does.
bool HasEnded(const server::Server& server, const Options& options, const Watchers& watchers) {
  return g_stop != 0 || (options.runFor > 0 && ReadClock() >= options.runFor) ||
         (server.IsMatchOver() && !watchers.agones);
}

void Run(const admin::Realm& realm, const Options& options, admin::OrderQueue& orders, Watchers& watchers,
         bool hadTerminal) {
  server::Server& server = realm.server;
  server.SetOrderTaker([&realm](server::ClientId client, transport::Rank rank, const std::string& line) {
    return admin::CarryOut(realm, {.rank = rank, .client = client}, line, ReadClock()).lines;
  });
  while (!HasEnded(server, options, watchers)) {
    HandleHangup(options, realm.gate, hadTerminal);
    orders.CarryOutAll(realm, ReadClock());
    server.Tick(ReadClock());
    watchers.Watch(server, ReadClock());
    const double wait = server.NextCall() - ReadClock();
    if (wait > 0) std::this_thread::sleep_for(std::chrono::duration<double>(wait));
  }
  watchers.status.Finish();
}

void CloseDown(server::Server& server, Watchers& watchers) {
  watchers.notices.TellEnding();
  const double deadline = ReadClock() + kCloseTime;
  server.Close(server.IsMatchOver() ? "the match is over" : "", ReadClock());
  watchers.Watch(server, ReadClock());
  while (!server.IsEmpty() && ReadClock() < deadline) {
    server.Poll(ReadClock());
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

// Returns false when the file cannot be written.
bool WriteSummary(const std::string& path, const std::string& summary) {
  std::ofstream file(path);
  file << summary;
  return file.good();
}

// Opens the trace and the endpoint if they are asked for. port: of Agones' sidecar, 0 without one. Returns false after
// it has reported what failed.
bool StartWatching(const Options& options, Watchers& watchers, std::uint16_t& port) {
  if (!options.traceFile.empty() && !watchers.trace.emplace().Open(options.traceFile)) {
    Complain(options, {"--trace " + options.traceFile + ": cannot be written"});
    return false;
  }
  std::string error;
  if (const char* words = std::getenv("AGONES_SDK_HTTP_PORT"); words != nullptr) {
    port = ops::ParseSidecarPort(words, error).value_or(0);
    if (port == 0) {
      Complain(options, {error});
      return false;
    }
  }
  if (options.ops.empty()) return true;
  ops::Address address;
  if (ops::ParseAddress(options.ops, address, error)) {
    watchers.endpoint = ops::Endpoint::Listen(address, kVersion, options.scene, &ReadClock, error);
  }
  if (watchers.endpoint == nullptr) {
    Complain(options, {"--ops " + error});
    return false;
  }
  fmt::print("metrics and health on TCP port {} of {}\n", watchers.endpoint->ReadPort(), address.host);
  return true;
}

std::filesystem::path FindKeyFile(const Options& options) {
  return options.keyFile.empty() ? vestibule::FindStateFile(vestibule::kServerKeyName)
                                 : std::filesystem::path(options.keyFile);
}

void WarnOfOpenFiles(const Options& options) {
  for (const std::string& file :
       admission::FindReadableByAll(options.gate, {FindKeyFile(options).string(), options.rconPasswordFile})) {
    spdlog::warn("{}: everybody on this machine can read it; chmod 600 keeps it to its owner", file);
  }
}

// The key of --key, or of the default file; one for this run only where that one cannot be kept. nullopt after it has
// reported what failed.
std::optional<vestibule::Key> ChooseKey(const Options& options) {
  const std::filesystem::path file = FindKeyFile(options);
  std::string error = "no folder is known for it";
  std::optional<vestibule::Key> key;
  if (!file.empty()) key = vestibule::LoadOrMakeKey(file, error);
  if (key) return key;
  if (!options.keyFile.empty()) {
    Complain(options, {"--key: " + error});
    return {};
  }
  spdlog::warn("the server's key holds for this run only: {}", error);
  key.emplace();
  vestibule::FillRandomly(*key);
  return key;
}

// What is missing in the recordings, once they have ended.
void TellLost(const server::Server& server, int tickHz) {
  const recording::Recorder* recorder = server.ReadRecorder();
  const std::uint64_t lost = recorder != nullptr ? recorder->Counts().lostTicks : 0;
  if (lost == 0) return;
  spdlog::warn("--record: {:.1f} s of what was played are not recorded: {}", static_cast<double>(lost) / tickHz,
               recorder->Error());
}

int RunServer(Options options, bool hadTerminal) {
  std::optional<recording::Recording> film;
  if (!options.replayFile.empty()) {
    film.emplace();
    if (const std::string error = film->Open(options.replayFile); !error.empty()) {
      Complain(options, {options.replayFile + " " + error});
      return kBadUsage;
    }
    options.config.tickHz = static_cast<int>(film->ReadHead().tickHz);
    options.config.snapshotHz = std::min(options.config.snapshotHz, options.config.tickHz);
    options.config.seed = film->ReadHead().seed;
    options.scene = film->ReadHead().scene.name;
  }
  std::vector<scenes::LoadResult> loaded;
  if (film) {
    loaded.push_back(scenes::ParseScene(film->ReadHead().scene));
    options.errors.insert(options.errors.end(), loaded.front().errors.begin(), loaded.front().errors.end());
  } else {
    loaded = server::LoadScenes(options);
  }
  if (const auto errors = server::FindMistakes(options, loaded); !errors.empty()) {
    Complain(options, errors);
    return kBadUsage;
  }
  if (options.isCheck) return 0;
  if (!options.summaryFile.empty() && !WriteSummary(options.summaryFile, "")) {
    Complain(options, {"--summary " + options.summaryFile + ": cannot be written"});
    return kBadUsage;
  }

  transport::ListenOptions listen;
  listen.port = options.config.port;
  listen.host = options.bind;
  // An input a tick, as many acknowledgements, and commands.
  listen.datagramRate = std::max(listen.datagramRate, 4.0 * options.config.tickHz);
  listen.maxConnections = static_cast<std::size_t>(options.config.maxClients) + kSpareConnections;
  listen.maxPerAddress = static_cast<std::size_t>(options.config.maxPerAddress);
  std::string error;
  Watchers watchers(options);
  std::uint16_t sidecar = 0;
  if (!StartWatching(options, watchers, sidecar)) return kBadUsage;
  if (!vestibule::InitialiseSodium()) {
    Complain(options, {"the cryptographic library does not start"});
    return kBadUsage;
  }
  listen.secretKey = ChooseKey(options);
  if (!listen.secretKey) return kBadUsage;
  admission::GateFiles gateFiles = options.gate;
  gateFiles.givesTicketsToAll = !options.stateFolder.empty();
  const auto gate = admission::OpenGate(gateFiles, *listen.secretKey, &ReadUnixTime, error);
  if (gate == nullptr) {
    Complain(options, {error});
    return kBadUsage;
  }
  WarnOfOpenFiles(options);
  listen.judge = gate;
  if (!options.isHidden) listen.pictures = std::make_shared<vestibule::PictureSlot>();
  server::OrderDoors doors;
  if (!doors.Open(options, *gate)) return kBadUsage;
  auto transport = transport::EnetTransport::Listen(listen, error);
  if (transport == nullptr) {
    Complain(options, {error});
    return kBadUsage;
  }
  const std::uint16_t port = transport->ReadPort();
  const std::string publicKey = vestibule::FormatKey(transport->ReadServerKey());

  std::vector<server::RotationScene> trained = server::TrainScenes(options, std::move(loaded));
  std::vector<scenes::SceneSource> sources;
  for (const server::RotationScene& each : trained) sources.push_back(each.source);
  server::Server server(options.config, trained.front().scene, std::move(transport), ReadClock(), trained.front().bases,
                        &ReadClock);
  if (trained.size() > 1) server.Rotate(std::move(trained));
  if (film && !server::StartFilm(options, std::move(*film), server, &ReadClock)) return kBadUsage;
  if (!server::StartKeeping(options, sources, server, ReadClock())) return kBadUsage;
  if (!server::StartRecording(options, sources[server.SceneNumber()], server, &ReadUnixTime)) return kBadUsage;
  const discovery::Identity identity{.name = options.name,
                                     .version = kVersion,
                                     .port = port,
                                     .key = publicKey,
                                     .maxClients = options.config.maxClients,
                                     .wantsCredential = gate->WantsCredential()};
  discovery::Teller::Slots tellers;
  if (listen.pictures != nullptr) tellers.push_back(listen.pictures);
  if (options.isAnnounced) {
    tellers.push_back(std::make_shared<vestibule::PictureSlot>());
    watchers.announcement = std::make_unique<discovery::Announcement>(tellers.back());
  }
  if (!tellers.empty()) watchers.teller.emplace(identity, tellers);
  spdlog::info("this server's key is {}", publicKey);
  const std::string rotation = fmt::format("{} of {}", server.SceneName(), fmt::join(server.ListRotation(), ", "));
  fmt::print("listening on UDP port {}{}, scene {}\n", port, options.bind.empty() ? "" : " of " + options.bind,
             sources.size() > 1 ? rotation : options.scene);
  std::fflush(stdout);
  watchers.notices.TellReady();
  if (sidecar != 0) watchers.agones.emplace(sidecar);
  Run({server, *gate}, options, doors.queue, watchers, hadTerminal);
  const std::string summary = server::MakeSummary(server, watchers.times);
  CloseDown(server, watchers);
  server.EndRecording();
  TellLost(server, options.config.tickHz);
  if (watchers.trace && !watchers.trace->Close()) {
    Complain(options, {"--trace " + options.traceFile + ": could not be written in full"});
    return 1;
  }
  if (!options.summaryFile.empty() && !WriteSummary(options.summaryFile, summary)) {
    Complain(options, {"--summary " + options.summaryFile + ": cannot be written"});
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
  app.name("wobbled");
  server::DescribeOptions(app, options);
  const std::vector<std::string> arguments = usage::AddEnvironment(app, {argv + 1, argv + argc});
  options.nameVariables = [&app](std::string line) { return usage::NameVariables(app, std::move(line)); };
  try {
    usage::Parse(app, arguments);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "wobbled: {} (see wobbled --help)\n", usage::Explain(app, error, arguments));
    return kBadUsage;
  }
  if (options.listScenes) return ListScenes();
  if (!options.listFolder.empty()) return server::ListRecordings(options);
  if (!StartLogger(options)) return kBadUsage;
  std::signal(SIGINT, RequestStop);
  std::signal(SIGTERM, RequestStop);
  std::signal(SIGHUP, NoteHangup);
  const bool hadTerminal = usage::HasTerminal();
  const bool isPlayed = !options.exportTarget.empty() || options.isVerify;
  if (isPlayed && !options.errors.empty()) {
    Complain(options, options.errors);
    return kBadUsage;
  }
  // Unless it is to outlive its terminal (nohup).
  if (isPlayed && std::signal(SIGHUP, RequestStop) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  if (!options.exportTarget.empty()) return server::ExportRecording(options, [] { return g_stop != 0; });
  if (options.isVerify) return server::VerifyRecording(options, [] { return g_stop != 0; });
  return RunServer(options, hadTerminal);
}
