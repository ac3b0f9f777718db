// Which input acts at which tick.
#include "server/input_buffer.h"

#include <gtest/gtest.h>

namespace wobble::server {
namespace {

using protocol::wire::InputFrame;

constexpr std::uint32_t kHold = 6;  // 100 ms at 60 Hz

TEST(InputBuffer, AnInputIsUsedAtItsTick) {
  InputBuffer buffer;
  buffer.Add(InputFrame(12, 50, -60, 2), 10);
  EXPECT_EQ(buffer.Take(11, kHold).move_x(), 0);
  EXPECT_EQ(buffer.NewestUsed(), 0U);
  const InputFrame used = buffer.Take(12, kHold);
  EXPECT_EQ(used.move_x(), 50);
  EXPECT_EQ(used.move_y(), -60);
  EXPECT_EQ(used.buttons(), 2);
  EXPECT_EQ(buffer.NewestUsed(), 12U);
}

TEST(InputBuffer, ALateInputIsUsedAtTheNextTick) {
  InputBuffer buffer;
  for (std::uint32_t tick = 1; tick <= 20; ++tick) (void)buffer.Take(tick, kHold);
  buffer.Add(InputFrame(14, 77, 0, 0), 20);
  EXPECT_EQ(buffer.Take(21, kHold).move_x(), 77);
  EXPECT_EQ(buffer.NewestUsed(), 14U);
}

TEST(InputBuffer, OfSeveralLateInputsTheNewestMovesAndAllPressesCount) {
  InputBuffer buffer;
  buffer.Add(InputFrame(10, 1, 0, 0), 20);
  buffer.Add(InputFrame(12, 3, 0, 4), 20);
  buffer.Add(InputFrame(11, 2, 0, 1), 20);  // pressed and released between two ticks
  const InputFrame used = buffer.Take(21, kHold);
  EXPECT_EQ(used.move_x(), 3);
  EXPECT_EQ(used.buttons(), 5);
  // The press acts once; then the newest frame is held.
  EXPECT_EQ(buffer.Take(22, kHold).buttons(), 4);
}

TEST(InputBuffer, HoldsForAHundredMillisecondsThenStandsStill) {
  InputBuffer buffer;
  buffer.Add(InputFrame(10, 90, 9, 2), 9);
  for (std::uint32_t tick = 10; tick <= 10 + kHold; ++tick) {
    EXPECT_EQ(buffer.Take(tick, kHold).move_x(), 90) << tick;
    EXPECT_EQ(buffer.NewestUsed(), 10U);
  }
  for (std::uint32_t tick = 11 + kHold; tick < 60; ++tick) {
    const InputFrame still = buffer.Take(tick, kHold);
    EXPECT_EQ(still.move_x(), 0) << tick;
    EXPECT_EQ(still.move_y(), 0);
    EXPECT_EQ(still.buttons(), 0);
  }
  buffer.Add(InputFrame(60, 5, 0, 0), 59);
  EXPECT_EQ(buffer.Take(60, kHold).move_x(), 5);
}

// Frames come in bursts, with the same gap between them each time.
TEST(InputBuffer, HoldsAsLongAsGapsLatelyWere) {
  for (const std::uint32_t gap : {8U, 15U, 20U}) {
    InputBuffer buffer;
    std::uint64_t starvedBefore = 0;
    std::uint32_t tick = 1;
    const auto playBurst = [&] {
      for (int i = 0; i < 5; ++i, ++tick) {
        buffer.Add(InputFrame(tick, 90, 0, 0), tick);
        EXPECT_EQ(buffer.Take(tick, kHold).move_x(), 90);
      }
      starvedBefore = buffer.CountStarved();
      for (std::uint32_t i = 1; i < gap; ++i, ++tick) (void)buffer.Take(tick, kHold);
    };
    playBurst();
    EXPECT_EQ(buffer.CountStarved(), gap - 1 - kHold) << "of the first nothing is known";
    for (int i = 0; i < 5; ++i) playBurst();
    EXPECT_EQ(buffer.CountStarved() - starvedBefore, gap <= 15 ? 0 : gap - 1 - 15) << gap;
    // Ten seconds without such a gap: it is forgotten.
    for (int i = 0; i < 605; ++i, ++tick) {
      buffer.Add(InputFrame(tick, 90, 0, 0), tick);
      (void)buffer.Take(tick, kHold);
    }
    const std::uint64_t before = buffer.CountStarved();
    playBurst();
    EXPECT_EQ(buffer.CountStarved() - before, gap - 1 - kHold);
  }
}

TEST(InputBuffer, RepeatedFramesChangeNothing) {
  InputBuffer once;
  InputBuffer often;
  for (std::uint32_t tick = 1; tick <= 200; ++tick) {
    const auto frame = [](std::uint32_t stamp) {
      return InputFrame(stamp, static_cast<std::int8_t>(stamp % 100), 0, stamp % 13 == 0 ? 1 : 0);
    };
    once.Add(frame(tick), tick - 1);
    for (std::uint32_t back = 0; back < 4 && back < tick; ++back) often.Add(frame(tick - back), tick - 1);
    often.Add(frame(tick), tick - 1);
    const InputFrame a = once.Take(tick, kHold);
    const InputFrame b = often.Take(tick, kHold);
    EXPECT_EQ(a.move_x(), b.move_x());
    EXPECT_EQ(a.buttons(), b.buttons());
    EXPECT_EQ(a.buttons(), tick % 13 == 0 ? 1 : 0);
  }
}

TEST(InputBuffer, WhatHasBeenUsedIsNotUsedAgain) {
  InputBuffer buffer;
  buffer.Add(InputFrame(5, 10, 0, 1), 4);
  EXPECT_EQ(buffer.Take(5, kHold).buttons(), 1);
  buffer.Add(InputFrame(6, 10, 0, 0), 5);
  (void)buffer.Take(6, kHold);
  buffer.Add(InputFrame(5, 10, 0, 1), 6);  // a late duplicate
  EXPECT_EQ(buffer.Take(7, kHold).buttons(), 0);
  EXPECT_EQ(buffer.NewestUsed(), 6U);
}

TEST(InputBuffer, FarFutureIsNotNear) {
  EXPECT_TRUE(InputBuffer::IsNear(InputFrame(100 + protocol::kMaxInputLeadTicks, 0, 0, 0), 100));
  EXPECT_FALSE(InputBuffer::IsNear(InputFrame(101 + protocol::kMaxInputLeadTicks, 0, 0, 0), 100));
  EXPECT_FALSE(InputBuffer::IsNear(InputFrame(0xFFFFFFFF, 0, 0, 0), 100));
  EXPECT_TRUE(InputBuffer::IsNear(InputFrame(0, 0, 0, 0), 100));  // past ticks always are
}

TEST(InputBuffer, InputsFarAheadSurviveTheRing) {
  // One client as far ahead as allowed, another as late as is kept: 127 ticks in a ring of 128, for many rounds.
  InputBuffer buffer;
  for (std::uint32_t tick = 0; tick < 1000; ++tick) {
    const std::uint32_t stamp = tick + protocol::kMaxInputLeadTicks;
    buffer.Add(InputFrame(stamp, static_cast<std::int8_t>(stamp % 120), 0, 0), tick);
    const InputFrame used = buffer.Take(tick + 1, kHold);
    if (tick + 1 < protocol::kMaxInputLeadTicks) {
      EXPECT_EQ(used.move_x(), 0) << tick;
    } else {
      EXPECT_EQ(used.tick(), tick + 1);
      EXPECT_EQ(used.move_x(), static_cast<int>((tick + 1) % 120));
    }
  }
}

// Over a second of delay each way, at 60 Hz.
TEST(InputBuffer, InputsTwoSecondsLateAreUsedAllTheSame) {
  InputBuffer buffer;
  for (std::uint32_t tick = 200; tick < 600; ++tick) {
    buffer.Add(InputFrame(tick - 126, static_cast<std::int8_t>(tick % 120), 0, 0), tick);
    const InputFrame used = buffer.Take(tick + 1, kHold);
    EXPECT_EQ(used.tick(), tick - 126);
    EXPECT_EQ(used.move_x(), static_cast<int>(tick % 120));
  }
}

TEST(InputBuffer, AnOldInputDoesNotPushOutANewerOneFromItsSlot) {
  InputBuffer buffer;
  buffer.Add(InputFrame(1010, 9, 0, 0), 1000);
  buffer.Add(InputFrame(1010 - 2 * protocol::kMaxInputLeadTicks, 8, 0, 0), 1000);
  EXPECT_EQ(buffer.Take(1010, kHold).move_x(), 9);
}

TEST(InputBuffer, AStampFromARoundAgoIsNotTakenForNew) {
  InputBuffer buffer;
  buffer.Add(InputFrame(5, 10, 0, 1), 4);
  (void)buffer.Take(5, kHold);
  // 128 ticks later the same slot is read again.
  for (std::uint32_t tick = 6; tick < 300; ++tick) {
    const InputFrame frame = buffer.Take(tick, kHold);
    EXPECT_EQ(frame.move_x(), tick <= 5 + kHold ? 10 : 0) << tick;
  }
  buffer.Add(InputFrame(300, 7, 0, 0), 299);
  EXPECT_EQ(buffer.Take(300, kHold).buttons(), 0);
}

}  // namespace
}  // namespace wobble::server
