// What a server publishes: figures, Prometheus metrics, the endpoint over a real socket, the trace.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "server/ops/endpoint.h"
#include "server/ops/metrics.h"
#include "server/ops/trace.h"
#include "tests/support/game.h"

// After Eigen, because it defines macros with names of Eigen.
#include <httplib.h>

namespace wobble::ops {
namespace {

using testing::HasSubstr;

std::filesystem::path MakeFile(const std::string& name) {
  return std::filesystem::temp_directory_path() / (name + std::to_string(getpid()));
}

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The value of a series; fails the test when there is none.
double ReadSeries(const std::string& metrics, const std::string& series) {
  std::istringstream lines(metrics);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(series + " ", 0) == 0) return std::stod(line.substr(series.size() + 1));
  }
  ADD_FAILURE() << "no series " << series;
  return -1;
}

// A game whose clock advances by a millisecond each time that it is read.
struct WatchedGame {
  explicit WatchedGame(scenes::Scene scene = test::MakeYard())
      : game(std::move(scene), config, 1, [this] { return m_time += 0.001; }), gauge(config) {}
  void Run(double seconds) {
    for (const double end = game.now + seconds; game.now < end;) {
      game.Step();
      gauge.Read(game.server, game.now);
    }
  }
  [[nodiscard]] std::string Write() const { return WriteMetrics(gauge.ReadFigures(), "1.2.3", "yard"); }

  server::Config config;
  test::Game game;
  Gauge gauge;

 private:
  double m_time = 0;
};

TEST(Metrics, SayWhatTheServerDoes) {
  WatchedGame watched;
  watched.game.AddClient();
  watched.game.AddClient({.name = "Eve", .spectator = true});
  auto& raw = watched.game.AddRaw();
  watched.Run(0.5);
  raw.Send(transport::Channel::kControl, {1, 2, 3});
  watched.game.turnaways[static_cast<std::size_t>(transport::Turnaway::kPassword)].count = 7;
  watched.Run(3);
  const std::string text = watched.Write();
  const auto read = [&](const std::string& series) { return ReadSeries(text, series); };
  const server::Server& server = watched.game.server;
  EXPECT_EQ(read("wobble_build_info{version=\"1.2.3\",scene=\"yard\"}"), 1);
  EXPECT_EQ(read("wobble_clients{state=\"playing\"}"), 1);
  EXPECT_EQ(read("wobble_clients{state=\"watching\"}"), 1);
  EXPECT_EQ(read("wobble_clients_limit"), 64);
  EXPECT_EQ(read("wobble_client_joins_total"), 2);
  EXPECT_EQ(read("wobble_world_ticks_total"), server.World().Tick());
  EXPECT_EQ(read("wobble_tick_duration_seconds_count"), server.World().Tick());
  EXPECT_EQ(read("wobble_tick_duration_seconds_bucket{le=\"+Inf\"}"), server.World().Tick());
  EXPECT_EQ(read("wobble_tick_duration_seconds_bucket{le=\"0.0005\"}"), 0);
  double phases = 0;
  for (const char* phase : {"receive", "step", "capture", "encode", "send"}) {
    const double sum = read("wobble_tick_phase_seconds_sum{phase=\"" + std::string(phase) + "\"}");
    EXPECT_GT(sum, 0) << phase;
    phases += sum;
  }
  EXPECT_NEAR(phases, read("wobble_tick_duration_seconds_sum"), 1e-6);
  EXPECT_EQ(read("wobble_snapshot_bytes_total"), static_cast<double>(server.ReadSendCounts().bytes));
  EXPECT_GT(read("wobble_snapshot_error_ratio_count"), 0);
  EXPECT_GT(read("wobble_snapshot_error_ratio_sum"), 0);
  EXPECT_EQ(read("wobble_messages_dropped_total{reason=\"malformed\"}"), 1);
  EXPECT_EQ(read("wobble_client_goodbyes_total{reason=\"no_hello\"}"), 1) << "the raw one said none for 3 s";
  EXPECT_EQ(read("wobble_client_refusals_total{reason=\"wrong_password\"}"), 7);
  EXPECT_EQ(read("wobble_client_refusals_total{reason=\"banned\"}"), 0);
  for (const char* kind : {"challenge", "info", "players", "rules"}) {
    EXPECT_EQ(read("wobble_queries_total{kind=\"" + std::string(kind) + "\"}"), 0);
  }
  EXPECT_EQ(read("wobble_bodies{state=\"awake\"}") + read("wobble_bodies{state=\"asleep\"}"), 2);
  EXPECT_GT(read("wobble_substeps_per_body_tick_sum"), read("wobble_substeps_per_body_tick_count"));
  EXPECT_GT(read("wobble_world_energy_joules{kind=\"gravity\"}"), 0);
  EXPECT_EQ(read("wobble_time_ratio"), 1);
}

