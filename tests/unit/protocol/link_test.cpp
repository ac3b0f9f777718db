// The text form of link conditions, and the fate of datagrams under each: within statistics and the same for a seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "protocol/transport/link_conditions.h"
#include "protocol/transport/link_emulation.h"

namespace wobble::transport {
namespace {

constexpr int kCount = 20000;
// Of a share of 5 % among so many, five standard deviations are 0.0077; of 20 %, 0.0142; of 50 %, 0.0177.
double FiveDeviations(double share) { return 5 * std::sqrt(share * (1 - share) / kCount); }

std::vector<Fate> DecideAll(const LinkConditions& conditions, std::uint64_t seed, double interval = 0.001) {
  LinkDirection direction(seed);
  std::vector<Fate> fates;
  for (int i = 0; i < kCount; ++i) fates.push_back(direction.Decide(conditions, i * interval, 200));
  return fates;
}

double ShareOf(const std::vector<Fate>& fates, Fate::Ending ending) {
  const auto count = std::count_if(fates.begin(), fates.end(), [&](const Fate& f) { return f.ending == ending; });
  return static_cast<double>(count) / static_cast<double>(fates.size());
}

TEST(LinkSpec, EveryWordIsUnderstood) {
  std::string error;
  const auto spec = ParseLinkSpec(
      "loss=5%,delay=50ms, jitter=0.02s,duplicate=1%,reorder=2.5%,rate=512kbit,blackout=250ms/15s", error);
  ASSERT_TRUE(spec.has_value()) << error;
  for (const LinkConditions& way : {spec->up, spec->down}) {
    EXPECT_DOUBLE_EQ(way.loss, 0.05);
    EXPECT_DOUBLE_EQ(way.delay, 0.05);
    EXPECT_DOUBLE_EQ(way.jitter, 0.02);
    EXPECT_DOUBLE_EQ(way.duplicate, 0.01);
    EXPECT_DOUBLE_EQ(way.reorder, 0.025);
    EXPECT_DOUBLE_EQ(way.rate, 512e3);
    EXPECT_DOUBLE_EQ(way.blackout.length, 0.25);
    EXPECT_DOUBLE_EQ(way.blackout.period, 15);
    EXPECT_TRUE(ValidateLinkConditions(way).empty());
  }
  ASSERT_TRUE(ParseLinkSpec("", error).has_value());
  EXPECT_EQ(ParseLinkSpec("", error)->up.loss, 0);
}

TEST(LinkSpec, OneDirectionCountsBeforeBothInAnyOrder) {
  std::string error;
  for (const char* text : {"loss=5%,up.loss=7%,down.rate=2mbit", "down.rate=2mbit,up.loss=7%,loss=5%"}) {
    const auto spec = ParseLinkSpec(text, error);
    ASSERT_TRUE(spec.has_value()) << error;
    EXPECT_DOUBLE_EQ(spec->up.loss, 0.07);
    EXPECT_DOUBLE_EQ(spec->down.loss, 0.05);
    EXPECT_DOUBLE_EQ(spec->up.rate, 0);
    EXPECT_DOUBLE_EQ(spec->down.rate, 2e6);
  }
}

TEST(LinkSpec, WhatIsWrongIsNamedWithWhatIsAllowed) {
  struct Case {
    const char* text;
    const char* error;
  };
  const Case cases[] = {
      {"loss=120%", "loss=120%: must be 0% to 100%"},       {"loss=5", "loss=5: must be 0% to 100%"},
      {"loss=-1%", "loss=-1%: must be 0% to 100%"},         {"loss=nan%", "loss=nan%: must be 0% to 100%"},
      {"loss=1.2.3%", "loss=1.2.3%: must be 0% to 100%"},   {"loss", "loss=: must be 0% to 100%"},
      {"delay=50", "delay=50: must be 0ms to 10s"},         {"up.delay=11s", "up.delay=11s: must be 0ms to 10s"},
      {"jitter=1h", "jitter=1h: must be 0ms to 10s"},       {"rate=0kbit", "rate=0kbit: must be 1kbit to 10000mbit"},
      {"rate=512", "rate=512: must be 1kbit to 10000mbit"}, {"loss=1%,delay=1s,loss=2%", "loss is given twice"},
  };
  for (const Case& each : cases) {
    std::string error;
    EXPECT_FALSE(ParseLinkSpec(each.text, error).has_value()) << each.text;
    EXPECT_EQ(error, each.error);
  }
  for (const char* text : {"blackout=1s", "blackout=15s/250ms", "blackout=1s/1s", "blackout=61s/90s",
                           "blackout=1ms/2ms", "blackout=/", "blackout=0s/0s", "blackout=1s/2h"}) {
    std::string error;
    EXPECT_FALSE(ParseLinkSpec(text, error).has_value()) << text;
    EXPECT_EQ(error.rfind(std::string(text) + ": must be LENGTH/PERIOD such as 250ms/15s", 0), 0u) << error;
  }
  for (const char* text : {"los=5%", "loss=5%,", ",", "=", "sideways.loss=5%", "up.=1%"}) {
    std::string error;
    EXPECT_FALSE(ParseLinkSpec(text, error).has_value()) << text;
    EXPECT_NE(error.find("is not known: must be loss, delay, jitter, "), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(LinkSpec, BadRatesAndBlackoutsAreNamed) {
  EXPECT_EQ(ValidateLinkConditions({.rate = 10}).size(), 1u);
  EXPECT_EQ(ValidateLinkConditions({.blackout = {2, 1}}).size(), 1u);
  EXPECT_EQ(ValidateLinkConditions({.blackout = {std::nan(""), 1}}).size(), 1u);
}

TEST(LinkDirection, NothingAskedForNothingHappens) {
  for (const Fate& fate : DecideAll({}, 1)) {
    ASSERT_EQ(fate.ending, Fate::Ending::kPasses);
    ASSERT_EQ(fate.copies, 1u);
  }
  LinkDirection direction(1);
  EXPECT_EQ(direction.Decide({}, 12.5, 1000).due[0], 12.5);
}

TEST(LinkDirection, LosesDoublesAndHoldsBackTheSharesAskedFor) {
  const LinkConditions conditions{.loss = 0.2, .delay = 0.1, .duplicate = 0.05, .reorder = 0.5};
  const auto fates = DecideAll(conditions, 11);
  EXPECT_NEAR(ShareOf(fates, Fate::Ending::kLost), 0.2, FiveDeviations(0.2));
  double passed = 0, doubled = 0, heldBack = 0;
  for (const Fate& fate : fates) {
    passed += fate.copies > 0 ? 1 : 0;
    doubled += fate.copies == 2 ? 1 : 0;
    heldBack += fate.isHeldBack ? 1 : 0;
  }
  EXPECT_NEAR(doubled / passed, 0.05, FiveDeviations(0.05) / 0.9);
  EXPECT_NEAR(heldBack / passed, 0.5, FiveDeviations(0.5) / 0.9);
}

TEST(LinkDirection, DelaysAreUniformFromDelayToDelayAndJitter) {
  const LinkConditions conditions{.delay = 0.05, .jitter = 0.02, .duplicate = 0.1};
  const auto fates = DecideAll(conditions, 12);
  double sum = 0, copies = 0;
  for (std::size_t i = 0; i < fates.size(); ++i) {
    for (std::size_t copy = 0; copy < fates[i].copies; ++copy) {
      const double trip = fates[i].due[copy] - static_cast<double>(i) * 0.001;
      ASSERT_GE(trip, 0.05 - 1e-9);
      ASSERT_LE(trip, 0.07 + 1e-9);
      sum += trip;
      ++copies;
    }
  }
  EXPECT_NEAR(sum / copies, 0.06, 5 * 0.02 / std::sqrt(12.0 * kCount));
}

TEST(LinkDirection, MoreLossLosesASupersetAndTheRestFaresTheSame) {
  const auto few = DecideAll({.loss = 0.1, .delay = 0.05, .jitter = 0.05}, 5);
  const auto many = DecideAll({.loss = 0.3, .delay = 0.05, .jitter = 0.05, .duplicate = 0.2}, 5);
  for (std::size_t i = 0; i < few.size(); ++i) {
    ASSERT_LE(std::min<std::size_t>(many[i].copies, 1), few[i].copies);
    ASSERT_EQ(many[i].copies == 1 ? many[i].due[0] : few[i].due[0], few[i].due[0]);
  }
}

TEST(LinkDirection, SameSeedSameFatesOtherSeedOthersAndDirectionsHaveNothingInCommon) {
  const LinkConditions conditions{.loss = 0.5};
  const auto same = [](const std::vector<Fate>& a, const std::vector<Fate>& b) {
    int equal = 0;
    for (std::size_t i = 0; i < a.size(); ++i) equal += a[i].ending == b[i].ending ? 1 : 0;
    return equal / double{kCount};
  };
  const LinkSeeds first = MakeLinkSeeds(1, 1);
  const LinkSeeds second = MakeLinkSeeds(1, 2);
  const auto up = DecideAll(conditions, first.toServer);
  EXPECT_EQ(same(up, DecideAll(conditions, first.toServer)), 1);
  EXPECT_NEAR(same(up, DecideAll(conditions, first.toClient)), 0.5, FiveDeviations(0.5));
  EXPECT_NEAR(same(up, DecideAll(conditions, second.toServer)), 0.5, FiveDeviations(0.5));
  EXPECT_NEAR(same(up, DecideAll(conditions, MakeLinkSeeds(2, 1).toServer)), 0.5, FiveDeviations(0.5));
}

// 200 + 28 bytes are 1,824 bits: at 182,400 bit/s one takes 10 ms.
TEST(LinkDirection, LimitedRateSpacesDatagramsAndDropsTheTail) {
  const LinkConditions conditions{.delay = 0.1, .rate = 182400};
  LinkDirection direction(1);
  int passed = 0;
  for (int i = 0; i < 100; ++i) {  // a burst at one moment: 250 ms of it are queued
    const Fate fate = direction.Decide(conditions, 5, 200);
    if (fate.ending == Fate::Ending::kOverRate) continue;
    ++passed;
    EXPECT_NEAR(fate.due[0], 5 + 0.1 + 0.01 * passed, 1e-9);
  }
  EXPECT_NEAR(passed, 25, 1);
  EXPECT_NEAR(direction.Decide(conditions, 6, 200).due[0], 6.11, 1e-9);  // the queue is empty again

  const auto fates = DecideAll(conditions, 3, 0.005);  // twice what the rate allows
  EXPECT_NEAR(ShareOf(fates, Fate::Ending::kOverRate), 0.5, 0.002);
  const auto slower = DecideAll(conditions, 3, 0.011);
  EXPECT_EQ(ShareOf(slower, Fate::Ending::kOverRate), 0);
}

TEST(LinkDirection, ASlowRateStillTakesAFullDatagram) {
  LinkDirection direction(1);
  const Fate fate = direction.Decide({.rate = kMinRate}, 0, 1200);
  ASSERT_EQ(fate.copies, 1u);
  EXPECT_NEAR(fate.due[0], 9.824, 1e-9);
}

TEST(LinkDirection, BlackoutTakesWhatEntersOrWouldComeOutAndKeepsNothing) {
  const LinkConditions conditions{.delay = 0.3, .blackout = {1, 4}};  // black from 3 to 4, 7 to 8, ...
  LinkDirection direction(1);
  for (double now = 0; now < 40; now += 0.01) {
    const Fate fate = direction.Decide(conditions, now, 200);
    const double into = std::fmod(now, 4);
    if (std::abs(into - 2.7) < 1e-6 || into > 4 - 1e-6) continue;  // rounding decides
    ASSERT_EQ(fate.ending, into < 2.7 ? Fate::Ending::kPasses : Fate::Ending::kBlackedOut) << now;
    ASSERT_NEAR(fate.copies > 0 ? fate.due[0] : now + 0.3, now + 0.3, 1e-9);
  }
  EXPECT_FALSE(IsBlack({}, 1));
}

}  // namespace
}  // namespace wobble::transport
