#include "server/ops/fleet_duty.h"

#include <gtest/gtest.h>

namespace wobble::ops {
namespace {

using State = FleetWish::State;
using Clients = std::vector<std::uint32_t>;

// A turn of the loop of a server that accepts joins.
FleetWish Turn(FleetDuty& duty, double now, const Clients& players = {}) {
  return duty.Follow({.now = now, .acceptsJoins = true, .players = players});
}

TEST(FleetDuty, AHeartbeatIsDueEveryTwoSecondsOfTheLoop) {
  FleetDuty duty;
  for (int turn = 0; turn < 600; ++turn) {  // 10 s at 60 Hz, from 100 s on
    static_cast<void>(duty.Follow({.now = 100 + turn / 60.0}));
  }
  EXPECT_EQ(duty.Follow({.now = 109.99}).heartbeats, 5U);
  EXPECT_EQ(duty.Follow({.now = 500}).heartbeats, 6U) << "none is made up for after a long turn";
  EXPECT_EQ(duty.Follow({.now = 501.9}).heartbeats, 6U);
}

TEST(FleetDuty, IsNotReadyBeforeJoinsAreAccepted) {
  FleetDuty duty;
  EXPECT_EQ(duty.Follow({.now = 0}).state, State::kStarting);
  EXPECT_EQ(Turn(duty, 0.1).state, State::kReady);
  EXPECT_EQ(duty.Follow({.now = 0.3, .acceptsJoins = false}).state, State::kReady) << "it is busy";
}

TEST(FleetDuty, TheFirstPlayerAllocates) {
  FleetDuty duty;
  EXPECT_EQ(Turn(duty, 0).state, State::kReady);
  EXPECT_EQ(Turn(duty, 1, {7, 3}), (FleetWish{State::kAllocated, {3, 7}, 1}));
  EXPECT_EQ(Turn(duty, 1.1, {3, 7}), (FleetWish{State::kAllocated, {3, 7}, 1})) << "the same players in another order";
  EXPECT_EQ(Turn(duty, 1.2, {9, 7}), (FleetWish{State::kAllocated, {7, 9}, 1}));
  EXPECT_EQ(Turn(duty, 1.3), (FleetWish{State::kAllocated, {}, 1})) << "for ten seconds";
}

TEST(FleetDuty, APlayerWaitsForReady) {
  FleetDuty duty;
  const Clients players{1};
  EXPECT_EQ(duty.Follow({.now = 0, .players = players}), (FleetWish{State::kStarting, {}, 1}));
  EXPECT_EQ(Turn(duty, 0.1, players), (FleetWish{State::kAllocated, {1}, 1}));
}

TEST(FleetDuty, AnEmptyWorldThatNobodyHasComeToStays) {
  FleetDuty duty;
  for (int now = 0; now < 3600; ++now) EXPECT_EQ(Turn(duty, now).state, State::kReady);
}

TEST(FleetDuty, IsOverTenSecondsAfterTheLastHasLeft) {
  FleetDuty duty;
  static_cast<void>(Turn(duty, 0, {1}));
  static_cast<void>(Turn(duty, 100, {1}));
  EXPECT_EQ(Turn(duty, 109.9).state, State::kAllocated);
  EXPECT_EQ(Turn(duty, 109.9, {2}).state, State::kAllocated) << "just in time";
  EXPECT_EQ(Turn(duty, 119.8).state, State::kAllocated);
  EXPECT_EQ(Turn(duty, 119.9).state, State::kShutdown);
}

TEST(FleetDuty, IsOverWhenTheRoundsHaveBeenPlayed) {
  FleetDuty duty;
  const Clients players{1, 2};
  static_cast<void>(Turn(duty, 0, players));
  EXPECT_EQ(duty.Follow({.now = 1, .acceptsJoins = true, .isMatchOver = true, .players = players}).state,
            State::kShutdown);
}

TEST(FleetDuty, ClosingWishesShutdownAndNothingBesides) {
  FleetDuty duty;
  static_cast<void>(Turn(duty, 0, {1, 2}));
  EXPECT_EQ(duty.Follow({.now = 5, .isClosing = true}), (FleetWish{State::kShutdown, {1, 2}, 1}))
      << "a heartbeat is due, and two have left";
}

TEST(FleetDuty, OnlyHeartbeatsFollowShutdown) {
  FleetDuty duty;
  static_cast<void>(Turn(duty, 0));
  static_cast<void>(duty.Follow({.now = 1, .acceptsJoins = true, .isMatchOver = true}));
  EXPECT_EQ(Turn(duty, 60, {5}), (FleetWish{State::kShutdown, {}, 2}));
  EXPECT_EQ(duty.Follow({.now = 61, .isClosing = true}).state, State::kShutdown);
}

}  // namespace
}  // namespace wobble::ops
