#include "server/play/goals.h"

#include <gtest/gtest.h>

namespace wobble::server {
namespace {

using physics::Vector3d;

scenes::GameRules MakeRules() {
  scenes::GameRules rules;
  rules.kind = scenes::GameRules::Kind::kGoals;
  rules.pointsToWin = 2;
  rules.roundSeconds = 60;
  return rules;
}

struct GoalsMatch {
  scenes::GameRules rules = MakeRules();
  Match match{rules};
  Goals goals;

  GoalsMatch() {
    match.Enter(1, false);
    match.Enter(2, false);
    Play();
  }
  // Until points count.
  void Play() {
    for (int i = 0; i < 200 && !match.IsCounting(); ++i) match.Advance(0.1);
  }
  // -1: no goal.
  int Follow(const Vector3d& ball) {
    ClientId scorer = 0;
    return goals.FollowBall(rules, ball, match, scorer) ? static_cast<int>(scorer) : -1;
  }
};

TEST(Goals, AGoalIsACentreAcrossTheLineBetweenThePostsBelowTheBar) {
  const scenes::GameRules rules = MakeRules();
  EXPECT_EQ(Goals::FindGoal(rules, {-14.01, 0, 1}), 1);
  EXPECT_EQ(Goals::FindGoal(rules, {14.01, -2.9, 2.9}), 2);
  EXPECT_EQ(Goals::FindGoal(rules, {13.99, 0, 1}), 0) << "on the line";
  EXPECT_EQ(Goals::FindGoal(rules, {15, 3.1, 1}), 0) << "beside it";
  EXPECT_EQ(Goals::FindGoal(rules, {15, 0, 3.1}), 0) << "above it";
  EXPECT_EQ(Goals::FindGoal(rules, {15, 0, -0.5}), 0) << "fallen off behind it";
}

TEST(Goals, AGoalCountsOnceForTheSideAndForWhoTouchedTheBallLast) {
  GoalsMatch game;
  game.goals.NoteTouch(game.match, 1);
  game.goals.NoteTouch(game.match, 2);
  EXPECT_EQ(game.Follow({14.1, 0, 1}), 1) << "the last of the side that gains, though another touched it later";
  EXPECT_EQ(game.Follow({14.1, 0, 1}), -1) << "once";
  EXPECT_EQ(game.match.Read().sides[0].points, 1);
  EXPECT_EQ(game.match.Find(1)->points, 1);
  EXPECT_EQ(game.match.Find(2)->points, 0);
  game.Play();
  EXPECT_EQ(game.Follow({0, 0, 1}), -1);
  EXPECT_EQ(game.Follow({14.1, 0, 1}), 0) << "nobody of that side has touched it since the kick-off";
  EXPECT_EQ(game.match.WinningSide(), 1) << "two goals win the round";
}

TEST(Goals, WhoHasLeftOrChangedSidesScoresForNobody) {
  GoalsMatch game;
  game.match.Enter(3, false);
  game.match.Enter(4, false);
  game.goals.NoteTouch(game.match, 3);
  game.match.Leave(3);
  game.goals.Forget(3);
  EXPECT_EQ(game.Follow({14.1, 0, 1}), 0);
}

}  // namespace
}  // namespace wobble::server
