// Virtual time, no processes.
#include "client/host/keeper.h"

#include <gtest/gtest.h>

#include <vector>

namespace wobble::host {
namespace {

using State = Keeper::State;
constexpr int kKilled = 137;

// Starts it when it is due, and lets it die after `life` seconds of being ready; none: it dies while it starts. Returns
// how long it waited.
double LiveAndDie(Keeper& keeper, double& now, double life) {
  const double wait = keeper.WaitLeft(now);
  EXPECT_EQ(keeper.IsDue(now), wait == 0);
  now += wait;
  EXPECT_TRUE(keeper.IsDue(now));
  keeper.NoteStart(now);
  if (life > 0) keeper.NoteReady(now);
  now += life;
  keeper.NoteEnd(now, kKilled);
  EXPECT_EQ(keeper.ReadState(), State::kWaiting);
  return wait;
}

TEST(Keeper, StartsAtOnceAndThenWaitsTwiceAsLongEachTimeUpToTheMost) {
  Keeper keeper;
  double now = 100;
  std::vector<double> waits;
  for (int death = 0; death < 10; ++death) waits.push_back(LiveAndDie(keeper, now, death % 2));
  EXPECT_EQ(waits, (std::vector<double>{0, 0.25, 0.5, 1, 2, 4, 8, 16, 30, 30}));
  EXPECT_EQ(keeper.Deaths(), 10U);
}

TEST(Keeper, WaitsTheLeastAgainOnceItRanWell) {
  Keeper keeper;
  double now = 0;
  for (int death = 0; death < 6; ++death) static_cast<void>(LiveAndDie(keeper, now, 1));
  EXPECT_EQ(LiveAndDie(keeper, now, 9.9), 8);
  EXPECT_EQ(LiveAndDie(keeper, now, 10), 16);
  EXPECT_EQ(LiveAndDie(keeper, now, 1), 0.25);
}

TEST(Keeper, CountsRestartsAndTheTimeDown) {
  Keeper keeper;
  keeper.NoteStart(0);
  keeper.NoteEnd(1, kKilled);  // before it was ready: nobody lost it
  EXPECT_EQ(keeper.SecondsDown(2), 0);
  keeper.NoteStart(2);
  keeper.NoteReady(3);
  EXPECT_EQ(keeper.Restarts(), 0U);
  keeper.NoteEnd(50, kKilled);
  EXPECT_EQ(keeper.SecondsDown(50.5), 0.5);
  keeper.NoteStart(51);
  keeper.NoteEnd(52, kKilled);
  keeper.NoteStart(53);
  keeper.NoteReady(54);
  EXPECT_EQ(keeper.SecondsDown(99), 4);
  EXPECT_EQ(keeper.Restarts(), 1U);
  EXPECT_EQ(keeper.Deaths(), 3U);
}

TEST(Keeper, DoesNotStartAgainWhatRefusesItsOptionsOrEndedAsAsked) {
  for (const int code : {2, 126, 127}) {
    Keeper keeper;
    keeper.NoteStart(0);
    keeper.NoteReady(1);
    keeper.NoteEnd(2, code);
    EXPECT_EQ(keeper.ReadState(), State::kGivenUp) << code;
    EXPECT_FALSE(keeper.IsDue(1e6)) << code;
    keeper.AskToEnd();
    EXPECT_EQ(keeper.ReadState(), State::kGivenUp) << code;
  }
  Keeper keeper;
  keeper.NoteStart(0);
  keeper.NoteReady(1);
  keeper.NoteEnd(2, 0);
  EXPECT_EQ(keeper.ReadState(), State::kEnded);
  EXPECT_FALSE(keeper.IsDue(1e6));
}

TEST(Keeper, EndsFromEveryStateAndStaysSo) {
  Keeper waiting, starting, running;
  for (Keeper* each : {&starting, &running}) each->NoteStart(0);
  running.NoteReady(1);
  for (Keeper* each : {&waiting, &starting, &running}) each->AskToEnd();
  EXPECT_EQ(waiting.ReadState(), State::kEnded);
  for (Keeper* each : {&starting, &running}) {
    EXPECT_EQ(each->ReadState(), State::kEnding);
    each->NoteEnd(2, kKilled);
    EXPECT_EQ(each->ReadState(), State::kEnded);
    EXPECT_EQ(each->Deaths(), 0U);
    EXPECT_FALSE(each->IsDue(1e6));
  }
}

TEST(Keeper, SaysWhenAStartIsLate) {
  Keeper keeper({.startPatience = 7});
  EXPECT_FALSE(keeper.IsLate(1e6));
  keeper.NoteStart(10);
  EXPECT_FALSE(keeper.IsLate(16.9));
  EXPECT_TRUE(keeper.IsLate(17));
  keeper.NoteReady(17);
  EXPECT_FALSE(keeper.IsLate(1e6));
}

}  // namespace
}  // namespace wobble::host
