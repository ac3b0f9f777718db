#include "server/play/crown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace wobble::server {
namespace {

constexpr physics::BodyId kCrownBody = 5;
constexpr double kTick = 1.0 / 60;

struct CrownMatch {
  scenes::GameRules rules;
  Match match;
  Crown crown;
  Crown::Deeds deeds;
  std::vector<ClientId> opened;

  CrownMatch() : rules(MakeRules()), match(rules) {
    for (const ClientId client : {1U, 2U, 3U}) match.Enter(client, false);
    for (int i = 0; i < 20; ++i) match.Advance(0.1);
  }
  static scenes::GameRules MakeRules() {
    scenes::GameRules rules;
    rules.kind = scenes::GameRules::Kind::kCrown;
    rules.pointsToWin = 30;
    return rules;
  }
  // These hands hold the crown from now on.
  void Hold(const std::vector<ClientId>& clients) {
    deeds.grasps.clear();
    for (const ClientId client : clients) {
      deeds.grasps.push_back({client, {.body = kCrownBody, .vertex = 3, .grip = 1}, {0, 0, 0.1}});
    }
  }
  // The last who has taken it; 0: nobody has.
  ClientId Run(double seconds) {
    ClientId taker = 0;
    opened.clear();
    for (double time = 0; time < seconds; time += kTick) {
      if (const ClientId each = crown.Follow(deeds, kTick, match, opened)) taker = each;
      std::erase_if(deeds.grasps,
                    [&](const auto& grasp) { return std::ranges::find(opened, grasp.client) != opened.end(); });
      deeds.isPushed = false;
    }
    return taker;
  }
};

TEST(Crown, ItsBearerGetsAPointASecond) {
  CrownMatch game;
  game.Hold({2});
  EXPECT_EQ(game.Run(kTick), 2U);
  EXPECT_EQ(game.Run(5.05), 0U);
  EXPECT_EQ(game.match.Find(2)->points, 5);
  EXPECT_EQ(game.crown.bearer, 2U);
}

TEST(Crown, AnotherHandTakesItOverAndNotAtOnceBack) {
  CrownMatch game;
  game.Hold({1});
  game.Run(0.5);
  game.Hold({1, 2});
  EXPECT_EQ(game.Run(kTick), 0U) << "within a second nobody takes it over";
  EXPECT_EQ(game.opened, std::vector<ClientId>{2});
  game.Run(0.6);
  game.Hold({1, 2});
  EXPECT_EQ(game.Run(kTick), 2U);
  EXPECT_EQ(game.opened, std::vector<ClientId>{1}) << "who wore it lets go";
  game.Hold({1, 2});
  EXPECT_EQ(game.Run(0.5), 0U);
  EXPECT_EQ(game.crown.bearer, 2U);
}

TEST(Crown, APushKnocksItOffAndWhoHasLostItIsNotTheNext) {
  CrownMatch game;
  game.Hold({1});
  game.Run(1.1);
  game.deeds.isPushed = true;
  game.Run(kTick);
  EXPECT_EQ(game.crown.bearer, 0U);
  EXPECT_EQ(game.opened, std::vector<ClientId>{1});
  game.Hold({1});
  EXPECT_EQ(game.Run(0.3), 0U);
  game.Hold({1, 3});
  EXPECT_EQ(game.Run(kTick), 3U);
  game.deeds.isPushed = true;
  game.Run(kTick);
  EXPECT_EQ(game.crown.bearer, 3U) << "just taken, it sits fast";
  game.Hold({});
  game.Run(kTick);
  EXPECT_EQ(game.crown.bearer, 0U) << "it has slipped";
  game.Run(1.1);
  game.Hold({3});
  EXPECT_EQ(game.Run(kTick), 3U) << "after a second who lost it may have it back";
}

TEST(Crown, OutsideOfPlayItGivesNoPoints) {
  CrownMatch game;
  game.Hold({1});
  game.match.BeginAnew();
  game.Run(2.5);
  EXPECT_EQ(game.crown.bearer, 1U);
  EXPECT_EQ(game.match.Find(1)->points, 0);
}

}  // namespace
}  // namespace wobble::server
