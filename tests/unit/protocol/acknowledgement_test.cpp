// Both windows against the packets really sent and received: out of order, twice, too late, over a lossy link.
#include "protocol/acknowledgement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace wobble::protocol {
namespace {

using Arrival = ReceivedWindow::Arrival;

TEST(ReceivedWindow, StartsEmpty) {
  const ReceivedWindow window;
  EXPECT_EQ(window.Newest(), 0U);
  EXPECT_EQ(window.History(), 0U);
}

TEST(ReceivedWindow, OutOfOrderTwiceAndTooLate) {
  ReceivedWindow window;
  EXPECT_EQ(window.Record(3), Arrival::kNew);
  EXPECT_EQ(window.History(), 0U) << "nothing before the first arrival was heard of";
  EXPECT_EQ(window.Record(5), Arrival::kNew);
  EXPECT_EQ(window.History(), 0b10U);
  EXPECT_EQ(window.Record(4), Arrival::kNew);
  EXPECT_EQ(window.History(), 0b11U);
  EXPECT_EQ(window.Newest(), 5U);
  for (const std::uint32_t again : {3U, 4U, 5U}) EXPECT_EQ(window.Record(again), Arrival::kDuplicate) << again;
  EXPECT_EQ(window.Record(69), Arrival::kNew);
  EXPECT_EQ(window.History(), std::uint64_t{1} << 63) << "64 back is the oldest that is remembered";
  EXPECT_EQ(window.Record(5), Arrival::kDuplicate);
  EXPECT_EQ(window.Record(4), Arrival::kTooOld);
  EXPECT_EQ(window.Record(134), Arrival::kNew);
  EXPECT_EQ(window.History(), 0U) << "a gap of 65 forgets all";
  EXPECT_EQ(window.Record(0xFFFFFFFF), Arrival::kNew);
  EXPECT_EQ(window.Record(0xFFFFFFFE), Arrival::kNew);
  EXPECT_EQ(window.History(), 1U);
}

TEST(ReceivedWindow, AgreesWithASetOverAShuffledLink) {
  std::mt19937 random(21);
  ReceivedWindow window;
  std::set<std::uint32_t> arrived;
  for (std::uint32_t i = 1; i < 20000; ++i) {
    const std::uint32_t sequence = i + static_cast<std::uint32_t>(random() % 100);
    const bool tooOld = sequence + kAckHistory < window.Newest();
    const bool known = arrived.count(sequence) != 0;
    const Arrival expected = tooOld ? Arrival::kTooOld : known ? Arrival::kDuplicate : Arrival::kNew;
    ASSERT_EQ(window.Record(sequence), expected) << sequence << " of " << window.Newest();
    if (!tooOld) arrived.insert(sequence);
    ASSERT_EQ(window.Newest(), *arrived.rbegin());
    for (std::uint32_t bit = 0; bit < kAckHistory && bit + 1 < window.Newest(); ++bit) {
      ASSERT_EQ(window.History() >> bit & 1, arrived.count(window.Newest() - 1 - bit)) << bit;
    }
  }
}

TEST(SentWindow, MeasuresTheRoundTripOfTheNewest) {
  SentWindow window;
  EXPECT_EQ(window.RecordSent(1.0), 1U);
  EXPECT_EQ(window.RecordSent(1.1), 2U);
  EXPECT_EQ(window.RecordSent(1.2), 3U);
  SentWindow::Report report;
  ASSERT_TRUE(window.RecordAcknowledgement(2, 0, 1.35, report));
  EXPECT_EQ(report.acknowledged, 1U);
  EXPECT_NEAR(report.roundTrip, 0.25, 1e-12);
  ASSERT_TRUE(window.RecordAcknowledgement(2, 1, 1.5, report));
  EXPECT_EQ(report.acknowledged, 1U) << "packet 1, late";
  EXPECT_EQ(report.roundTrip, -1);
  ASSERT_TRUE(window.RecordAcknowledgement(3, 0b11, 1.6, report));
  EXPECT_EQ(report.acknowledged, 1U) << "only packet 3 is news";
  EXPECT_NEAR(report.roundTrip, 0.4, 1e-12);
  ASSERT_TRUE(window.RecordAcknowledgement(3, 0b11, 9, report));
  EXPECT_EQ(report.acknowledged, 0U);
  EXPECT_EQ(report.roundTrip, -1);
  ASSERT_TRUE(window.RecordAcknowledgement(0, 0, 9, report)) << "a client that has heard nothing yet";
  EXPECT_EQ(report.acknowledged, 0U);
}

TEST(SentWindow, RefusesWhatWasNeverSent) {
  SentWindow window;
  SentWindow::Report report;
  EXPECT_FALSE(window.RecordAcknowledgement(1, 0, 0, report));
  static_cast<void>(window.RecordSent(0));
  EXPECT_FALSE(window.RecordAcknowledgement(2, 1, 0, report)) << "the newest";
  EXPECT_FALSE(window.RecordAcknowledgement(0xFFFFFFFF, ~std::uint64_t{0}, 0, report));
  EXPECT_FALSE(window.RecordAcknowledgement(1, 1, 0, report)) << "packet 0, in the history";
  EXPECT_FALSE(window.RecordAcknowledgement(0, 1, 0, report));
  ASSERT_TRUE(window.RecordAcknowledgement(1, 0, 0, report));
  EXPECT_EQ(report.acknowledged, 1U) << "the refused ones changed nothing";
  while (window.Newest() < 65) static_cast<void>(window.RecordSent(0));
  EXPECT_FALSE(window.RecordAcknowledgement(64, std::uint64_t{1} << 63, 0, report));
  EXPECT_TRUE(window.RecordAcknowledgement(65, std::uint64_t{1} << 63, 0, report)) << "packet 1";
}

TEST(SentWindow, AnOldAcknowledgementDoesNotTouchANewSlot) {
  SentWindow window;
  for (int i = 0; i < 1000; ++i) static_cast<void>(window.RecordSent(0.01 * i));
  SentWindow::Report report;
  ASSERT_TRUE(window.RecordAcknowledgement(500, ~std::uint64_t{0}, 10, report));
  EXPECT_EQ(report.acknowledged, 0U);
  ASSERT_TRUE(window.RecordAcknowledgement(1000, ~std::uint64_t{0}, 10, report));
  EXPECT_EQ(report.acknowledged, 65U);
}

double FindShare(const SentWindow::Tally& tally) {
  return static_cast<double>(tally.lost) / (tally.arrived + tally.lost);
}

// Sends `packets` packets over a link that drops this share each way and swaps neighbours; the share that counts as
// lost.
double FindLossShare(double dropShare, int packets, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> chance(0, 1);
  SentWindow sent;
  ReceivedWindow received;
  std::uint32_t delayed = 0;
  unsigned acknowledged = 0, arrived = 0;
  for (int i = 0; i < packets; ++i) {
    const std::uint32_t sequence = sent.RecordSent(0.033 * i);
    const bool dropped = chance(random) < dropShare;
    if (!dropped && delayed == 0 && chance(random) < 0.1) {
      delayed = sequence;
    } else {
      for (const std::uint32_t each : {dropped ? 0U : sequence, delayed}) {
        if (each != 0 && received.Record(each) == Arrival::kNew) ++arrived;
      }
      delayed = 0;
    }
    if (chance(random) < dropShare) continue;  // the acknowledgement is lost
    SentWindow::Report report;
    EXPECT_TRUE(sent.RecordAcknowledgement(received.Newest(), received.History(), 0.033 * i, report));
    acknowledged += report.acknowledged;
  }
  EXPECT_NEAR(acknowledged, arrived, 20) << "lost acknowledgements cost nothing but the last few";
  const SentWindow::Tally tally = sent.Judge();
  EXPECT_NEAR(tally.arrived + tally.lost, packets, 300) << "of runs of losses some do not count";
  return FindShare(tally);
}

// Two seconds of every ten at 30 packets a second.
TEST(SentWindow, ABlackoutIsNoFullLink) {
  SentWindow sent;
  ReceivedWindow received;
  for (std::uint32_t i = 1; i <= 3000; ++i) {
    const std::uint32_t sequence = sent.RecordSent(0.033 * i);
    if (i % 300 < 60) continue;
    static_cast<void>(received.Record(sequence));
    SentWindow::Report report;
    ASSERT_TRUE(sent.RecordAcknowledgement(received.Newest(), received.History(), 0.033 * i, report));
  }
  const SentWindow::Tally tally = sent.Judge();
  EXPECT_EQ(tally.lost, 10 * 8U);
  EXPECT_EQ(sent.Lost(), 10 * 60U - 1) << "the first one begins with packet 1";
}

TEST(SentWindow, WhatMayStillComeIsNotJudged) {
  SentWindow sent;
  for (int i = 0; i < 20; ++i) static_cast<void>(sent.RecordSent(0.02 * i));
  EXPECT_EQ(sent.Judge().lost, 0U) << "nothing was heard";
  SentWindow::Report report;
  ASSERT_TRUE(sent.RecordAcknowledgement(20, 0, 0.5, report));  // left at 0.38 s
  const SentWindow::Tally tally = sent.Judge();
  EXPECT_EQ(tally.arrived, 0U);
  EXPECT_EQ(tally.lost, 8U) << "of the 12 that left before 0.23 s, a run";
  EXPECT_EQ(sent.Lost(), 12U);
  EXPECT_EQ(sent.Judge().lost, 0U) << "counted once";
  ASSERT_TRUE(sent.RecordAcknowledgement(20, ~std::uint64_t{0} >> 45, 0.5, report));  // the others have come late
  static_cast<void>(sent.RecordSent(0.6));
  ASSERT_TRUE(sent.RecordAcknowledgement(21, 0, 0.7, report));
  EXPECT_EQ(sent.Judge().arrived, 8U);
}

TEST(SentWindow, WhatIsForgottenIsJudgedBefore) {
  SentWindow sent;
  for (int i = 0; i < 1000; ++i) static_cast<void>(sent.RecordSent(0));
  EXPECT_EQ(sent.Lost(), 1000U - 4 * (kAckHistory + 1));
  EXPECT_EQ(sent.Judge().lost, 8U) << "one run";
}

TEST(SentWindow, TheTallyFollowsTheLink) {
  EXPECT_EQ(FindLossShare(0, 2000, 1), 0);
  double sum = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const double share = FindLossShare(0.2, 2000, seed);
    EXPECT_NEAR(share, 0.2, 0.04) << "seed " << seed;
    sum += share;
  }
  EXPECT_NEAR(sum / 40, 0.2, 0.01);
}

}  // namespace
}  // namespace wobble::protocol
