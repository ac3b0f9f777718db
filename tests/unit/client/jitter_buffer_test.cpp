// Delay and playback of the jitter buffer, on virtual time with seeded lateness.
#include "client/jitter_buffer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace wobble::client {
namespace {

constexpr double kSnapshotInterval = 1.0 / 30;

TEST(ClientJitterBuffer, SpreadIsThe98thPercentileOfLateness) {
  for (const double jitter : {0.0, 0.020, 0.100, 0.300}) {
    JitterBuffer buffer;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> lateness(0, jitter + 1e-9);
    for (double now = 0; now < 10; now += 0.002) buffer.AddArrival(lateness(random), kSnapshotInterval, now);
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
    buffer.AddArrival(seconds, kSnapshotInterval, now);
  }
  EXPECT_LT(static_cast<double>(late) / all, 0.025);
  EXPECT_LT(buffer.TargetDelay(), 2 * kSnapshotInterval + 0.015 * 7);  // 7 means are exceeded by one in 1,100
}

TEST(ClientJitterBuffer, DelayStaysWithinItsBounds) {
  JitterBuffer quick;
  quick.AddArrival(0, 1.0 / 240, 0);
  EXPECT_EQ(quick.TargetDelay(), kMinDelay);
  JitterBuffer slow;
  slow.AddArrival(30, kSnapshotInterval, 0);
  EXPECT_EQ(slow.TargetDelay(), kMaxDelay);
  JitterBuffer early;
  early.AddArrival(-5, kSnapshotInterval, 0);
  EXPECT_NEAR(early.TargetDelay(), 2 * kSnapshotInterval + 0.001, 1e-9);
}

TEST(ClientJitterBuffer, GrowsAtOnceAndShrinksSlowly) {
  JitterBuffer buffer;
  double now = 0;
  for (; now < 5; now += kSnapshotInterval) buffer.AddArrival(0.001, kSnapshotInterval, now);
  const double calm = buffer.TargetDelay();
  for (int i = 0; i < 3; ++i, now += kSnapshotInterval) buffer.AddArrival(0.150, kSnapshotInterval, now);
  const double rough = buffer.TargetDelay();
  EXPECT_NEAR(rough - calm, 0.149, 0.002);

  const double calmAgainAt = now;
  for (; now < calmAgainAt + 2; now += kSnapshotInterval) buffer.AddArrival(0.001, kSnapshotInterval, now);
  EXPECT_GT(buffer.TargetDelay(), rough - 0.05);
  for (; now < calmAgainAt + 30; now += kSnapshotInterval) buffer.AddArrival(0.001, kSnapshotInterval, now);
  EXPECT_NEAR(buffer.TargetDelay(), calm, 0.002);
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
    buffer.AddArrival(rough ? jitter(random) : 0.001, kSnapshotInterval, now);
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
  EXPECT_LE(largest, 1.1 + 1e-9);
  EXPECT_GT(largest, 1.005);
}

TEST(ClientJitterBuffer, DelaySettlesOnItsTarget) {
  JitterBuffer buffer;
  double now = 0;
  for (; now < 5; now += 0.010) {
    buffer.AddArrival(now < 2 ? 0.001 : 0.080, kSnapshotInterval, now);
    buffer.Advance(now, 1.0, now);
  }
  EXPECT_NEAR(buffer.Delay(), buffer.TargetDelay(), 0.001);
  EXPECT_NEAR(buffer.Delay(), 0.081 + 2 * kSnapshotInterval, 0.002);
}

TEST(ClientJitterBuffer, StandsStillOrLeapsWhenTheClockHasJumped) {
  JitterBuffer buffer;
  buffer.AddArrival(0, kSnapshotInterval, 0);
  buffer.Advance(100, 1.0, 0);
  const double before = buffer.Playback();
  EXPECT_EQ(buffer.Advance(90, 1.0, 0.1), before);
  EXPECT_NEAR(buffer.Advance(200, 1.0, 0.2), 200 - buffer.TargetDelay(), 1e-9);
}

}  // namespace
}  // namespace wobble::client
