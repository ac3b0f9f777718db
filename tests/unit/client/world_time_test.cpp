// The age of snapshots against the truth: a server and a client on one clock, and trips that the test draws.
#include "client/world_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace wobble::client {
namespace {

constexpr double kTick = 1.0 / 60;
constexpr double kHeldUpAt = 0.6;  // s

struct Trips {
  double least = 0.02;  // s, one way
  double jitter = 0;    // s, evenly spread above it
};

struct Play {
  Trips up, down;
  double pollEvery = 0.001;  // s
  double phase = 0;          // of the client's inputs within a tick, share
  double heldUpFor = 0;      // s, from kHeldUpAt on: what arrives meanwhile is stamped with its beginning
  double seconds = 20;
  double judgeFrom = 5;  // s
};

// The mean error of the ages, s; from judgeFrom on.
double FindAgeError(const Play& play) {
  std::mt19937 random(3);
  const auto draw = [&](const Trips& trips) {
    return trips.least + trips.jitter * static_cast<double>(random() % 1000) / 1000;
  };
  WorldTime time;
  Statistics statistics;
  protocol::WelcomeFields welcome;
  welcome.tickHz = 60;
  welcome.snapshotHz = 30;
  time.Start(welcome, play.down.least, statistics);
  time.BeginPlay(play.down.least);
  double errors = 0;
  int count = 0, newestInput = -1;
  for (int tick = 2; tick * kTick < play.seconds; tick += 2) {
    const double taken = tick * kTick;
    // The input that this tick has used: the newest that had come.
    int input = newestInput;
    for (int i = newestInput + 1; (i + play.phase) * kTick < taken; ++i) {
      if ((i + play.phase) * kTick + draw(play.up) <= taken) input = i;
    }
    const double arrives = taken + draw(play.down);
    double seen = std::ceil(arrives / play.pollEvery) * play.pollEvery;
    if (seen > kHeldUpAt && seen <= kHeldUpAt + play.heldUpFor) seen = kHeldUpAt;
    const double echo = input > newestInput ? seen - (input + play.phase) * kTick : -1;
    newestInput = input;
    const SnapshotArrival arrival =
        time.AddSnapshot({.tick = static_cast<std::uint32_t>(tick), .timeRatio = 1}, echo, seen, statistics);
    if (taken < play.judgeFrom) continue;
    errors += arrival.age - (seen - taken);
    ++count;
  }
  return errors / count;
}

TEST(ClientWorldTime, TheAgeOfSnapshotsIsTrueToAQuarterOfATick) {
  for (const double trip : {0.002, 0.02, 0.05, 0.15}) {
    for (const double phase : {0.05, 0.3, 0.55, 0.8}) {
      for (const double jitter : {0.0, 0.02}) {
        const double error = FindAgeError({.up = {trip, jitter}, .down = {trip, jitter}, .phase = phase});
        EXPECT_LE(std::fabs(error), kTick / 4 + 0.002) << trip << " s, phase " << phase << ", jitter " << jitter;
      }
    }
  }
}

// A program that was held up between reading its clock and reading its socket sees an echo that is shorter than the
// round trip. It spoils the estimate for half a minute, not for the whole stay.
TEST(ClientWorldTime, AnEchoTooShortIsForgotten) {
  const Play play{
      .up = {0.05, 0.01}, .down = {0.05, 0.01}, .phase = 0.3, .heldUpFor = 0.08, .seconds = 60, .judgeFrom = 35};
  EXPECT_LE(std::fabs(FindAgeError(play)), kTick / 4 + 0.002);
}

// Only the sum of the trips can be measured from one end.
TEST(ClientWorldTime, UnequalTripsAreTakenForEqual) {
  const double error = FindAgeError({.up = {0.08, 0}, .down = {0.02, 0}, .phase = 0.5});
  EXPECT_NEAR(error, 0.03, kTick / 4 + 0.002);
}

}  // namespace
}  // namespace wobble::client
