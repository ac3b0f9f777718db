// The client's clock against a server whose true time is known: virtual time, seeded delays.
#include "client/timing/clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

namespace wobble::client {
namespace {

constexpr double kTrip = 0.030;          // fastest one-way trip
constexpr double kInterval = 1.0 / 30;   // between snapshots
constexpr double kServerAhead = 1234.5;  // server's time when the client's is 0

struct Arrival {
  double at;
  double worldTime;
};

// Snapshots of a server in real time, in order of arrival, each delayed by kTrip + extra().
std::vector<Arrival> MakeArrivals(double seconds, const std::function<double()>& extra) {
  std::vector<Arrival> arrivals;
  for (double sent = 0; sent < seconds; sent += kInterval) {
    arrivals.push_back({sent + kTrip + extra(), sent + kServerAhead});
  }
  std::sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) { return a.at < b.at; });
  return arrivals;
}

// The expected estimate: a snapshot of this time would arrive now over the fastest trip.
double Expected(double now) { return now + kServerAhead - kTrip; }

TEST(ClientClock, SaysZeroBeforeTheFirstArrival) {
  const Clock clock;
  EXPECT_FALSE(clock.Started());
  EXPECT_EQ(clock.ServerTime(17.0), 0.0);
}

// Two seconds hold 60 snapshots. The fastest of them is over 5 ms late in one of 2,000 windows (0.875^57), so the bound
// holds nearly always, and is never missed by much.
TEST(ClientClock, ConvergesUnderJitterWithinFiveMilliseconds) {
  int all = 0, off = 0;
  double worst = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> jitter(0, 0.040);
    std::bernoulli_distribution isSpike(0.05);
    Clock clock;
    for (const Arrival& arrival : MakeArrivals(30, [&] { return jitter(random) + (isSpike(random) ? 0.2 : 0.0); })) {
      clock.AddArrival(arrival.worldTime, 1.0, arrival.at);
      if (arrival.at < 2.0) continue;
      const double error = std::fabs(clock.ServerTime(arrival.at) - Expected(arrival.at));
      worst = std::max(worst, error);
      ++all;
      if (error > 0.005) ++off;
    }
  }
  std::printf("%d of %d arrivals off by more than 5 ms, worst %.2f ms\n", off, all, worst * 1000);
  EXPECT_LE(off, all / 1000);
  EXPECT_LT(worst, 0.008);
}

TEST(ClientClock, TakesABetterOffsetAtOnceWhileStartingUp) {
  Clock clock;
  clock.AddArrival(10.0, 1.0, 1.0);  // 200 ms late
  clock.AddArrival(10.3, 1.0, 1.1);
  EXPECT_NEAR(clock.ServerTime(1.1), 10.3, 1e-12);
}

TEST(ClientClock, FollowsASlowerRouteWithoutAJumpAndAtABoundedRate) {
  Clock clock;
  double last = 0;
  double largest = 0, smallest = 10;
  const double reroutedAt = 5.0;
  for (const Arrival& arrival : MakeArrivals(12, [] { return 0.0; })) {
    const double extra = arrival.at > reroutedAt ? 0.1 : 0.0;
    const double begin = arrival.at + extra;
    clock.AddArrival(arrival.worldTime, 1.0, begin);
    for (double now = begin; now < begin + kInterval - 0.002; now += 0.001) {
      if (last > 0 && now > begin) {
        const double rate = (clock.ServerTime(now) - last) / 0.001;
        largest = std::max(largest, rate);
        smallest = std::min(smallest, rate);
      }
      last = clock.ServerTime(now);
    }
  }
  EXPECT_GE(smallest, 0.9 - 1e-6);
  EXPECT_LT(smallest, 0.95);  // it had to slow down
  EXPECT_LE(largest, 1.1 + 1e-6);
  EXPECT_NEAR(clock.ServerTime(12.2), Expected(12.2) - 0.1, 0.001);
}

// In a minute every packet takes 12 ms longer for five seconds: the estimate follows, the lateness shows it.
TEST(ClientClock, LatenessRemembersTheFastestTripThroughASlowSpell) {
  Clock clock;
  for (const Arrival& arrival : MakeArrivals(60, [] { return 0.0; })) {
    const bool slow = arrival.at > 20 && arrival.at < 25;
    clock.AddArrival(arrival.worldTime, 1.0, arrival.at + (slow ? 0.012 : 0));
    ASSERT_NEAR(clock.Lateness(), slow ? 0.012 : 0, 1e-6) << "at " << arrival.at;
  }
}

TEST(ClientClock, JumpsWhenItIsFarOff) {
  Clock clock;
  for (const Arrival& arrival : MakeArrivals(3, [] { return 0.0; })) {
    clock.AddArrival(arrival.worldTime, 1.0, arrival.at);
  }
  clock.AddArrival(2000.0, 1.0, 3.5);
  EXPECT_NEAR(clock.ServerTime(3.5), 2000.0, 1e-9);
}

TEST(ClientClock, SlowsDownWithAServerThatFallsBehind) {
  // From second 5 on the world runs at half speed; the ratio is published as the mean of the last second.
  Clock clock;
  const auto worldTime = [](double wall) { return wall < 5 ? wall : 5 + 0.5 * (wall - 5); };
  for (double sent = 0; sent < 15; sent += kInterval) {
    const double ratio = sent < 1 ? 1.0 : worldTime(sent) - worldTime(sent - 1);
    clock.AddArrival(worldTime(sent), ratio, sent + kTrip);
    if (sent < 9) continue;
    EXPECT_NEAR(clock.ServerTime(sent + kTrip), worldTime(sent), 0.005) << "at " << sent;
  }
  const double now = 15.0;
  EXPECT_NEAR(clock.ServerTime(now + 1) - clock.ServerTime(now), 0.5, 0.01);
}

TEST(ClientClock, OutlivesAnyTickAndRatio) {
  Clock clock;
  std::mt19937 random(7);
  double now = 0;
  for (int i = 0; i < 10000; ++i) {
    now += std::uniform_real_distribution<double>(0, 0.1)(random);
    clock.AddArrival(static_cast<double>(random()) / 60, static_cast<double>(random() % 3) - 1, now);
    ASSERT_TRUE(std::isfinite(clock.ServerTime(now)));
  }
}

}  // namespace
}  // namespace wobble::client
