// Deliveries of bodies at rest to one client: arrived, lost, or unknown.
#include "server/snapshots/subscription.h"

#include <gtest/gtest.h>

namespace wobble::server {
namespace {

constexpr std::uint32_t kRest = 50;  // tick

class SubscriptionTest : public testing::Test {
 protected:
  SubscriptionTest() {
    for (std::uint32_t body = 1; body <= 3; ++body) subscription.interests.push_back({.body = body});
  }

  // Sends packets now; returns the sequence number of the last.
  std::uint32_t SendPackets(int count) {
    for (int i = 0; i < count; ++i) (void)subscription.sent.RecordSent(now);
    return subscription.sent.Newest();
  }
  void SendRest(std::uint32_t body, int packets = 1) {
    const std::uint32_t first = subscription.sent.Newest() + 1;
    subscription.NoteRestSent(InterestOf(body), kRest, first, SendPackets(packets), now);
  }
  void Acknowledge(std::uint32_t newest, std::uint64_t history) {
    protocol::SentWindow::Report report;
    EXPECT_TRUE(subscription.TakeAcknowledgement(newest, history, now, report));
  }
  Subscription::Interest& InterestOf(std::uint32_t body) { return subscription.interests[body - 1]; }
  [[nodiscard]] bool IsSettled(std::uint32_t body, std::uint32_t rest = kRest) {
    return Subscription::IsSettled(InterestOf(body), rest, now);
  }

  Subscription subscription;
  double now = 10;
};

TEST_F(SubscriptionTest, WhatHasArrivedIsSettledForGoodAndForThatRestAlone) {
  EXPECT_FALSE(IsSettled(2));
  SendRest(2);
  Acknowledge(1, 0);
  now += 1000;
  EXPECT_TRUE(IsSettled(2));
  EXPECT_FALSE(IsSettled(2, kRest + 1)) << "it has moved since";
  EXPECT_FALSE(IsSettled(1));
}

TEST_F(SubscriptionTest, WhatIsOnItsWayIsNotSentAgainForAWhile) {
  SendRest(1);
  now += 0.4;
  EXPECT_TRUE(IsSettled(1));
  now += 0.2;
  EXPECT_FALSE(IsSettled(1)) << "nothing was heard";
}

TEST_F(SubscriptionTest, WhatLaterPacketsHaveOvertakenIsLost) {
  SendRest(1);
  SendPackets(4);
  Acknowledge(4, 0b011);  // 4, 3, 2
  EXPECT_TRUE(IsSettled(1)) << "three may overtake one";
  Acknowledge(5, 0b0111);
  EXPECT_FALSE(IsSettled(1));
  SendRest(1);
  Acknowledge(6, 0b01111);
  now += 1000;
  EXPECT_TRUE(IsSettled(1));
}

TEST_F(SubscriptionTest, ABodyInSeveralPacketsHasArrivedWithTheLast) {
  SendRest(3, 3);
  Acknowledge(3, 0b01);  // 3 and 2
  EXPECT_EQ(InterestOf(3).restKnown, 0U);
  Acknowledge(3, 0b11);
  EXPECT_EQ(InterestOf(3).restKnown, kRest);
}

TEST_F(SubscriptionTest, AnAcknowledgementThatComesTooLateToTellCountsAsALoss) {
  SendRest(1);
  SendPackets(protocol::kAckHistory + 1);
  Acknowledge(protocol::kAckHistory + 2, ~std::uint64_t{0});
  EXPECT_EQ(InterestOf(1).restKnown, 0U);
  EXPECT_FALSE(IsSettled(1));
}

TEST_F(SubscriptionTest, ALossOfAnEarlierRestDoesNotRecallTheNewOne) {
  SendRest(1);
  const std::uint32_t second = SendPackets(1) + 1;
  subscription.NoteRestSent(InterestOf(1), kRest + 9, second, SendPackets(1), now);
  SendPackets(4);
  Acknowledge(7, 0b001111);  // 7, 6, 5, 4, 3: the first rest is lost, the second has arrived
  EXPECT_EQ(InterestOf(1).restKnown, kRest + 9);
  EXPECT_TRUE(IsSettled(1, kRest + 9));
}

TEST_F(SubscriptionTest, BodiesThatHaveGoneMeanwhileAreNotMissed) {
  SendRest(2);
  subscription.interests.erase(subscription.interests.begin() + 1);
  Acknowledge(1, 0);
  EXPECT_EQ(subscription.interests[1].restKnown, 0U);
}

TEST_F(SubscriptionTest, WhoNeverAcknowledgesHasOnlyTheLatestRemembered) {
  SendRest(2);
  for (int i = 0; i < 5000; ++i) SendRest(1);
  Acknowledge(1, 0);
  EXPECT_EQ(InterestOf(2).restKnown, 0U) << "forgotten meanwhile: it is sent again";
  Acknowledge(subscription.sent.Newest(), 0);
  EXPECT_EQ(InterestOf(1).restKnown, kRest);
}

TEST_F(SubscriptionTest, WhatWasNeverSentIsNotAcknowledged) {
  SendRest(1);
  protocol::SentWindow::Report report;
  EXPECT_FALSE(subscription.TakeAcknowledgement(2, 0, now, report));
  EXPECT_EQ(InterestOf(1).restKnown, 0U);
}

}  // namespace
}  // namespace wobble::server
