// The figures of a load test: percentiles within the documented error, thresholds that hold or fail as written, and a
// summary with exactly the documented keys.
#include "client/bots/summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "client/bots/histogram.h"
#include "protocol/version.h"

namespace wobble::bots {
namespace {

double FindExactPercentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::max(1.0, std::ceil(share * static_cast<double>(values.size()))));
  return values[rank - 1];
}

TEST(Histogram, PercentilesAreWithinTheBoundOverNineOrdersOfMagnitude) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(std::log(Histogram::kSmallest), std::log(Histogram::kLargest));
  Histogram histogram;
  std::vector<double> values;
  for (int i = 0; i < 20'000; ++i) {
    values.push_back(std::exp(exponent(random)));
    histogram.Add(values.back());
  }
  for (double share = 0; share <= 1.0; share += 0.001) {
    const double exact = FindExactPercentile(values, share);
    EXPECT_NEAR(histogram.FindPercentile(share).value(), exact, exact * Histogram::kRelativeError * 1.0001) << share;
  }
}

TEST(Histogram, EndsAreExact) {
  Histogram histogram;
  EXPECT_FALSE(histogram.FindPercentile(0.5).has_value());
  histogram.Add(17.3);
  EXPECT_EQ(histogram.FindPercentile(0.5), 17.3);
  histogram.Add(-4);
  EXPECT_EQ(histogram.FindPercentile(0), 0);
  histogram.Add(1e300);
  EXPECT_EQ(histogram.FindPercentile(1), Histogram::kLargest);
  histogram.Add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(histogram.Count(), 3U);
  // Powers of two are edges of buckets.
  Histogram edges;
  edges.Add(2);
  edges.Add(4);
  edges.Add(4);
  EXPECT_NEAR(edges.FindPercentile(0.5).value(), 4, 4 * Histogram::kRelativeError);
}

Figures MakeFigures() {
  Figures figures;
  figures.bots = 4;
  figures.connected = 4;
  figures.snapshots = 100;
  figures.snapshotAgeMsP99 = 42.5;
  figures.lateMsP99 = 0.1;
  return figures;
}

bool Judge(const std::string& rule) {
  std::string error;
  const auto threshold = ParseThreshold(rule, error);
  EXPECT_TRUE(threshold.has_value()) << error;
  return threshold && JudgeThresholds({*threshold}, MakeFigures()).at(0).ok;
}

TEST(Threshold, EveryComparisonHoldsAndFailsWhereItShould) {
  EXPECT_TRUE(Judge("disconnects==0"));
  EXPECT_FALSE(Judge("connected==0"));
  EXPECT_TRUE(Judge("connected != 3"));
  EXPECT_FALSE(Judge("connected!=4"));
  EXPECT_TRUE(Judge("snapshot_age_ms_p99<150"));
  EXPECT_FALSE(Judge("snapshot_age_ms_p99<42.5"));
  EXPECT_TRUE(Judge("snapshot_age_ms_p99 <= 42.5"));
  EXPECT_FALSE(Judge("snapshot_age_ms_p99<=42.4"));
  EXPECT_TRUE(Judge(" bots > 3 "));
  EXPECT_FALSE(Judge("bots>4"));
  EXPECT_TRUE(Judge("bots>=4"));
  EXPECT_FALSE(Judge("bots>=4.5e0"));
}

TEST(Threshold, AFigureThatDoesNotExistHoldsNoRule) {
  EXPECT_FALSE(Judge("snapshot_age_ms_p50<1000"));
  EXPECT_FALSE(Judge("snapshot_age_ms_p50>=0"));
  EXPECT_FALSE(Judge("snapshot_age_ms_p50!=3"));
}

TEST(Threshold, BadRulesAreRefusedInOneLineThatNamesThem) {
  for (const char* rule :
       {"", "disconnects", "disconnects=0", "disconnects=<0", "disconnects==", "disconnects==none", "disconnects==0x",
        "disconnects==nan", "disconnects==0 ==0", "==0", "thresholds==0", "valid==1", "disconnects!0"}) {
    std::string error;
    EXPECT_FALSE(ParseThreshold(rule, error).has_value()) << rule;
    EXPECT_EQ(error.find("'" + std::string(rule) + "': "), 0U) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  std::string error;
  EXPECT_FALSE(ParseThreshold("snapshot_age<1", error).has_value());
  for (const NamedFigure& figure : ListFigures({})) EXPECT_NE(error.find(figure.key), std::string::npos) << error;
}

TEST(Summary, HasItsKeysInOrderAndNullWhereNothingWasMeasured) {
  std::string error;
  const auto rule = ParseThreshold("snapshot_age_ms_p99<40", error);
  const Figures figures = MakeFigures();
  const auto summary = nlohmann::ordered_json::parse(MakeSummary(figures, JudgeThresholds({*rule}, figures)));
  std::vector<std::string> keys;
  for (const auto& item : summary.items()) keys.push_back(item.key());
  EXPECT_EQ(keys, (std::vector<std::string>{"version",
                                            "bots",
                                            "connected",
                                            "joins",
                                            "join_ms_p99",
                                            "disconnects",
                                            "sent_away",
                                            "rejoins",
                                            "rejoin_ms_p99",
                                            "snapshots",
                                            "snapshot_age_ms_p50",
                                            "snapshot_age_ms_p99",
                                            "input_to_snapshot_ms_p50",
                                            "stalls",
                                            "kbit_per_s_per_bot",
                                            "decode_us_p99",
                                            "late_ms_p99",
                                            "script_errors",
                                            "valid",
                                            "thresholds"}));
  EXPECT_EQ(summary["version"], kVersion);
  EXPECT_TRUE(summary["join_ms_p99"].is_null());
  EXPECT_EQ(summary["bots"].dump(), "4");
  EXPECT_EQ(summary["snapshot_age_ms_p99"], 42.5);
  EXPECT_EQ(summary["valid"], true);
  EXPECT_EQ(summary["thresholds"].dump(), R"([{"rule":"snapshot_age_ms_p99<40","value":42.5,"ok":false}])");
}

TEST(Summary, ALateGeneratorIsNotValid) {
  Figures figures = MakeFigures();
  figures.lateMsP99 = 1.01;
  EXPECT_FALSE(IsValid(figures));
  EXPECT_NE(MakeSummary(figures, {}).find("\"valid\": false"), std::string::npos);
}

}  // namespace
}  // namespace wobble::bots