TEST(Metrics, CountTheTicksOnWhichNoInputHadCome) {
  WatchedGame watched;
  static_cast<void>(watched.game.AddClient());
  watched.Run(2);
  EXPECT_EQ(ReadSeries(watched.Write(), "wobble_client_inputs_starved_total"), 0);
  watched.game.network.SetConditions({.loss = 1}, {});
  watched.Run(1);
  EXPECT_NEAR(ReadSeries(watched.Write(), "wobble_client_inputs_starved_total"), 60 * (1 - protocol::kInputHold), 5);
}

TEST(Metrics, CountWhatClientsTellOfStallsAndLosses) {
  WatchedGame watched;
  auto& client = watched.game.AddClient();
  std::vector<client::BodySample> samples;
  const auto look = [&](double seconds) {
    for (int i = 0; i < seconds * 20; ++i) {
      watched.Run(0.05);
      client.SetInput({.moveX = 1, .jump = i % 8 == 0});
      client.Sample(watched.game.now, client::Detail::kVertices, samples);
    }
  };
  look(2);
  EXPECT_EQ(ReadSeries(watched.Write(), "wobble_client_stalls_total"), 0);
  watched.game.network.SetConditions({}, {.loss = 0.6});
  look(12);
  const std::string text = watched.Write();
  EXPECT_GT(client.ReadStatistics().stalls, 0U);
  EXPECT_NEAR(ReadSeries(text, "wobble_client_stalls_total"), static_cast<double>(client.ReadStatistics().stalls), 1);
  const double sent = ReadSeries(text, "wobble_snapshot_packets_total");
  EXPECT_GT(ReadSeries(text, "wobble_snapshot_packets_lost_total"), 0.3 * sent);
  EXPECT_LT(ReadSeries(text, "wobble_snapshot_packets_lost_total"), 0.7 * sent);
}

TEST(Metrics, PromtoolAcceptsThem) {
  WatchedGame watched(test::LoadShippedScene("arena"));
  watched.game.AddClient();
  watched.Run(1);
  const std::filesystem::path path = MakeFile("wobble_metrics");
  std::ofstream(path) << watched.Write();
  FILE* tool = popen(("promtool check metrics < '" + path.string() + "' 2>&1").c_str(), "r");
  ASSERT_NE(tool, nullptr);
  std::string said(4096, '\0');
  said.resize(std::fread(said.data(), 1, said.size(), tool));
  EXPECT_EQ(pclose(tool), 0) << said;
  EXPECT_EQ(said, "");
  std::filesystem::remove(path);
}

TEST(Metrics, NoSeriesNamesAClient) {
  WatchedGame watched;
  watched.game.AddClient({.name = "Ada"});
  watched.Run(1);
  const std::size_t one = std::ranges::count(watched.Write(), '\n');
  for (int i = 0; i < 20; ++i) watched.game.AddClient({.name = "Ada"});
  watched.Run(1);
  EXPECT_EQ(std::ranges::count(watched.Write(), '\n'), one);
  EXPECT_THAT(watched.Write(), testing::Not(HasSubstr("Ada")));
}

TEST(EnergyRound, SeesEveryBodyOnceASecond) {
  WatchedGame watched(test::LoadShippedScene("arena"));
  watched.Run(2);
  const physics::World& world = watched.game.server.World();
  physics::Energy sum;
  std::vector<physics::Vector3d> scratch;
  for (const physics::Body& body : world.Bodies()) sum += ComputeEnergy(world, body, scratch);
  EnergyRound round;
  int calls = 1;
  while (!round.Advance(world, 4)) ++calls;
  EXPECT_LE(calls, 4);
  EXPECT_EQ(round.Last().springs, sum.springs);
  EXPECT_EQ(round.Last().gravity, sum.gravity);
}

TEST(OpsAddress, IsAHostAndAPort) {
  Address address;
  std::string error;
  ASSERT_TRUE(ParseAddress("9100", address, error));
  EXPECT_EQ(address.host + " " + std::to_string(address.port), "127.0.0.1 9100");
  ASSERT_TRUE(ParseAddress("0.0.0.0:80", address, error));
  EXPECT_EQ(address.host + " " + std::to_string(address.port), "0.0.0.0 80");
  ASSERT_TRUE(ParseAddress("[::1]:81", address, error));
  EXPECT_EQ(address.host + " " + std::to_string(address.port), "::1 81");
  ASSERT_TRUE(ParseAddress("localhost:0", address, error));
  EXPECT_EQ(address.host + " " + std::to_string(address.port), "localhost 0");
  for (const char* bad : {"", ":", "host:", "host:65536", "host:9x", ":9", ":0", "-1"}) {
    EXPECT_FALSE(ParseAddress(bad, address, error)) << bad;
    EXPECT_THAT(error, HasSubstr("0 to 65535"));
  }
}

