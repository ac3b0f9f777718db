// Votes by number and time, without a server.
#include "server/vote.h"

#include <gtest/gtest.h>

#include <vector>

namespace wobble::server {
namespace {

using Outcome = Vote::Outcome;
using Voice = Vote::Voice;
using Clients = std::vector<ClientId>;

TEST(Vote, MoreThanHalfPass) {
  for (ClientId players = 1; players <= 7; ++players) {
    Clients entitled;
    for (ClientId client = 1; client <= players; ++client) entitled.push_back(client);
    Vote vote;
    ClientId voices = 0;
    for (Outcome outcome = Outcome::kNone; outcome == Outcome::kNone;) {
      ASSERT_LT(voices, players);
      ASSERT_EQ(vote.Cast(++voices, 1), Voice::kTaken);
      outcome = vote.Follow(entitled, 1);
      EXPECT_EQ(outcome == Outcome::kPassed, 2 * voices > players) << voices << " of " << players;
    }
    EXPECT_FALSE(vote.IsOpen());
    EXPECT_EQ(voices, FindMajority(players));
  }
}

TEST(Vote, AVoiceCountsOnceAndAsLongAsItsPlayerIsIn) {
  Vote vote;
  EXPECT_EQ(vote.Cast(1, 0), Voice::kTaken);
  EXPECT_EQ(vote.Cast(1, 1), Voice::kRepeated);
  EXPECT_EQ(vote.Follow(Clients{1, 2, 3, 4}, 1), Outcome::kNone);
  EXPECT_EQ(vote.Voices(), 1U);
  EXPECT_EQ(vote.Cast(2, 3), Voice::kTaken);
  EXPECT_EQ(vote.Follow(Clients{2, 3, 4, 5}, 3), Outcome::kNone) << "1 came back as 5";
  EXPECT_EQ(vote.Voices(), 1U);
  EXPECT_EQ(vote.Cast(5, 3), Voice::kTaken);
  EXPECT_EQ(vote.Follow(Clients{2, 3, 4, 5}, 3), Outcome::kNone) << "half is not more than half";
  EXPECT_EQ(vote.Follow(Clients{2, 3, 5}, 4), Outcome::kPassed) << "4 has left";
}

TEST(Vote, FailsAfterAMinuteAndMayBeginAgainAtOnce) {
  Vote vote;
  EXPECT_EQ(vote.Cast(1, 100), Voice::kTaken);
  EXPECT_EQ(vote.Follow(Clients{1, 2}, 159.9), Outcome::kNone);
  EXPECT_NEAR(vote.SecondsLeft(159.9), 0.1, 1e-9);
  EXPECT_EQ(vote.Follow(Clients{1, 2}, 160), Outcome::kFailed);
  EXPECT_EQ(vote.Follow(Clients{1, 2}, 161), Outcome::kNone) << "told once";
  EXPECT_EQ(vote.Cast(2, 161), Voice::kTaken);
  EXPECT_EQ(vote.Voices(), 1U) << "the old voice is gone";
}

TEST(Vote, FailsWhenNobodyIsLeftWhoVoted) {
  Vote vote;
  EXPECT_EQ(vote.Follow(Clients{}, 0), Outcome::kNone);
  EXPECT_EQ(vote.Cast(1, 0), Voice::kTaken);
  EXPECT_EQ(vote.Follow(Clients{}, 1), Outcome::kFailed);
  EXPECT_FALSE(vote.IsOpen());
}

TEST(Vote, OnePassesAMinute) {
  Vote vote;
  const Clients alone{1};
  EXPECT_EQ(vote.Cast(1, 10), Voice::kTaken);
  EXPECT_EQ(vote.Follow(alone, 10), Outcome::kPassed);
  EXPECT_EQ(vote.Cast(1, 69), Voice::kTooEarly);
  EXPECT_NEAR(vote.SecondsLeft(69), 1, 1e-9);
  EXPECT_EQ(vote.Follow(alone, 69), Outcome::kNone);
  EXPECT_EQ(vote.Cast(1, 70), Voice::kTaken);
  EXPECT_EQ(vote.Follow(alone, 70), Outcome::kPassed);
}

}  // namespace
}  // namespace wobble::server
