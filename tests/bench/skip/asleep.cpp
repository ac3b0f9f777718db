// A thousand sleeping balls beside ten that are kept awake by pulsating gas, against the ten alone: whole ticks of the
// server with a watching client, from receiving to sending. The servers take turns tick by tick; one period of the gas
// is the same work for both, and the fastest period counts. There is no gravity, so that undisturbed balls sleep within
// a second.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <deque>
#include <limits>

#include "client/client.h"
#include "protocol/transport/virtual_network.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "tests/bench/skip/experiments.h"
#include "tests/bench/throughput/peak.h"

namespace wobble::bench {
namespace {

constexpr int kTickHz = 60;
constexpr int kPeriod = kTickHz;  // of the gas of the awake balls, ticks
constexpr int kAwake = 10;
constexpr int kAsleep = 1000;
constexpr int kTicksToSleep = 120;  // and to send that state to the client

std::string DescribeScene(int asleep) {
  std::string text = R"(
gravity = [0, 0, 0]
[[obstacle]]
kind = "plane"
[[blueprint]]
name = "breathes"
subdivisions = 2
[[blueprint]]
name = "sleeps"
subdivisions = 2
[[bodies]]
blueprint = "breathes"
position = [0, -10, 1.5]
count = [10, 1, 1]
spacing = [2, 0, 0]
[[drive]]
blueprint = "breathes"
gas = 1.3
begin = 0
end = 0.5
period = 1
[player]
blueprint = "breathes"
)";
  if (asleep == 0) return text;
  const int side = 40;
  return text + FormatLine(
                    "[[bodies]]\nblueprint = \"sleeps\"\nposition = [0, 0, 0.5]\ncount = [%d, %d, 1]\n"
                    "spacing = [1.5, 1.5, 0]\n",
                    side, asleep / side);
}

// A server and a watching client on virtual time.
class Watched {
 public:
  explicit Watched(int asleep)
      : m_network(transport::VirtualNetworkOptions{}),
        m_server({.tickHz = kTickHz}, scenes::ParseScene(DescribeScene(asleep), "skip").scene, m_network.MakeServer(),
                 0),
        m_client(m_network.MakeClient(), {.spectator = true}, 0) {}

  // Plays one tick; returns the server's time for it.
  Took Step() {
    const double now = m_server.NextCall();
    const Took took = TimeWork([&] { m_server.Tick(now); });
    m_client.Update(now);
    return took;
  }
  // Whether exactly the ten are awake and the client receives them.
  [[nodiscard]] bool IsWatchedBreathing() const {
    const auto bodies = m_server.World().Bodies();
    const auto isAwake = [](const physics::Body& body) { return !body.asleep; };
    return m_client.ReadState() == client::State::kPlaying &&
           std::count_if(bodies.begin(), bodies.end(), isAwake) == kAwake;
  }

 private:
  transport::VirtualNetwork m_network;
  server::Server m_server;
  client::Client m_client;
};

}  // namespace

void MeasureAsleep(Bench& bench) {
  spdlog::set_level(spdlog::level::off);
  std::vector<int> counts{0, kAsleep};
  if (!bench.options.quick) counts = {0, kAsleep / 4, kAsleep / 2, kAsleep};
  std::deque<Watched> servers;
  for (const int count : counts) servers.emplace_back(count);
  for (int tick = 0; tick < kTicksToSleep; ++tick) {
    for (Watched& server : servers) server.Step();
  }
  const bool isRight =
      std::all_of(servers.begin(), servers.end(), [](const Watched& each) { return each.IsWatchedBreathing(); });
  std::vector<Fastest> fastest(counts.size());
  Peak peak;
  const int periods = bench.options.quick ? 8 : 60;
  for (int period = 0; period < periods && !bench.progress.IsStopAsked(); ++period) {
    std::vector<Took> took(counts.size());
    for (int tick = 0; tick < kPeriod; ++tick) {
      for (std::size_t i = 0; i < took.size(); ++i) took[i] += servers[i].Step();
    }
    for (std::size_t i = 0; i < took.size(); ++i) fastest[i].Note(took[i]);
    peak.Measure();
    bench.progress.Show(static_cast<std::size_t>(period) + 1, static_cast<std::size_t>(periods));
  }
  Plot plot{.name = "skip_asleep",
            .title = "A tick of the server: ten balls that move, and ever more that sleep",
            .xLabel = "balls asleep",
            .yLabel = "µs a tick",
            .yFromZero = true};
  plot.series = {{"measured", Stroke::kLineAndPoints, {}}, {"the ten alone", Stroke::kDashed, {}}};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double time = fastest[i].Read() / kPeriod * 1e6;
    plot.series[0].points.push_back({static_cast<double>(counts[i]), time});
    plot.series[1].points.push_back({static_cast<double>(counts[i]), fastest[0].Read() / kPeriod * 1e6});
    bench.results.rows.push_back({{"experiment", "asleep"},
                                  {"awake", kAwake},
                                  {"asleep", counts[i]},
                                  {"us_per_tick", time},
                                  {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
  }
  bench.results.plots.push_back(std::move(plot));
  const double ratio = fastest.back().Read() / fastest.front().Read();
  bench.results.AddFigureAtMost("asleep_ratio", isRight ? ratio : std::numeric_limits<double>::quiet_NaN(), 1.15);
}

}  // namespace wobble::bench
