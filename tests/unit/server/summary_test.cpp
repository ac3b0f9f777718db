// The JSON that --summary writes, and the histogram of tick times.
#include "server/summary.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "protocol/version.h"
#include "tests/support/game.h"

namespace wobble::server {
namespace {

TEST(Summary, HasEveryKeyWithATrueValue) {
  test::Game game(test::MakeYard());
  game.AddClient();
  game.AddClient();
  game.Run(3);
  game.clients[1]->Leave(game.now);
  game.turnaways[static_cast<std::size_t>(transport::Turnaway::kPassword)].count = 7;
  game.turnaways[static_cast<std::size_t>(transport::Turnaway::kBanned)].count = 2;
  game.Run(1);
  TickTimes times(0.016);
  for (int i = 0; i < 200; ++i) times.Record(i == 7 ? 0.020 : 0.002);

  const auto json = nlohmann::json::parse(MakeSummary(game.server, times));
  ASSERT_TRUE(json.is_object());
  for (const char* key : {"version",
                          "ticks",
                          "tick_ms_p50",
                          "tick_ms_p99",
                          "tick_ms_max",
                          "overruns",
                          "bodies",
                          "awake_mean",
                          "clients_peak",
                          "joins",
                          "disconnects",
                          "bytes_out",
                          "bits_per_vertex",
                          "snapshot_error_rms",
                          "inputs_starved_share",
                          "non_finite",
                          "inverted",
                          "quarantined",
                          "reset",
                          "torn",
                          "paused_s",
                          "state_hash"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_FALSE(json[key].is_null()) << key;
  }
  for (const auto& [key, value] : json.items()) EXPECT_FALSE(value.is_structured()) << key;  // flat

  EXPECT_EQ(json["version"], kVersion);
  EXPECT_EQ(json["ticks"], game.server.World().Tick());
  EXPECT_NEAR(json["ticks"].get<double>(), 240, 4);
  EXPECT_NEAR(json["tick_ms_p50"].get<double>(), 2.0, 0.011);
  EXPECT_NEAR(json["tick_ms_p99"].get<double>(), 2.0, 0.011);
  EXPECT_NEAR(json["tick_ms_max"].get<double>(), 20, 1e-9);
  EXPECT_EQ(json["overruns"], 1);
  EXPECT_EQ(json["refusals"], 9);
  EXPECT_EQ(json["bodies"], 2);  // the ball and the one player left
  EXPECT_GT(json["awake_mean"].get<double>(), 2);
  EXPECT_LT(json["awake_mean"].get<double>(), 3);
  EXPECT_EQ(json["clients_peak"], 2);
  EXPECT_EQ(json["joins"], 2);
  EXPECT_EQ(json["disconnects"], 0);
  EXPECT_GT(json["bytes_out"].get<double>(), 10000);
  EXPECT_GT(json["bits_per_vertex"].get<double>(), 3);
  EXPECT_GT(json["snapshot_error_rms"].get<double>(), 0.01);
  EXPECT_LE(json["snapshot_error_rms"].get<double>(), 0.25);
  EXPECT_EQ(json["non_finite"], 0);
  EXPECT_EQ(json["inverted"], 0);
  EXPECT_EQ(json["state_hash"].get<std::string>().size(), 16U);
}

// While nobody plays nothing is encoded, and figures per vertex are null.
TEST(Summary, AnEmptyServerInventsNoSnapshotFigures) {
  test::Game game(test::LoadShippedScene("arena"), Config{});
  game.Run(1);
  const auto json = nlohmann::json::parse(MakeSummary(game.server, TickTimes(1)));
  EXPECT_TRUE(json["bits_per_vertex"].is_null());
  EXPECT_TRUE(json["snapshot_error_rms"].is_null());
  EXPECT_GT(json["ticks"], 50);
}

TEST(Summary, TheHashIsTheWorlds) {
  const auto hash = [](std::uint64_t seed, double seconds) {
    Config config;
    config.seed = seed;
    test::Game game(test::LoadShippedScene("arena"), config);
    game.Run(seconds);
    return nlohmann::json::parse(MakeSummary(game.server, TickTimes(1)))["state_hash"].get<std::string>();
  };
  const std::string first = hash(1, 0.2);
  EXPECT_EQ(hash(1, 0.2), first);
  EXPECT_NE(hash(2, 0.2), first);
  EXPECT_NE(hash(1, 0.3), first);
}

TEST(Summary, StatusIsOneLine) {
  test::Game game(test::MakeYard());
  game.Run(1);
  const std::string line = MakeStatusLine(game.server, TickTimes(1), 1, 125000);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_NE(line.find("1000 kbit/s"), std::string::npos);
}

TEST(TickTimes, PercentilesAreThoseOfTheDurations) {
  TickTimes times(0.05);
  EXPECT_EQ(times.PercentileMs(0.5), 0);
  for (int i = 1; i <= 1000; ++i) times.Record(i * 1e-4);  // 0.1 to 100 ms, evenly
  EXPECT_NEAR(times.PercentileMs(0.5), 50, 0.2);
  EXPECT_NEAR(times.PercentileMs(0.99), 99, 0.2);
  EXPECT_NEAR(times.MaxMs(), 100, 1e-9);
  EXPECT_NEAR(static_cast<double>(times.Overruns()), 500, 1);
  times.Record(5);  // beyond the last bin
  EXPECT_NEAR(times.MaxMs(), 5000, 1e-6);
  EXPECT_LE(times.PercentileMs(1), 5000);
}

}  // namespace
}  // namespace wobble::server
