#include "server/play/match.h"

#include <gtest/gtest.h>

#include <vector>

namespace wobble::server {
namespace {

using Phase = Match::Phase;
using Kind = scenes::GameRules::Kind;

scenes::GameRules MakeRules(Kind kind) {
  scenes::GameRules rules;
  rules.kind = kind;
  rules.pointsToWin = 3;
  rules.roundSeconds = 60;
  rules.rounds = 2;
  rules.lobbySeconds = 20;
  return rules;
}

Match MakeMatch(Kind kind, const std::vector<ClientId>& people, const std::vector<ClientId>& bots = {}) {
  Match match(MakeRules(kind));
  for (const ClientId client : people) match.Enter(client, false);
  for (const ClientId client : bots) match.Enter(client, true);
  return match;
}

void PassTime(Match& match, double seconds) {
  for (int i = 0; i < seconds * 10; ++i) match.Advance(0.1);
}

// From the lobby into the first round.
void Begin(Match& match) {
  PassTime(match, 20 + 3 + 0.5);
  ASSERT_EQ(match.ReadPhase(), Phase::kPlaying);
}

int SideOf(const Match& match, ClientId client) { return match.Find(client)->side; }

TEST(Match, TheLobbyEndsWhenAllAreReadyAndOtherwiseWhenItsTimeIsUp) {
  Match match = MakeMatch(Kind::kCrown, {1, 2});
  PassTime(match, 5);
  EXPECT_EQ(match.ReadPhase(), Phase::kLobby);
  EXPECT_TRUE(match.SetReady(1, true));
  EXPECT_FALSE(match.SetReady(7, true)) << "is not in";
  PassTime(match, 1);
  EXPECT_EQ(match.ReadPhase(), Phase::kLobby) << "one is not ready";
  EXPECT_FALSE(match.TakePlacing());
  match.SetReady(2, true);
  PassTime(match, 0.2);
  EXPECT_EQ(match.ReadPhase(), Phase::kKickOff);
  EXPECT_FALSE(match.MayMove());
  EXPECT_TRUE(match.TakePlacing());
  EXPECT_FALSE(match.TakePlacing()) << "once";
  PassTime(match, 3.1);
  EXPECT_EQ(match.ReadPhase(), Phase::kPlaying);
  EXPECT_TRUE(match.MayMove());

  Match silent = MakeMatch(Kind::kCrown, {1, 2});
  Begin(silent);
}

TEST(Match, BotsAreReadyAtOnceAndOneAloneWaits) {
  Match match = MakeMatch(Kind::kGoals, {}, {1});
  PassTime(match, 100);
  EXPECT_EQ(match.ReadPhase(), Phase::kLobby);
  EXPECT_EQ(match.SecondsLeft(), 20) << "it waits for others as long as it takes";
  match.Enter(2, true);
  PassTime(match, 0.2);
  EXPECT_EQ(match.ReadPhase(), Phase::kKickOff);
}

TEST(Match, WhatBotsWinBeforeAnybodyCameDoesNotCount) {
  Match match = MakeMatch(Kind::kCrown, {}, {1, 2});
  PassTime(match, 3.5);
  for (int i = 0; i < 3; ++i) match.Score(1);
  EXPECT_EQ(match.Find(1)->rounds, 1);
  match.Enter(3, false);
  EXPECT_EQ(match.ReadPhase(), Phase::kLobby);
  EXPECT_EQ(match.Round(), 1);
  EXPECT_EQ(match.Find(1)->rounds, 0);
  EXPECT_EQ(match.Find(1)->points, 0);
  Begin(match);
  match.Score(3);
  match.Enter(4, false);
  EXPECT_EQ(match.ReadPhase(), Phase::kPlaying) << "the second person comes into the match that is played";
  EXPECT_EQ(match.Find(3)->points, 1);
}

TEST(Match, RoundsMakeAMatchWithAFinalBoardAndTheNextOneBegins) {
  Match match = MakeMatch(Kind::kCrown, {1, 2});
  Begin(match);
  for (int i = 0; i < 3; ++i) match.Score(1);
  EXPECT_EQ(match.ReadPhase(), Phase::kWon);
  EXPECT_EQ(match.Winner(), 1U);
  match.Score(2);
  EXPECT_EQ(match.Find(2)->points, 0) << "between rounds nothing counts";
  PassTime(match, 8 + 3 + 0.5);
  EXPECT_EQ(match.ReadPhase(), Phase::kPlaying);
  EXPECT_EQ(match.Round(), 2);
  EXPECT_EQ(match.Find(1)->points, 0);
  match.Score(1);
  PassTime(match, 60);
  EXPECT_EQ(match.ReadPhase(), Phase::kOver) << "the time is up";
  EXPECT_EQ(match.Winner(), 1U);
  EXPECT_EQ(match.Find(1)->rounds, 2);
  EXPECT_EQ(match.Read().matches, 0);
  PassTime(match, 8.2);
  EXPECT_EQ(match.Read().matches, 1);
  EXPECT_EQ(match.ReadPhase(), Phase::kLobby);
  EXPECT_EQ(match.Round(), 1);
  EXPECT_EQ(match.Find(1)->rounds, 0);
}

TEST(Match, RoundsThatAreSharedMakeNoWinner) {
  Match match = MakeMatch(Kind::kCrown, {1, 2});
  Begin(match);
  for (int i = 0; i < 3; ++i) match.Score(1);
  PassTime(match, 8 + 3 + 0.5);
  for (int i = 0; i < 3; ++i) match.Score(2);
  EXPECT_EQ(match.ReadPhase(), Phase::kOver);
  EXPECT_EQ(match.Winner(), 0U);
}

TEST(Match, WithoutRoundsItNeverEndsAndRoundsMayBeSetFromOutside) {
  scenes::GameRules rules = MakeRules(Kind::kSumo);
  rules.rounds = 0;
  rules.lobbySeconds = 0;
  Match match(rules);
  for (const ClientId client : {1U, 2U}) match.Enter(client, false);
  for (int i = 0; i < 5; ++i) PassTime(match, 60 + 8 + 0.3);
  EXPECT_EQ(match.Round(), 6);
  EXPECT_EQ(match.Read().matches, 0);
  match.SetRounds(6);
  PassTime(match, 60);
  EXPECT_EQ(match.ReadPhase(), Phase::kOver);
}

TEST(Match, AnEqualScoreIsDecidedByTheNextPoint) {
  Match match = MakeMatch(Kind::kGoals, {1, 2});
  Begin(match);
  PassTime(match, 60);
  EXPECT_EQ(match.ReadPhase(), Phase::kKickOff);
  PassTime(match, 3.2);
  ASSERT_EQ(match.ReadPhase(), Phase::kGolden);
  match.Score(2, 2);
  EXPECT_EQ(match.ReadPhase(), Phase::kWon);
  EXPECT_EQ(match.WinningSide(), 2);
  EXPECT_EQ(match.Winner(), 0U) << "a side has won";
  EXPECT_EQ(match.Read().sides[1].rounds, 1);

  Match endless = MakeMatch(Kind::kCrown, {1, 2});
  Begin(endless);
  PassTime(endless, 60);
  EXPECT_EQ(endless.ReadPhase(), Phase::kGolden) << "without a kick-off: the crown is on somebody's head";
  PassTime(endless, 60.2);
  EXPECT_EQ(endless.ReadPhase(), Phase::kWon) << "the golden point is not waited for for ever";
  EXPECT_EQ(endless.Winner(), 0U);
}

TEST(Match, AGoalStopsTheTimeUntilTheKickOffIsOver) {
  Match match = MakeMatch(Kind::kGoals, {1, 2});
  Begin(match);
  const double left = match.SecondsLeft();
  static_cast<void>(match.TakePlacing());
  match.Score(0, 1);
  EXPECT_EQ(match.ReadPhase(), Phase::kKickOff);
  EXPECT_TRUE(match.TakePlacing());
  match.Score(0, 1);
  EXPECT_EQ(match.Read().sides[0].points, 1) << "during the kick-off nothing counts";
  PassTime(match, 3);
  EXPECT_EQ(match.ReadPhase(), Phase::kPlaying);
  EXPECT_NEAR(match.SecondsLeft(), left, 0.2);
}

TEST(Match, SidesAreKeptEvenAndNobodyChangesInTheMiddleOfPlay) {
  Match match = MakeMatch(Kind::kGoals, {1, 2, 3, 4, 5});
  EXPECT_EQ(SideOf(match, 1), 1);
  EXPECT_EQ(SideOf(match, 2), 2);
  EXPECT_EQ(SideOf(match, 3), 1);
  EXPECT_EQ(SideOf(match, 4), 2);
  EXPECT_EQ(SideOf(match, 5), 1);
  Begin(match);
  match.Leave(2);
  EXPECT_EQ(SideOf(match, 5), 1);
  EXPECT_EQ(SideOf(match, 3), 1) << "three against one, until the next kick-off";
  match.Score(1, 1);
  EXPECT_EQ(SideOf(match, 5), 2) << "the last who came";
  EXPECT_EQ(SideOf(match, 3), 1);
  match.Enter(6, true);
  EXPECT_EQ(SideOf(match, 6), 1);
}

TEST(Match, WhoIsLeftAloneOnTheirSideIsJoinedByAnOpponentAndWhoIsAloneGoesToTheLobby) {
  Match match = MakeMatch(Kind::kGoals, {1, 2}, {3});
  Begin(match);
  match.Leave(2);
  PassTime(match, 0.2);
  EXPECT_EQ(match.ReadPhase(), Phase::kKickOff);
  EXPECT_EQ(SideOf(match, 3), 2) << "a bot rather than a person";
  match.Leave(3);
  PassTime(match, 0.2);
  EXPECT_EQ(match.ReadPhase(), Phase::kLobby);
}

TEST(Match, AMemoryThatCannotBeIsRefused) {
  Match match = MakeMatch(Kind::kGoals, {1, 2});
  Match::Memory memory = match.Read();
  Match again(MakeRules(Kind::kGoals));
  EXPECT_TRUE(again.Write(memory));
  memory.players[1].side = 3;
  EXPECT_FALSE(again.Write(memory));
  memory = match.Read();
  memory.players[9].client = 8;
  EXPECT_FALSE(again.Write(memory));
  EXPECT_FALSE(Match(MakeRules(Kind::kCrown)).Write(match.Read())) << "of a game with sides";
}

}  // namespace
}  // namespace wobble::server
