#include "tests/bench/capacity/party.h"

#include <thread>

#include "client/bots/options.h"
#include "client/command/command.h"
#include "protocol/transport/enet_transport.h"
#include "server/scenes/loader.h"
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

}  // namespace

Game MakeGame(const Options& options) {
  Game game;
  game.scene = scenes::LoadScene(options.scene, scenes::FindShippedScenes()).scene;  // valid: main has checked it
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
  return party;
}

}  // namespace wobble::bench
