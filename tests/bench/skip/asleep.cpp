// A thousand balls that sleep beside ten whose gas swells and shrinks, against the ten alone: whole ticks of the server
// with a client that watches, from what comes in to what is sent. The two servers take turns tick by tick, and of each
// period of the ten, in which both have the same work, the fastest counts.
#include "client/client.h"
#include "protocol/transport/virtual_network.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "tests/bench/skip/experiments.h"
#include "tests/bench/throughput/peak.h"

namespace wobble::bench {
namespace {

constexpr int kTickHz = 60;
constexpr int kPeriod = kTickHz;  // of what keeps the ten awake, ticks
constexpr int kAwake = 10;
constexpr int kAsleep = 1000;
constexpr double kMostSeconds = 20;  // that falling asleep may take

std::string DescribeScene(int asleep) {
  std::string text = R"(
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
position = [0, -10, 0.6]
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

// A server and one who watches, on virtual time.
class Watched {
 public:
  explicit Watched(int asleep)
      : m_network(transport::VirtualNetworkOptions{}),
        m_server({.tickHz = kTickHz}, scenes::ParseScene(DescribeScene(asleep), "skip").scene, m_network.MakeServer(),
                 0),
        m_client(m_network.MakeClient(), {.spectator = true}, 0) {}

  // One tick, and what the server took for it, s.
  double Step() {
    const double now = m_server.NextTick();
    const double began = ReadThreadTime();
    m_server.Tick(now);
    const double time = ReadThreadTime() - began;
    m_client.Update(now);
    return time;
  }
  [[nodiscard]] int CountAwake() const {
    int count = 0;
    for (const physics::Body& body : m_server.World().Bodies()) count += body.asleep ? 0 : 1;
    return count;
  }
  [[nodiscard]] bool HasClient() const { return m_client.ReadState() == client::State::kPlaying; }

 private:
  transport::VirtualNetwork m_network;
  server::Server m_server;
  client::Client m_client;
};

}  // namespace

void MeasureAsleep(Bench& bench) {
  Watched few(0);
  Watched many(kAsleep);
  for (int tick = 0; tick < kMostSeconds * kTickHz && many.CountAwake() > kAwake; ++tick) {
    if (bench.progress.IsStopAsked()) return;
    few.Step();
    many.Step();
  }
  // Clients learn where sleepers are, and then no more.
  for (int tick = 0; tick < 5 * kPeriod; ++tick) {
    few.Step();
    many.Step();
  }
  const bool isRight = few.HasClient() && many.HasClient() && few.CountAwake() == kAwake && many.CountAwake() == kAwake;
  Fastest ofFew;
  Fastest ofMany;
  Peak peak;
  const int periods = bench.options.quick ? 10 : 60;
  for (int period = 0; period < periods && !bench.progress.IsStopAsked(); ++period) {
    double times[2] = {0, 0};
    for (int tick = 0; tick < kPeriod; ++tick) {
      times[0] += few.Step();
      times[1] += many.Step();
    }
    ofFew.Note(times[0] / kPeriod);
    ofMany.Note(times[1] / kPeriod);
    peak.Measure();
    bench.progress.Show(static_cast<std::size_t>(period) + 1, static_cast<std::size_t>(periods));
  }
  for (const auto& [asleep, time] : {std::pair(0, ofFew.Read()), std::pair(kAsleep, ofMany.Read())}) {
    bench.results.rows.push_back({{"experiment", "asleep"},
                                  {"awake", kAwake},
                                  {"asleep", asleep},
                                  {"us_per_tick", time * 1e6},
                                  {"peak_gflops", peak.FlopsPerSecond() / 1e9}});
  }
  bench.results.AddFigureAtMost(
      "asleep_ratio", isRight ? ofMany.Read() / ofFew.Read() : std::numeric_limits<double>::quiet_NaN(), 1.15);
}

}  // namespace wobble::bench
