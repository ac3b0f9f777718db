// Delay and playback of the jitter buffer, on virtual time with seeded lateness.
#include "client/timing/jitter_buffer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace wobble::client {
namespace {

constexpr double kSnapshotInterval = 1.0 / 30;

// The snapshot of this moment comes so many seconds late.
void Arrive(JitterBuffer& buffer, double lateness, double interval, double now) {
  buffer.AddArrival({.worldTime = now, .lateness = lateness, .interval = interval, .now = now});
}

TEST(ClientJitterBuffer, SpreadIsThe98thPercentileOfLateness) {
  for (const double jitter : {0.0, 0.020, 0.100, 0.300}) {
    JitterBuffer buffer;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> lateness(0, jitter + 1e-9);
    for (double now = 0; now < 10; now += 0.002) Arrive(buffer, lateness(random), 0.002, now);
    EXPECT_NEAR(buffer.FindSpread(), 0.98 * jitter, 0.001 + 0.01 * jitter) << "jitter " << jitter;
  }
}

TEST(ClientJitterBuffer, FewArriveLaterThanTheDelayAllows) {
  // Long-tailed lateness at 30 packets a second: counts packets that are too late for their segment.
  std::mt19937 random(11);
  std::exponential_distribution<double> lateness(1 / 0.015);
  JitterBuffer buffer;
  int late = 0, all = 0;
  for (double now = 0; now < 300; now += kSnapshotInterval) {
    const double seconds = lateness(random);
    if (now > 3) {
      ++all;
      if (seconds > buffer.TargetDelay() - 2 * kSnapshotInterval) ++late;
    }
    Arrive(buffer, seconds, kSnapshotInterval, now);
  }
  EXPECT_LT(static_cast<double>(late) / all, 0.025);
  EXPECT_LT(buffer.TargetDelay(), 2 * kSnapshotInterval + 0.015 * 7);  // 7 means are exceeded by one in 1,100
}

TEST(ClientJitterBuffer, DelayStaysWithinItsBounds) {
  JitterBuffer quick;
  Arrive(quick, 0, 1.0 / 240, 0);
  quick.Advance(0, 1, 0);
  EXPECT_EQ(quick.TargetDelay(), kMinDelay);
  JitterBuffer slow;
  Arrive(slow, 30, kSnapshotInterval, 0);
  slow.Advance(0, 1, 0);
  EXPECT_EQ(slow.TargetDelay(), kMaxDelay);
  JitterBuffer early;
  Arrive(early, -5, kSnapshotInterval, 0);
  early.Advance(0, 1, 0);
  EXPECT_NEAR(early.TargetDelay(), 2 * kSnapshotInterval + 0.001, 1e-9);
}

TEST(ClientJitterBuffer, GrowsAtOnceAndShrinksSlowlyWhileTheLinkIsUneven) {
  JitterBuffer buffer;
  double now = 0;
  for (; now < 5; now += kSnapshotInterval) Arrive(buffer, 0.001, kSnapshotInterval, now);
  const double calm = buffer.TargetDelay();
  for (int i = 0; i < 4; ++i, now += kSnapshotInterval) Arrive(buffer, 0.150, kSnapshotInterval, now);
  const double rough = buffer.TargetDelay();
  EXPECT_NEAR(rough - calm, 0.149, 0.002);

  // One in 20 comes late: too few for the percentile after a while, too many to forget.
  const double unevenAt = now;
  for (int i = 0; now < unevenAt + 10; ++i, now += kSnapshotInterval) {
    Arrive(buffer, i % 20 == 0 ? 0.150 : 0.001, kSnapshotInterval, now);
    EXPECT_GT(buffer.TargetDelay(), rough - 0.01);
  }
}

TEST(ClientJitterBuffer, DelayIsShortAgainTwoSecondsAfterTheLinkIsGood) {
  JitterBuffer buffer;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> rough(0, 0.6);
  double now = 0;
  const auto play = [&](double until, const std::function<double()>& find) {
    for (int i = 0; now < until; ++i, now += kSnapshotInterval / 4) {
      if (i % 4 == 0) Arrive(buffer, find(), kSnapshotInterval, now);
      buffer.Advance(now, 1.0, now);
    }
  };
  play(10, [&] { return rough(random); });
  EXPECT_GT(buffer.Delay(), 0.45);
  play(12, [] { return 0.002; });
  EXPECT_LE(buffer.Delay(), 2 * kSnapshotInterval + 0.055);
}

// A black-out of a quarter of a second over TCP: nothing is lost, all comes at once.
TEST(ClientJitterBuffer, OfABurstTheNewestCounts) {
  JitterBuffer buffer;
  double now = 0;
  for (; now < 5; now += kSnapshotInterval) Arrive(buffer, 0.001, kSnapshotInterval, now);
  const double calm = buffer.TargetDelay();
  for (int blackout = 0; blackout < 3; ++blackout) {
    for (int i = 7; i >= 0; --i) {
      const double worldTime = now + (7 - i) * kSnapshotInterval;
      const double lateness = 0.004 + i * kSnapshotInterval;
      buffer.AddArrival({worldTime, lateness, kSnapshotInterval, now + 8 * kSnapshotInterval + 0.0002 * (7 - i)});
    }
    now += 9 * kSnapshotInterval;
    for (const double until = now + 10; now < until; now += kSnapshotInterval) {
      Arrive(buffer, 0.001, kSnapshotInterval, now);
      ASSERT_LT(buffer.TargetDelay(), calm + 0.005);
    }
  }
}

TEST(ClientJitterBuffer, WhatIsOlderThanTheNewestIsNotLate) {
  JitterBuffer buffer;
  for (double now = 0; now < 5; now += kSnapshotInterval) {
    Arrive(buffer, 0.001, kSnapshotInterval, now);
    const double overtaken = now - 10 * kSnapshotInterval;
    buffer.AddArrival({overtaken, 10 * kSnapshotInterval, kSnapshotInterval, now + kSnapshotInterval / 2});
  }
  EXPECT_NEAR(buffer.FindSpread(), 0.001, 0.001 + 1e-9);
}

TEST(ClientJitterBuffer, WhatComesBeforeItsTimeDoesNotCount) {
  JitterBuffer buffer;
  buffer.CountFrom(3);
  double now = 0;
  for (; now < 3; now += kSnapshotInterval) Arrive(buffer, 0.400, kSnapshotInterval, now);
  EXPECT_NEAR(buffer.TargetDelay(), 2 * kSnapshotInterval, 1e-9);
  for (; now < 4; now += kSnapshotInterval) Arrive(buffer, 0.020, kSnapshotInterval, now);
  EXPECT_NEAR(buffer.TargetDelay(), 0.021 + 2 * kSnapshotInterval, 1e-9);
}

// Snapshots of many packets come in a stream without gaps.
TEST(ClientJitterBuffer, CountsWhatComesInAStreamWithoutAnEnd) {
  JitterBuffer buffer;
  for (double now = 0; now < 2; now += 0.001) Arrive(buffer, 0.050, kSnapshotInterval, now);
  EXPECT_NEAR(buffer.FindSpread(), 0.051, 1e-9);
}

TEST(ClientJitterBuffer, PlaybackNeverRunsBackwardsAndKeepsItsRate) {
  JitterBuffer buffer;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> step(0.001, 0.030);
  std::uniform_real_distribution<double> jitter(0, 0.2);
  double now = 0, last = 0, lastNow = 0, smallest = 10, largest = 0;
  for (int i = 0; i < 20000; ++i) {
    now += step(random);
    const bool rough = std::fmod(now, 40) > 20;
    Arrive(buffer, rough ? jitter(random) : 0.001, kSnapshotInterval, now);
    const double playback = buffer.Advance(1000 + now, 1.0, now);
    if (i > 0) {
      const double rate = (playback - last) / (now - lastNow);
      smallest = std::min(smallest, rate);
      largest = std::max(largest, rate);
    }
    last = playback;
    lastNow = now;
  }
  EXPECT_GE(smallest, 0.9 - 1e-9);
  EXPECT_LT(smallest, 0.91);  // it had to adapt
  EXPECT_LE(largest, 1.5 + 1e-9);
  EXPECT_GT(largest, 1.1);
}

TEST(ClientJitterBuffer, DelaySettlesOnItsTarget) {
  JitterBuffer buffer;
  double now = 0;
  for (; now < 5; now += 0.010) {
    Arrive(buffer, now < 2 ? 0.001 : 0.080, kSnapshotInterval, now);
    buffer.Advance(now, 1.0, now);
  }
  EXPECT_NEAR(buffer.Delay(), buffer.TargetDelay(), 0.001);
  EXPECT_NEAR(buffer.Delay(), 0.081 + 2 * kSnapshotInterval, 0.002);
}

TEST(ClientJitterBuffer, StandsStillOrLeapsWhenTheClockHasJumped) {
  JitterBuffer buffer;
  Arrive(buffer, 0, kSnapshotInterval, 0);
  buffer.Advance(100, 1.0, 0);
  const double before = buffer.Playback();
  EXPECT_EQ(buffer.Advance(90, 1.0, 0.1), before);
  EXPECT_NEAR(buffer.Advance(200, 1.0, 0.2), 200 - buffer.TargetDelay(), 1e-9);
}

}  // namespace
}  // namespace wobble::client
