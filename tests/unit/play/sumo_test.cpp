#include "server/play/sumo.h"

#include <gtest/gtest.h>

namespace wobble::server {
namespace {

// A match with the rules of sumo.
struct SumoMatch : Match {
  using Match::Match;
  Sumo sumo;

  void NoteTouch(ClientId a, ClientId b) { sumo.NoteTouch(*this, a, b); }
  ClientId NoteFall(ClientId fallen) { return sumo.NoteFall(*this, fallen); }
};

SumoMatch MakeGame(int pointsToWin = 3, double roundSeconds = 60) {
  scenes::GameRules rules;
  rules.kind = scenes::GameRules::Kind::kSumo;
  rules.pointsToWin = pointsToWin;
  rules.roundSeconds = roundSeconds;
  SumoMatch game(rules);
  for (const ClientId client : {1U, 2U, 3U}) game.Enter(client, false);
  return game;
}

int PointsOf(const Match& game, ClientId client) {
  for (const Match::Standing& each : game.Standings()) {
    if (each.client == client) return each.points;
  }
  return -1;
}

TEST(Sumo, AFallScoresForWhoTouchedLast) {
  SumoMatch game = MakeGame();
  game.NoteTouch(1, 2);
  game.Advance(1);
  game.NoteTouch(3, 2);
  game.Advance(1);
  EXPECT_EQ(game.NoteFall(2), 3U);
  EXPECT_EQ(PointsOf(game, 3), 1);
  EXPECT_EQ(PointsOf(game, 1), 0);
  EXPECT_EQ(PointsOf(game, 2), 0);
  EXPECT_EQ(game.Standings()[0].client, 3U) << "the best comes first";
}

TEST(Sumo, AFallScoresOnceAndNotForATouchLongAgo) {
  SumoMatch game = MakeGame();
  EXPECT_EQ(game.NoteFall(2), 0U) << "nobody has touched him";
  game.NoteTouch(1, 2);
  EXPECT_EQ(game.NoteFall(2), 1U);
  EXPECT_EQ(game.NoteFall(2), 0U) << "he has been put back since";
  game.NoteTouch(1, 2);
  game.Advance(10);
  EXPECT_EQ(game.NoteFall(2), 0U);
  EXPECT_EQ(PointsOf(game, 1), 1);
}

TEST(Sumo, WhoHasLeftNeitherScoresNorIsBlamed) {
  SumoMatch game = MakeGame();
  game.NoteTouch(1, 2);
  game.Leave(1);
  EXPECT_EQ(game.NoteFall(2), 0U);
  EXPECT_EQ(game.NoteFall(1), 0U);
  EXPECT_EQ(PointsOf(game, 1), -1);
}

TEST(Sumo, EnoughPointsEndTheRoundAndTheNextBeginsAtNothing) {
  SumoMatch game = MakeGame(2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(game.ReadPhase(), Match::Phase::kPlaying);
    game.NoteTouch(1, 2);
    EXPECT_EQ(game.NoteFall(2), 1U);
  }
  EXPECT_EQ(game.ReadPhase(), Match::Phase::kWon);
  EXPECT_EQ(game.Winner(), 1U);
  game.NoteTouch(3, 2);
  EXPECT_EQ(game.NoteFall(2), 0U) << "between rounds nothing counts";
  game.Advance(20);
  EXPECT_EQ(game.ReadPhase(), Match::Phase::kPlaying);
  EXPECT_EQ(game.Round(), 2);
  EXPECT_EQ(PointsOf(game, 1), 0);
  EXPECT_EQ(game.Standings()[0].client, 1U);
  EXPECT_EQ(game.Standings()[0].rounds, 1);
}

TEST(Sumo, WhenTheTimeIsUpMostPointsWinAndEqualOnesDraw) {
  SumoMatch game = MakeGame(5, 30);
  game.NoteTouch(1, 2);
  game.NoteFall(2);
  for (int i = 0; i < 31; ++i) game.Advance(1);
  EXPECT_EQ(game.Winner(), 1U);
  SumoMatch draw = MakeGame(5, 30);
  for (int i = 0; i < 31; ++i) draw.Advance(1);
  EXPECT_EQ(draw.ReadPhase(), Match::Phase::kWon);
  EXPECT_EQ(draw.Winner(), 0U);
}

TEST(Sumo, AloneTheTimeStandsStill) {
  SumoMatch game = MakeGame();
  game.Leave(2);
  game.Leave(3);
  for (int i = 0; i < 200; ++i) game.Advance(1);
  EXPECT_EQ(game.ReadPhase(), Match::Phase::kPlaying);
  EXPECT_EQ(game.SecondsLeft(), 60);
}

}  // namespace
}  // namespace wobble::server
