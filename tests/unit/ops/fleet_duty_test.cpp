#include "server/ops/fleet_duty.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace wobble::ops {
namespace {

using Kind = FleetCall::Kind;
using Calls = std::vector<FleetCall>;
using Clients = std::vector<std::uint32_t>;

// A turn of the loop of a server that accepts joins.
Calls Turn(FleetDuty& duty, double now, const Clients& players = {}) {
  return duty.Follow({.now = now, .acceptsJoins = true, .players = players});
}

Calls WithoutHealth(Calls calls) {
  std::erase(calls, FleetCall{Kind::kHealth});
  return calls;
}

TEST(FleetDuty, HealthComesEveryTwoSecondsOfTheLoop) {
  FleetDuty duty;
  int calls = 0;
  for (int turn = 0; turn < 600; ++turn) {  // 10 s at 60 Hz, from 100 s on
    for (const FleetCall& call : duty.Follow({.now = 100 + turn / 60.0})) calls += call.kind == Kind::kHealth;
  }
  EXPECT_EQ(calls, 5);
  EXPECT_EQ(duty.Follow({.now = 500}), (Calls{{Kind::kHealth}})) << "none is made up for after a long turn";
  EXPECT_EQ(duty.Follow({.now = 501.9}), Calls{});
}

TEST(FleetDuty, IsReadyOnceAndNotBeforeJoinsAreAccepted) {
  FleetDuty duty;
  EXPECT_EQ(duty.Follow({.now = 0}), (Calls{{Kind::kHealth}}));
  EXPECT_EQ(Turn(duty, 0.1), (Calls{{Kind::kReady}}));
  EXPECT_EQ(Turn(duty, 0.2), Calls{});
  EXPECT_EQ(duty.Follow({.now = 0.3, .acceptsJoins = false}), Calls{}) << "it is busy";
  EXPECT_EQ(Turn(duty, 0.4), Calls{}) << "and is so no more";
}

TEST(FleetDuty, TheFirstPlayerAllocates) {
  FleetDuty duty;
  static_cast<void>(Turn(duty, 0));
  EXPECT_EQ(Turn(duty, 1, {7, 3}), (Calls{{Kind::kAllocate}, {Kind::kAddPlayer, 3}, {Kind::kAddPlayer, 7}}));
  EXPECT_EQ(Turn(duty, 1.1, {3, 7}), Calls{}) << "the same players in another order";
  EXPECT_EQ(Turn(duty, 1.2, {9, 7}), (Calls{{Kind::kRemovePlayer, 3}, {Kind::kAddPlayer, 9}}));
  EXPECT_EQ(Turn(duty, 1.3), (Calls{{Kind::kRemovePlayer, 7}, {Kind::kRemovePlayer, 9}}));
  EXPECT_EQ(Turn(duty, 1.4, {10}), (Calls{{Kind::kAddPlayer, 10}})) << "it has been allocated before";
}

TEST(FleetDuty, APlayerWaitsForReady) {
  FleetDuty duty;
  const Clients players{1};
  EXPECT_EQ(duty.Follow({.now = 0, .players = players}), (Calls{{Kind::kHealth}}));
  EXPECT_EQ(Turn(duty, 0.1, players), (Calls{{Kind::kReady}, {Kind::kAllocate}, {Kind::kAddPlayer, 1}}));
}

TEST(FleetDuty, AnEmptyWorldThatNobodyHasComeToStays) {
  FleetDuty duty;
  for (int now = 0; now < 3600; ++now) {
    for (const FleetCall& call : Turn(duty, now)) EXPECT_NE(call.kind, Kind::kShutdown);
  }
}

TEST(FleetDuty, IsOverTenSecondsAfterTheLastHasLeft) {
  FleetDuty duty;
  static_cast<void>(Turn(duty, 0, {1}));
  static_cast<void>(Turn(duty, 100, {1}));
  EXPECT_EQ(WithoutHealth(Turn(duty, 100.5)), (Calls{{Kind::kRemovePlayer, 1}}));
  EXPECT_EQ(WithoutHealth(Turn(duty, 109.9, {2})), (Calls{{Kind::kAddPlayer, 2}})) << "just in time";
  EXPECT_EQ(WithoutHealth(Turn(duty, 110)), (Calls{{Kind::kRemovePlayer, 2}}));
  EXPECT_EQ(WithoutHealth(Turn(duty, 119.8)), Calls{});
  EXPECT_EQ(WithoutHealth(Turn(duty, 119.9)), (Calls{{Kind::kShutdown}}));
}

TEST(FleetDuty, IsOverWhenTheRoundsHaveBeenPlayed) {
  FleetDuty duty;
  const Clients players{1, 2};
  static_cast<void>(Turn(duty, 0, players));
  EXPECT_EQ(duty.Follow({.now = 1, .acceptsJoins = true, .isMatchOver = true, .players = players}),
            (Calls{{Kind::kShutdown}}));
}

TEST(FleetDuty, ClosingCallsShutdownAndNothingBesides) {
  FleetDuty duty;
  static_cast<void>(Turn(duty, 0, {1, 2}));
  EXPECT_EQ(duty.Follow({.now = 5, .isClosing = true}), (Calls{{Kind::kShutdown}}))
      << "health is due, and two have left";
}

TEST(FleetDuty, OnlyHealthFollowsShutdown) {
  FleetDuty duty;
  static_cast<void>(Turn(duty, 0, {1}));
  EXPECT_EQ(duty.Follow({.now = 1, .acceptsJoins = true, .isMatchOver = true}).back(), (FleetCall{Kind::kShutdown}));
  EXPECT_EQ(Turn(duty, 1.5, {5}), Calls{});
  EXPECT_EQ(Turn(duty, 60, {5}), (Calls{{Kind::kHealth}}));
  EXPECT_EQ(duty.Follow({.now = 61, .isClosing = true}), Calls{}) << "not a second shutdown either";
}

}  // namespace
}  // namespace wobble::ops
