#include "tests/bench/capacity/crowd.h"

#include <cstdio>

#include "tests/bench/packet_header.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

// A fifth of the bots at a time, as in a party: bots that were all served at once would wait for the same tick.
constexpr unsigned kCrowdParts = 5;
constexpr double kCrowdRound = 1.0 / (60 * kCrowdParts);
constexpr double kCrowdRamp = 1;  // s

server::Config MakeCrowdConfig(const CrowdOptions& options, std::uint64_t seed) {
  server::Config config;
  config.maxClients = static_cast<int>(options.players);
  config.clientKbit = options.clientKbit;
  config.threads = options.threads;
  config.seed = seed;
  return config;
}

bots::LoadTestOptions MakeCrowdBots(unsigned players, std::uint64_t seed) {
  bots::LoadTestOptions options;
  options.count = players;
  options.ramp = kCrowdRamp;
  options.seed = seed;
  return options;
}

}  // namespace

Crowd::Crowd(const Game& game, const CrowdOptions& options, bots::Script& script)
    : m_network({.seed = game.seed}),
      m_server(MakeCrowdConfig(options, game.seed), game.scene, m_network.MakeServer(), 0, game.bases),
      m_runner(
          MakeCrowdBots(options.players, game.seed), script,
          [this](auto, std::string&) { return m_network.MakeClient(); }, [] { return 0.0; },
          [](std::string_view line) { std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data()); }) {
  m_network.SetConditions(options.link);
}

void Crowd::Play(double until, const OnTick& onTick) {
  for (;;) {
    const double tick = m_server.NextCall();
    const double next = std::min(tick, m_nextRound);
    if (next >= until) return;
    if (tick <= m_nextRound) {
      PlayTick(next, onTick);
    } else {
      m_runner.RunRound(next, 0, kCrowdParts);
      m_nextRound += kCrowdRound;
    }
  }
}

void Crowd::PlayTick(double now, const OnTick& onTick) {
  const double began = ReadWallTime();
  const int ticks = m_server.Tick(now);
  const double seconds = ReadWallTime() - began;
  if (onTick && ticks > 0) onTick(seconds / ticks);
}

double FindSnapshotKbit(const server::SendCounts& before, const server::SendCounts& after) {
  return 8e-3 * (static_cast<double>(after.bytes - before.bytes) +
                 kPacketHeaderBytes * static_cast<double>(after.packets - before.packets));
}

}  // namespace wobble::bench
