// The cost of resting bodies once a watcher has received them: a server with a scene of balls at rest, and what it
// sends beyond packet headers.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>

#include "client/client.h"
#include "protocol/snapshot.h"
#include "protocol/transport/virtual_network.h"
#include "server/physics/shapes/ball.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "tests/bench/codec/experiments.h"

namespace wobble::bench {
namespace {

constexpr const char* kScene = R"(
[[obstacle]]
kind = "plane"
[[blueprint]]
name = "ball"
[[bodies]]
blueprint = "ball"
position = [-4, -4, 1.05]
count = [2, 2, 1]
spacing = [4, 4, 0]
[player]
blueprint = "ball"
)";
constexpr double kLongestWait = 300;  // s; balls roll for most of a minute before they sleep
constexpr double kAfterwards = 1;
constexpr double kWatched = 3;

// Bytes sent by the server so far, without packet headers.
double CountRecordBytes(const server::Server& server) {
  const server::SendCounts& sent = server.ReadSendCounts();
  return static_cast<double>(sent.bytes) - static_cast<double>(sent.packets * protocol::kSnapshotHeadBytes);
}

}  // namespace

void MeasureRest(Bench& bench) {
  spdlog::set_level(spdlog::level::off);
  transport::VirtualNetwork network;
  network.SetConditions({.delay = 0.02});
  const server::Config config;
  server::Server server(config, scenes::ParseScene(kScene, "rest").scene, network.MakeServer(), 0);
  client::Client client(network.MakeClient(), {.spectator = true}, 0);
  const auto play = [&](double until, const auto& isDone) {
    double now = server.NextCall();
    for (; now < until && !isDone(); now = server.NextCall()) {
      server.Tick(now);
      client.Update(now);
    }
    return now;
  };
  const auto bodies = server.World().Bodies();
  const auto isAsleep = [](const physics::Body& body) { return body.asleep; };
  const double asleepAt = play(kLongestWait, [&] { return std::all_of(bodies.begin(), bodies.end(), isAsleep); });
  const double began = play(asleepAt + kAfterwards, [] { return false; });
  const double before = CountRecordBytes(server);
  (void)play(began + kWatched, [] { return false; });
  const double bytes = CountRecordBytes(server) - before;
  const bool isRight =
      client.ReadState() == client::State::kPlaying && std::all_of(bodies.begin(), bodies.end(), isAsleep);
  const double vertices = static_cast<double>(bodies.size() * physics::CountVertices(2));
  const double bits =
      isRight ? 8 * bytes / (vertices * kWatched * config.snapshotHz) : std::numeric_limits<double>::quiet_NaN();
  bench.results.rows.push_back(
      {{"experiment", "rest"}, {"asleep_s", asleepAt}, {"bytes", bytes}, {"bits_per_vertex", bits}});
  bench.results.AddFigureAtMost("bits_at_rest", bits, 0);
}

}  // namespace wobble::bench
