// How world time follows wall time.
#include "server/timing/tick_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace wobble::server {
namespace {

constexpr double kTickLength = 1.0 / 60;

TEST(TickClock, SixtyTicksASecondForAnHour) {
  // Polled at uneven moments, about 250 times a second; the first tick is due at once.
  TickClock clock(kTickLength, 1000);
  std::uint64_t ticks = 0;
  std::uint32_t random = 1;
  double now = 1000;
  while (now < 4600) {
    ticks += static_cast<std::uint64_t>(clock.TakeDueTicks(now));
    ASSERT_EQ(clock.TimeRatio(), 1.0);
    random = random * 1664525 + 1013904223;
    now += 0.001 + 0.006 * static_cast<double>(random >> 8) / (1 << 24);
  }
  ticks += static_cast<std::uint64_t>(clock.TakeDueTicks(4600 + kTickLength / 2));
  EXPECT_EQ(ticks, 3600U * 60 + 1);
  EXPECT_EQ(clock.DroppedTicks(), 0U);
  EXPECT_NEAR(clock.NextTick(), 4600 + kTickLength, 1e-6);
}

TEST(TickClock, NothingIsDueBeforeItsTime) {
  TickClock clock(kTickLength, 5);
  EXPECT_EQ(clock.TakeDueTicks(5), 1);
  EXPECT_EQ(clock.TakeDueTicks(5), 0);
  EXPECT_EQ(clock.TakeDueTicks(5 + 0.9 * kTickLength), 0);
  EXPECT_EQ(clock.TakeDueTicks(clock.NextTick()), 1);
}

TEST(TickClock, StandingStillOwesNothing) {
  TickClock clock(kTickLength, 0);
  EXPECT_EQ(clock.TakeDueTicks(0), 1);
  for (double now = 0.02; now < 100; now += 0.02) clock.StandStill(now);
  clock.StandStill(100);
  EXPECT_EQ(clock.TakeDueTicks(100), 1);
  EXPECT_EQ(clock.TakeDueTicks(100 + 0.9 * kTickLength), 0);
  EXPECT_EQ(clock.TakeDueTicks(100 + 1.1 * kTickLength), 1);
  EXPECT_EQ(clock.DroppedTicks(), 0U);
  EXPECT_EQ(clock.TimeRatio(), 1);
}

TEST(TickClock, SlowMotionIsTheSameTickLessOften) {
  TickClock clock(kTickLength, 0);
  EXPECT_EQ(clock.TakeDueTicks(0), 1);
  clock.SetRate(0.25);
  EXPECT_EQ(clock.TimeRatio(), 0.25);
  int ticks = 0;
  for (int i = 1; i <= 1000; ++i) ticks += clock.TakeDueTicks(0.016 * i);
  EXPECT_NEAR(ticks, 16 * 60 * 0.25, 2);
  EXPECT_EQ(clock.TimeRatio(), 0.25);
  EXPECT_EQ(clock.DroppedTicks(), 0U);
}

TEST(TickClock, AJumpIsTakenAFewTicksACall) {
  TickClock clock(kTickLength, 0);
  EXPECT_EQ(clock.TakeJumpTicks(), 0);
  clock.Jump(0.1);
  int ticks = 0, calls = 0;
  for (int taken = clock.TakeJumpTicks(); taken > 0; taken = clock.TakeJumpTicks()) ticks += taken, ++calls;
  EXPECT_EQ(ticks, 6);
  EXPECT_GT(calls, 1);
  for (int i = 0; i < 1000; ++i) clock.Jump(10);
  for (ticks = 0; const int taken = clock.TakeJumpTicks();) ticks += taken;
  EXPECT_LE(ticks, 3600) << "repeated jumps are bounded";
}

TEST(TickClock, CatchesUpThreeAtMostAndDropsTheRest) {
  TickClock clock(kTickLength, 0);
  EXPECT_EQ(clock.TakeDueTicks(0), 1);
  EXPECT_EQ(clock.TakeDueTicks(3.5 * kTickLength), 3);
  EXPECT_EQ(clock.DroppedTicks(), 0U);
  EXPECT_EQ(clock.TimeRatio(), 1.0);
  EXPECT_EQ(clock.TakeDueTicks(13.5 * kTickLength), 3);  // ten are owed
  EXPECT_EQ(clock.DroppedTicks(), 7U);
  EXPECT_LT(clock.TimeRatio(), 1.0);
  EXPECT_EQ(clock.TakeDueTicks(13.6 * kTickLength), 0);  // seven are dropped
  EXPECT_EQ(clock.TakeDueTicks(14.1 * kTickLength), 1);
  EXPECT_EQ(clock.DroppedTicks(), 7U);
}

TEST(TickClock, TheRatioFallsToTheTruthAndRecovers) {
  // Called every six ticks of wall time: three are taken, three dropped.
  TickClock clock(kTickLength, 0);
  double now = 0;
  int ticks = 0;
  for (; now < 10; now += 6 * kTickLength) ticks += clock.TakeDueTicks(now);
  EXPECT_NEAR(clock.TimeRatio(), 0.5, 0.01);
  EXPECT_NEAR(ticks, 300, 5);
  EXPECT_NEAR(static_cast<double>(clock.DroppedTicks()), 300, 5);

  now -= 6 * kTickLength;  // the moment of the last call
  const std::uint64_t dropped = clock.DroppedTicks();
  double last = clock.TimeRatio();
  for (const double end = now + 1; now < end; now += kTickLength) {
    (void)clock.TakeDueTicks(now);
    EXPECT_GE(clock.TimeRatio(), last);
    last = clock.TimeRatio();
  }
  EXPECT_NEAR(last, 1 - 0.5 * std::exp(-1.0), 0.03);  // smoothed over a second
  for (const double end = now + 9; now < end; now += kTickLength) (void)clock.TakeDueTicks(now);
  EXPECT_EQ(clock.TimeRatio(), 1.0);
  EXPECT_EQ(clock.DroppedTicks(), dropped);
}

TEST(TickClock, ALongPauseIsNotPlayedBack) {
  TickClock clock(kTickLength, 0);
  (void)clock.TakeDueTicks(0);
  EXPECT_EQ(clock.TakeDueTicks(3600), 3);
  EXPECT_EQ(clock.DroppedTicks(), 3600U * 60 - 3);
  EXPECT_GE(clock.TimeRatio(), 0.0);
  EXPECT_LT(clock.TimeRatio(), 0.01);
  EXPECT_GT(clock.NextTick(), 3600.0);
  EXPECT_LE(clock.NextTick(), 3600 + kTickLength);
}

}  // namespace
}  // namespace wobble::server
