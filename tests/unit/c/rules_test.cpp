// Building, tuning, scores and orders by the client for C.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "client/wobble.h"
#include "tests/unit/c/scripted_world.h"

namespace wobble::c {
namespace {

// Plays, with a sample that has both bodies.
struct Building : Joined {
  Building() {
    world->hasWorkshop = true;
    EXPECT_TRUE(RunUntilState(WOBBLE_PLAYING));
    auto frame = Make<wobble_frame>();
    EXPECT_TRUE(RunUntil([&] {
      EXPECT_EQ(wobble_sample(client, now, &frame), WOBBLE_OK);
      return frame.body_count == 2;
    }));
  }
};

TEST(Rules, TheWorkshopIsReadAsTheSampleShowsIt) {
  Building joined;
  auto workshop = Make<wobble_workshop>();
  ASSERT_EQ(wobble_read_workshop(joined.client, &workshop), WOBBLE_OK);
  EXPECT_EQ(workshop.body, kOtherBody);
  ASSERT_EQ(workshop.particle_count, 4U);
  ASSERT_EQ(workshop.spring_count, 3U);
  auto particle = Make<wobble_particle>();
  ASSERT_EQ(wobble_read_particle(joined.client, 0, &particle), WOBBLE_OK);
  EXPECT_EQ(particle.number, 10U);
  EXPECT_EQ(particle.fixed, 1);
  EXPECT_EQ(particle.mass, 0.5F);
  ASSERT_EQ(wobble_read_particle(joined.client, 2, &particle), WOBBLE_OK);
  EXPECT_EQ(particle.owner, 9U);
  EXPECT_EQ(particle.fixed, 0);
  auto spring = Make<wobble_spring>();
  ASSERT_EQ(wobble_read_spring(joined.client, 2, &spring), WOBBLE_OK);
  EXPECT_EQ(spring.number, 22U);
  EXPECT_EQ(spring.owner, 9U);
  EXPECT_EQ(spring.ends[0], 2U);
  EXPECT_EQ(spring.ends[1], 3U);
  EXPECT_EQ(spring.stiffness, 300);
  EXPECT_EQ(spring.damping, 3);
  EXPECT_EQ(spring.rest_length, 3.5F);
  EXPECT_EQ(wobble_read_particle(joined.client, 4, &particle), WOBBLE_BAD_INDEX);
  EXPECT_EQ(wobble_read_spring(joined.client, 3, &spring), WOBBLE_BAD_INDEX);

  Joined without;
  ASSERT_TRUE(without.RunUntilState(WOBBLE_PLAYING));
  ASSERT_EQ(wobble_read_workshop(without.client, &workshop), WOBBLE_OK);
  EXPECT_EQ(workshop.body + workshop.particle_count + workshop.spring_count, 0U);
  EXPECT_EQ(wobble_read_particle(without.client, 0, &particle), WOBBLE_BAD_INDEX);
}

TEST(Rules, ChangesOrdersAndTuningReachTheServerAsTheyAre) {
  Building joined;
  auto change = Make<wobble_change>();
  change.kind = WOBBLE_ADD_SPRING, change.a = 10, change.b = 0xFFFF;
  change.at[2] = 3, change.mass = 4, change.fixed = 1, change.stiffness = 5, change.damping = 6, change.rest_length = 7;
  const float gravity[3] = {1, 2, -3};
  EXPECT_EQ(wobble_build(joined.client, &change), WOBBLE_OK);
  EXPECT_EQ(wobble_tune(joined.client, WOBBLE_JUMP_AHEAD, gravity), WOBBLE_OK);
  EXPECT_EQ(wobble_order(joined.client, "kick 7"), WOBBLE_OK);
  ASSERT_TRUE(joined.RunUntil([&] { return !joined.world->ordered.empty(); }));
  EXPECT_EQ(joined.world->ordered, "kick 7");
  EXPECT_EQ(joined.world->tuned.first, wire::TuneKind::Jump);
  EXPECT_EQ(joined.world->tuned.second.z, -3);
  const protocol::BuildFields& built = joined.world->built;
  EXPECT_EQ(built.kind, wire::BuildKind::AddSpring);
  EXPECT_EQ(built.a, 10);
  EXPECT_EQ(built.b, 0xFFFF);
  EXPECT_EQ(built.at.z, 3);
  EXPECT_EQ(built.mass, 4);
  EXPECT_TRUE(built.fixed);
  EXPECT_EQ(built.stiffness, 5);
  EXPECT_EQ(built.damping, 6);
  EXPECT_EQ(built.restLength, 7);
  EXPECT_EQ(joined.world->badMessages, 0);
}

TEST(Rules, WhatNoServerWouldTakeIsNotSent) {
  Building joined;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto change = [&](auto&& spoil) {
    auto made = Make<wobble_change>();
    spoil(made);
    return wobble_build(joined.client, &made);
  };
  EXPECT_EQ(change([](wobble_change&) {}), WOBBLE_OK);
  EXPECT_EQ(change([](wobble_change& c) { c.kind = -1; }), WOBBLE_BAD_VALUE);
  EXPECT_EQ(change([](wobble_change& c) { c.kind = 6; }), WOBBLE_BAD_VALUE);
  EXPECT_EQ(change([](wobble_change& c) { c.a = 0x10000; }), WOBBLE_BAD_VALUE);
  EXPECT_EQ(change([](wobble_change& c) { c.b = 0x10000; }), WOBBLE_BAD_VALUE);
  EXPECT_EQ(change([](wobble_change& c) { c.fixed = 2; }), WOBBLE_BAD_VALUE);
  EXPECT_EQ(change([&](wobble_change& c) { c.at[1] = nan; }), WOBBLE_BAD_VALUE);
  EXPECT_EQ(change([&](wobble_change& c) { c.mass = nan; }), WOBBLE_BAD_VALUE);
  EXPECT_EQ(change([&](wobble_change& c) { c.rest_length = HUGE_VALF; }), WOBBLE_BAD_VALUE);
  const float good[3] = {1, 0, 0}, bad[3] = {0, nan, 0};
  EXPECT_EQ(wobble_tune(joined.client, 4, good), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_tune(joined.client, -1, good), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_tune(joined.client, WOBBLE_TUNE_GRAVITY, bad), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_order(joined.client, ""), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_order(joined.client, std::string(201, 'a').c_str()), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_order(joined.client, std::string(5000, 'a').c_str()), WOBBLE_BAD_VALUE);
  EXPECT_EQ(wobble_order(joined.client, std::string(200, 'a').c_str()), WOBBLE_OK);
  ASSERT_TRUE(joined.RunUntil([&] { return joined.world->ordered.size() == 200; }));
  EXPECT_EQ(joined.world->badMessages, 0);
}

TEST(Rules, TuningAndScoresAreThoseThatCameLast) {
  Building joined;
  joined.world->Send(protocol::MakeTuning({{1, 2, -3}, 0.5F, 0.25F, protocol::kMayTuneTime}));
  joined.world->Send(protocol::MakeScoreboard({.phase = wire::GamePhase::Won,
                                               .round = 3,
                                               .secondsLeft = 8,
                                               .pointsToWin = 5,
                                               .winner = 9,
                                               .scores = {{9, 5, 2}, {12, 1, 0}},
                                               .rounds = 4,
                                               .seats = {{1, true, false}, {2, false, true}},
                                               .sides = {{5, 2}, {1, 0}},
                                               .winningSide = 1,
                                               .object = 77,
                                               .bearer = 12}));
  auto board = Make<wobble_scoreboard>();
  ASSERT_TRUE(joined.RunUntil(
      [&] { return wobble_read_scoreboard(joined.client, &board) == WOBBLE_OK && board.score_count == 2; }));
  EXPECT_EQ(board.phase, WOBBLE_ROUND_WON);
  EXPECT_EQ(board.round, 3U);
  EXPECT_EQ(board.seconds_left, 8U);
  EXPECT_EQ(board.points_to_win, 5U);
  EXPECT_EQ(board.winner, 9U);
  EXPECT_STREQ(board.game, "sumo");
  EXPECT_EQ(board.rounds, 4U);
  EXPECT_EQ(board.winning_side, 1U);
  EXPECT_EQ(board.side_points[0], 5U);
  EXPECT_EQ(board.side_points[1], 1U);
  EXPECT_EQ(board.side_rounds[0], 2U);
  EXPECT_EQ(board.object, 77U);
  EXPECT_EQ(board.bearer, 12U);
  auto score = Make<wobble_score>();
  ASSERT_EQ(wobble_read_score(joined.client, 0, &score), WOBBLE_OK);
  EXPECT_EQ(score.client_id, 9U);
  EXPECT_EQ(score.points, 5U);
  EXPECT_EQ(score.rounds, 2U);
  EXPECT_EQ(score.side, 1U);
  EXPECT_EQ(score.ready, 1);
  EXPECT_EQ(score.bot, 0);
  EXPECT_EQ(wobble_read_score(joined.client, 2, &score), WOBBLE_BAD_INDEX);
  auto tuning = Make<wobble_tuning>();
  ASSERT_EQ(wobble_read_tuning(joined.client, &tuning), WOBBLE_OK);
  EXPECT_EQ(tuning.may, std::uint32_t{WOBBLE_MAY_TUNE_TIME});
  EXPECT_EQ(tuning.gravity[1], 2);
  EXPECT_EQ(tuning.gravity[2], -3);
  EXPECT_EQ(tuning.stiffness, 0.5F);
  EXPECT_EQ(tuning.time_rate, 0.25F);
}

// A program that was compiled before the rank was there.
TEST(Rules, AnOlderProgramsStatusStaysAsLongAsItIs) {
  Building joined;
  auto status = Make<wobble_status>();
  status.struct_size = offsetof(wobble_status, rank);
  status.rank = 77;
  ASSERT_EQ(wobble_read_status(joined.client, &status), WOBBLE_OK);
  EXPECT_EQ(status.own_body, kOwnBody);
  EXPECT_EQ(status.rank, 77);
}

}  // namespace
}  // namespace wobble::c
