#include "tests/bench/capacity/party.h"

#include <ctime>
#include <filesystem>
#include <thread>

#include "client/bots/options.h"
#include "client/command/command.h"
#include "protocol/transport/enet_transport.h"
#include "protocol/version.h"
#include "server/recording/excerpt.h"
#include "server/training/basis_shelf.h"
#include "tests/bench/capacity/cores.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr std::size_t kSpareConnections = 8;

server::Config MakeConfig(unsigned players, std::uint64_t seed) {
  server::Config config;
  config.maxClients = static_cast<int>(players);
  config.clientKbit = kClientKbit;
  config.seed = seed;
  return config;
}

constexpr std::uint32_t kTickHz = 60;
constexpr std::uint32_t kAround = 5 * kTickHz;  // ticks before the worst one, and behind it

void Record(const Game& game, server::Server& server) {
  const auto readTime = [] { return static_cast<std::uint64_t>(std::time(nullptr)); };
  server.Record({.folder = game.recordings, .maxFileBytes = ~std::uint64_t{0}, .readUnixTime = readTime},
                {.version = kVersion, .scene = game.source, .tickHz = kTickHz, .seed = game.seed});
}

// Of the whole recording ten seconds are left: those about the longest tick.
std::string KeepWorst(const Game& game, unsigned players, std::uint32_t worst, server::Server& server) {
  server.EndRecording();
  const recording::Recorder& recorder = *server.ReadRecorder();
  if (recorder.Counts().failures > 0) return "no recording: " + recorder.Error();
  const std::filesystem::path whole = recorder.Path();
  const auto kept = std::filesystem::path(game.recordings) / ("worst-of-" + std::to_string(players) + ".wobrec");
  const std::uint32_t begin = worst > kAround ? worst - kAround : 0;
  const std::string error = recording::WriteExcerpt(whole, begin, worst + kAround, kept, {});
  std::error_code code;
  std::filesystem::remove(whole, code);
  return error.empty() ? kept.string() : "no recording: " + error;
}

}  // namespace

Game MakeGame(const Options& options) {
  Game game;
  scenes::LoadResult loaded = scenes::LoadScene(options.scene, scenes::FindShippedScenes());  // main has checked it
  game.scene = std::move(loaded.scene);
  game.source = std::move(loaded.source);
  game.recordings = options.recordings;
  game.bases = server::LoadBases(game.scene, {}, static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  game.script = bots::FindScriptFile(options.script);
  game.seed = options.seed;
  return game;
}

std::unique_ptr<bots::Script> LoadScript(const Game& game, std::string& fault) {
  auto script = std::make_unique<bots::Script>(game.seed, [](unsigned, std::string_view) {});
  return script->LoadFile(game.script, fault) ? std::move(script) : nullptr;
}

Party PlayParty(const Game& game, unsigned players, const Timetable& timetable,
                const std::function<bool()>& isStopAsked) {
  Party party;
  party.players = players;
  const auto script = LoadScript(game, party.fault);
  if (script == nullptr) return party;
  transport::ListenOptions listen;
  listen.maxConnections = players + kSpareConnections;
  auto transport = transport::EnetTransport::Listen(listen, party.fault);
  if (transport == nullptr) return party;
  const std::uint16_t port = transport->ReadPort();
  server::Server server(MakeConfig(players, game.seed), game.scene, std::move(transport), ReadWallTime(), game.bases,
                        &ReadThreadTime);
  if (!game.recordings.empty()) Record(game, server);
  std::atomic<Stage> stage{Stage::kGather};
  Host host(server);
  Guests guests(players, port, game.seed, *script, timetable, stage);
  const Cores cores = ChooseCores();
  std::jthread hostThread([&] {
    StayOn(cores.server);
    host.Run(stage);
  });
  std::jthread guestsThread([&] {
    StayOn(cores.bots);
    guests.Run(isStopAsked);
  });
  guestsThread.join();
  hostThread.join();
  party.hosted = host.Take();
  party.guested = guests.Take();
  party.shown = CompareViews(party.guested.views, party.hosted.truth, party.hosted.places);
  if (!party.hosted.hasAllPlaces) party.shown = {};
  if (!game.recordings.empty()) party.recording = KeepWorst(game, players, party.hosted.worstTick, server);
  return party;
}

}  // namespace wobble::bench