// An endpoint on a free port, with a clock that the test sets.
class EndpointTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    endpoint = Endpoint::Listen(
        address, "1.2.3", "yard", [this] { return now.load(); }, error);
    ASSERT_NE(endpoint, nullptr) << error;
    address.port = endpoint->ReadPort();
    ASSERT_NE(address.port, 0);
  }
  [[nodiscard]] std::string Get(const std::string& path, int status) const {
    httplib::Client client(address.host, address.port);
    const auto result = client.Get(path);
    EXPECT_TRUE(result) << path;
    if (!result) return "";
    EXPECT_EQ(result->status, status) << path << ": " << result->body;
    return result->body;
  }

  Address address;
  std::atomic<double> now = 100;
  std::unique_ptr<Endpoint> endpoint;
};

TEST_F(EndpointTest, TellsWhetherTheTickLoopIsAlive) {
  EXPECT_EQ(Get("/healthz", 503), "starting\n");
  Figures figures;
  figures.condition = Condition::kReady;
  figures.told = 100;
  endpoint->Tell(figures);
  EXPECT_EQ(Get("/healthz", 200), "ok\n");
  now = 104.5;
  EXPECT_EQ(Get("/healthz", 503), "no tick for 4.5 s\n");
  figures.told = 104.5;
  figures.isPaused = true;
  endpoint->Tell(figures);
  EXPECT_EQ(Get("/healthz", 200), "ok, the world waits for players\n");
}

TEST_F(EndpointTest, TellsWhetherJoinsAreAccepted) {
  EXPECT_EQ(Get("/readyz", 503), "starting\n");
  Figures figures;
  for (const auto& [condition, words] :
       {std::pair{Condition::kFull, "full\n"}, {Condition::kBusy, "busy\n"}, {Condition::kClosing, "closing\n"}}) {
    figures.condition = condition;
    endpoint->Tell(figures);
    EXPECT_EQ(Get("/readyz", 503), words);
  }
  figures.condition = Condition::kReady;
  endpoint->Tell(figures);
  EXPECT_EQ(Get("/readyz", 200), "ready\n");
}

TEST_F(EndpointTest, ServesMetricsAndNothingElse) {
  EXPECT_THAT(Get("/metrics", 200), HasSubstr("wobble_build_info{version=\"1.2.3\",scene=\"yard\"} 1"));
  (void)Get("/../etc/passwd", 404);
  (void)Get("/metrics/x", 404);
  httplib::Client client(address.host, address.port);
  const auto posted = client.Post("/metrics", std::string(100000, 'x'), "text/plain");
  EXPECT_TRUE(!posted || posted->status >= 400);
  EXPECT_THAT(Get("/", 200), HasSubstr("/healthz")) << "and it lives";
}

TEST_F(EndpointTest, AClientThatDawdlesHoldsUpNobody) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(address.port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  ASSERT_EQ(::write(socket, "GET /met", 8), 8);
  EXPECT_EQ(Get("/readyz", 503), "starting\n");
  ::close(socket);
}

TEST_F(EndpointTest, APortThatIsTakenIsSaid) {
  std::string error;
  EXPECT_EQ(Endpoint::Listen(
                address, "", "", [] { return 0.0; }, error),
            nullptr);
  EXPECT_THAT(error, HasSubstr("127.0.0.1:" + std::to_string(address.port)));
}

TEST(Trace, HasEveryTickAndPhaseInOrder) {
  const std::filesystem::path path = MakeFile("wobble_trace");
  Trace trace;
  ASSERT_TRUE(trace.Open(path));
  const std::vector<server::PhaseTimes> ticks{{1.0, {0.001, 0.002, 0, 0.003, 0.004}}, {2.0, {0, 0.005, 0, 0, 0}}};
  trace.Write(std::span(ticks).first(1), 7);
  trace.Write(std::span(ticks).last(1), 8);
  ASSERT_TRUE(trace.Close());
  const auto json = nlohmann::json::parse(ReadFile(path));
  ASSERT_EQ(json.size(), 12U);
  EXPECT_EQ(json[0]["name"], "tick");
  EXPECT_EQ(json[0]["args"]["tick"], 7);
  EXPECT_NEAR(json[0]["dur"].get<double>(), 10000, 0.1);
  EXPECT_EQ(json[1]["name"], "receive");
  EXPECT_EQ(json[4]["name"], "encode");
  EXPECT_NEAR(json[4]["ts"].get<double>(), 1003000, 0.1);
  EXPECT_EQ(json[6]["args"]["tick"], 8);
  for (const auto& event : json) EXPECT_EQ(event["ph"], "X");
  std::filesystem::remove(path);
}

TEST(Trace, SaysThatItCannotBeWritten) {
  Trace trace;
  EXPECT_FALSE(trace.Open("/nowhere/at/all.json"));
  EXPECT_FALSE(trace.Open("/dev/full"));
}

}  // namespace
}  // namespace wobble::ops
