// The command line of `wobble bots`: meaning and rejection of its values, and the status line.
#include "client/bots/options.h"

#include <gtest/gtest.h>

#include "client/bots/status.h"
#include "protocol/usage/duration.h"

namespace wobble::bots {
namespace {

TEST(LoadTestWords, AddressesAndShares) {
  std::string error;
  const auto ipv6 = command::ParseAddress("[2001:db8::1]:7777", error);
  ASSERT_TRUE(ipv6);
  EXPECT_EQ(ipv6->host, "2001:db8::1");
  EXPECT_EQ(command::Describe(*ipv6), "[2001:db8::1]:7777");
  const auto address = command::ParseAddress("example.org:7777", error);
  ASSERT_TRUE(address.has_value());
  EXPECT_EQ(address->host, "example.org");
  EXPECT_EQ(address->port, 7777);
  for (const char* text : {"", ":", ":1", "host", "host:", "host:0", "host:65536", "host:-1", "host:1x", "host: 1"}) {
    EXPECT_FALSE(command::ParseAddress(text, error).has_value()) << text;
    EXPECT_NE(error.find(std::string("'") + text + "'"), std::string::npos) << error;
  }
  for (const char* text : {"", "/", "1/", "/1", "1/0", "2/1", "-1/2", "0.5", "1/2/3", "two"}) {
    EXPECT_FALSE(ParseDecodeShare(text, error).has_value()) << text;
  }
  const auto count = [&](const char* text, unsigned bots) {
    const auto share = ParseDecodeShare(text, error);
    EXPECT_TRUE(share.has_value()) << error;
    unsigned decoding = 0;
    for (unsigned i = 0; share && i < bots; ++i) decoding += share->Includes(i) ? 1 : 0;
    return decoding;
  };
  EXPECT_EQ(count("1/32", 1), 1U);  // the first bot decodes
  EXPECT_EQ(count("1/32", 32), 1U);
  EXPECT_EQ(count("1/32", 33), 2U);
  EXPECT_EQ(count("1/32", 3200), 100U);
  EXPECT_EQ(count("2/3", 9), 6U);
  EXPECT_EQ(count("0", 100), 0U);
  EXPECT_EQ(count("1", 100), 100U);
  EXPECT_EQ(count("3/3", 7), 7U);
}

TEST(LoadTestWords, Durations) {
  std::string error;
  const auto read = [&](const char* text) { return usage::ParseDuration(text, error).value_or(-1); };
  EXPECT_EQ(read("0"), 0);
  EXPECT_EQ(read("90"), 90);
  EXPECT_EQ(read("90s"), 90);
  EXPECT_EQ(read("1.5m"), 90);
  EXPECT_EQ(read("2h"), 7200);
  EXPECT_NEAR(read("250ms"), 0.25, 1e-12);
  EXPECT_EQ(read("1000000"), usage::kMaxDuration);
  for (const char* text :
       {"", "s", "ms", "-1", "-1s", "1000001", "300h", "nan", "inf", "1 s", " 1", "1d", "1s5", "+1"}) {
    EXPECT_FALSE(usage::ParseDuration(text, error).has_value()) << text;
    EXPECT_EQ(error.find("'" + std::string(text) + "' is no duration"), 0U) << error;
  }
}

TEST(LoadTestWords, Stages) {
  std::string error;
  const auto stage = ParseStage("1.5m:200", error);
  ASSERT_TRUE(stage.has_value()) << error;
  EXPECT_EQ(stage->seconds, 90);
  EXPECT_EQ(stage->bots, 200U);
  EXPECT_TRUE(ParseStage("10s:0", error).has_value());
  EXPECT_TRUE(ParseStage("10:10000", error).has_value());
  for (const char* text :
       {"", ":", "60s", "60s:", ":5", "0:5", "0s:5", "-1s:5", "60s:-5", "60s:10001", "60s:5.5", "5:60s", "60s:5:5"}) {
    EXPECT_FALSE(ParseStage(text, error).has_value()) << text;
    EXPECT_EQ(error.find("'" + std::string(text) + "' is no stage"), 0U) << error;
    EXPECT_NE(error.find("10000 bots"), std::string::npos) << error;
  }
}

TEST(LoadTestStages, CountGoesEvenlyFromWhatItWas) {
  const std::vector<Stage> stages{{10, 5}, {10, 5}, {4, 1}, {2, 3}};
  unsigned last = 0;
  for (const auto& [seconds, bots] : std::vector<std::pair<double, unsigned>>{{0, 1},
                                                                              {1.9, 1},
                                                                              {2, 2},
                                                                              {8, 5},
                                                                              {10, 5},
                                                                              {19.9, 5},
                                                                              {20.5, 4},
                                                                              {21, 3},
                                                                              {23.5, 1},
                                                                              {24, 2},
                                                                              {25, 3},
                                                                              {99, 3}}) {
    EXPECT_EQ(CountBotsAt(stages, seconds), bots) << seconds;
    last = bots;
  }
  EXPECT_EQ(last, 3U);
  EXPECT_EQ(CountStarts(stages), 5U + 2U);
  EXPECT_EQ(FindStageAt(stages, 0), 0U);
  EXPECT_EQ(FindStageAt(stages, 10), 1U);
  EXPECT_EQ(FindStageAt(stages, 23), 2U);
  EXPECT_EQ(FindStageAt(stages, 99), 3U);

  LoadTestOptions options;
  options.count = 7;
  EXPECT_EQ(CountBotsAt(ListStages(options), 0), 7U);  // without a ramp all bots start at once
  options.ramp = 7;
  EXPECT_EQ(CountBotsAt(ListStages(options), 0), 1U);
  EXPECT_EQ(CountBotsAt(ListStages(options), 3.5), 4U);
  EXPECT_EQ(CountBotsAt(ListStages(options), 7), 7U);
  EXPECT_EQ(FindDuration(options), 0);
  options.stages = stages;
  EXPECT_EQ(FindDuration(options), 26);
}

TEST(LoadTestStatus, FitsALine) {
  Runner::Progress progress;
  EXPECT_EQ(FormatStatus(progress, {{0, 8}}, 0, 75), "bots 0/8, ? kbit/s each, age ? ms, late 0.0 ms");
  progress.playing = 998;
  progress.kbitPerSecondPerBot = 384.4;
  progress.snapshotAgeMs = 151;
  progress.lateMs = 0.44;
  EXPECT_EQ(FormatStatus(progress, {{60, 999}}, 200, 51),
            "bots 998/999 25%, 2 min left, 384 kbit/s each, age 151 ms, late 0.4 ms");
  const std::string longest = FormatStatus(progress, {{30, 200}, {60, 999}, {10, 0}}, 100, 30);
  EXPECT_EQ(longest, "bots 998/999 stage 2/3 30%, 70 s left, 384 kbit/s each, age 151 ms, late 0.4 ms");
  EXPECT_LT(longest.size(), 80U);
  EXPECT_EQ(FormatTime(119.4), "119 s");
  EXPECT_EQ(FormatTime(120), "2 min");
  EXPECT_EQ(FormatTime(7200), "2 h");
  EXPECT_EQ(FormatTime(-3), "0 s");
}

}  // namespace
}  // namespace wobble::bots
