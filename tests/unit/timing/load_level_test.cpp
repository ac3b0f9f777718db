// Load levels: the controller by itself, then a whole game on a simulated machine whose speed the test sets.
#include "server/timing/load_level.h"

#include <gtest/gtest.h>

#include "tests/support/game.h"

namespace wobble::server {
namespace {

constexpr double kTick = 1.0 / 60;

// Records ticks that take `share` of their budget for a number of seconds. Returns the time at the end.
double Feed(LoadController& load, double share, double seconds, double now, double rate = 1) {
  for (const double end = now + seconds; now < end;) {
    now += std::max(kTick / rate, share * kTick);
    load.Record(share * kTick, rate, now);
  }
  return now;
}

TEST(LoadController, NothingIsDoneWhileThereIsTime) {
  LoadController load(kTick);
  double now = Feed(load, 0.75, 20, 0);
  EXPECT_EQ(load.Level(), LoadLevel::kNormal);
  EXPECT_NEAR(load.Share(), 0.75, 1e-9);
  for (int i = 0; i < 20; ++i) {  // once a second a tick of six times its budget
    load.Record(6 * kTick, 1, now += 6 * kTick);
    now = Feed(load, 0.3, 1, now);
    EXPECT_EQ(load.Level(), LoadLevel::kNormal);
  }
}

TEST(LoadController, TakesOneMeasureAfterTheOther) {
  LoadController load(kTick);
  double now = Feed(load, 0.85, 0.9, 0);
  EXPECT_EQ(load.Level(), LoadLevel::kNormal) << "above the limit for less than a second";
  now = Feed(load, 0.85, 10, now);
  EXPECT_EQ(load.Level(), LoadLevel::kCoarser) << "one level, which suffices";
  now = Feed(load, 1.0, 1, now);
  EXPECT_EQ(load.Level(), LoadLevel::kBusy);
  EXPECT_EQ(load.RateLimit(), 1);
  now = Feed(load, 0.85, 10, now);
  EXPECT_EQ(load.Level(), LoadLevel::kBusy) << "the level suffices";
  now = Feed(load, 2.0, 1, now);
  EXPECT_EQ(load.Level(), LoadLevel::kSlowed);
  EXPECT_NEAR(load.RateLimit(), 0.45, 0.01);
  Feed(load, 100, 2, now);
  EXPECT_EQ(load.RateLimit(), kLeastRate);
}

TEST(LoadController, IsBackToNormalWithinTwoSeconds) {
  for (const double share : {1.2, 2.0, 4.0}) {
    LoadController load(kTick);
    double now = Feed(load, share, 10, 0);
    ASSERT_EQ(load.Level(), LoadLevel::kSlowed);
    // The tick that runs when the load ends, then as many as the rate limit lets through.
    const double gone = now;
    while (load.Level() != LoadLevel::kNormal && now < gone + 10) {
      now += kTick / load.RateLimit();
      load.Record(0.3 * kTick, 1, now);
    }
    EXPECT_LT(now - gone, 2) << share;
  }
}

TEST(LoadController, AMeasureIsKeptWhereGivingItUpWouldBringTheLoadBack) {
  LoadController load(kTick);
  double now = Feed(load, 1.0, 1.8, 0);
  ASSERT_EQ(load.Level(), LoadLevel::kBusy);
  now = Feed(load, 0.78, 20, now);
  EXPECT_EQ(load.Level(), LoadLevel::kBusy);
  Feed(load, 0.70, 1, now);
  EXPECT_EQ(load.Level(), LoadLevel::kCoarser);
}

TEST(LoadController, SlowMotionLeavesTicksMoreTime) {
  LoadController load(kTick);
  Feed(load, 1.4, 20, 0, 0.5);
  EXPECT_NEAR(load.Share(), 0.7, 1e-9);
  EXPECT_EQ(load.Level(), LoadLevel::kNormal);
}

// A game on a simulated machine: the clock with which the server measures advances by `share` of a tick in each step of
// the world, and the next call comes when the last one is over.
class SlowMachine {
 public:
  explicit SlowMachine(int players, scenes::Scene scene = test::MakeYard(), const Config& config = {})
      : game(std::move(scene), config, 1, [this] { return Work(); }) {
    m_isRunning = true;
    for (int i = 0; i < players; ++i) game.AddClient();
  }

  void Step() {
    game.now = std::max(game.now, game.server.NextCall());
    const double before = Work();
    game.server.Tick(game.now);
    game.now += Work() - before;
    for (auto& client : game.clients) client->Update(game.now);
  }
  void Run(double seconds) {
    for (const double end = game.now + seconds; game.now < end;) Step();
  }

  double share = 0.1;  // of a tick's budget
  test::Game game;

 private:
  double Work() {
    const std::uint32_t tick = m_isRunning ? game.server.World().Tick() : 0;
    m_work += (tick - m_tick) * share * kTick;
    m_tick = tick;
    return m_work;
  }

  bool m_isRunning = false;
  double m_work = 0;
  std::uint32_t m_tick = 0;
};

void ExpectEveryonePlays(const SlowMachine& machine) {
  for (const auto& client : machine.game.clients) EXPECT_EQ(client->ReadState(), client::State::kPlaying);
  EXPECT_EQ(machine.game.server.ReadCounts().disconnects, 0U);
}

TEST(Overload, TwiceTooMuchGoesSlowerAndNobodyIsLost) {
  SlowMachine machine(8);
  machine.Run(3);
  ExpectEveryonePlays(machine);
  machine.share = 2;
  machine.Run(4);
  const Server& server = machine.game.server;
  EXPECT_EQ(server.ReadLoad().Level(), LoadLevel::kSlowed);
  EXPECT_EQ(server.SnapshotHz(), 20);
  EXPECT_FALSE(server.AcceptsJoins());
  const std::uint64_t dropped = server.Clock().DroppedTicks();
  const std::uint32_t tick = server.World().Tick();
  machine.Run(60);
  EXPECT_EQ(server.Clock().DroppedTicks(), dropped) << "the world is slowed, so no tick is dropped";
  EXPECT_NEAR(server.World().Tick() - tick, 60 * 60 * 0.45, 30);
  EXPECT_NEAR(server.Clock().SlowedTicks(), 60 * 61 * 0.55, 60);
  for (const auto& client : machine.game.clients) {
    EXPECT_NEAR(client->ReadStatistics().timeRatio, 0.45, 0.01) << "published in every snapshot";
    EXPECT_EQ(client->ReadTuning().timeRate, 1) << "the rate that players asked for is unchanged";
  }
  ExpectEveryonePlays(machine);
}

TEST(Overload, FourTimesTooMuchGoesAQuarterAsFast) {
  SlowMachine machine(8);
  machine.Run(3);
  machine.share = 4;
  machine.Run(40);
  EXPECT_EQ(machine.game.server.ReadLoad().RateLimit(), kLeastRate);
  for (const auto& client : machine.game.clients) EXPECT_NEAR(client->ReadStatistics().timeRatio, 0.25, 0.01);
  ExpectEveryonePlays(machine);
}

TEST(Overload, IsOverWithinTwoSeconds) {
  for (const double share : {2.0, 4.0}) {
    SlowMachine machine(4);
    machine.Run(3);
    machine.share = share;
    machine.Run(10);
    machine.share = 0.3;
    machine.Run(2);
    const Server& server = machine.game.server;
    EXPECT_EQ(server.ReadLoad().Level(), LoadLevel::kNormal) << share;
    EXPECT_EQ(server.SnapshotHz(), 30) << share;
    EXPECT_GT(machine.game.clients[0]->ReadStatistics().timeRatio, 0.99) << share;
    auto& late = machine.game.AddClient();
    machine.Run(1);
    EXPECT_EQ(late.ReadState(), client::State::kPlaying) << share;
  }
}

TEST(Overload, WhoComesMeanwhileIsToldThatTheServerIsBusy) {
  SlowMachine machine(2);
  machine.Run(2);
  machine.share = 2;
  machine.Run(5);
  auto& late = machine.game.AddClient();
  machine.Run(1);
  ASSERT_EQ(late.ReadState(), client::State::kEnded);
  EXPECT_NE(late.EndReason().find("server is busy"), std::string::npos) << late.EndReason();
  const auto busy = static_cast<std::size_t>(protocol::wire::GoodbyeReason::Busy);
  EXPECT_EQ(machine.game.server.ReadCounts().goodbyes[busy], 1U);
  EXPECT_EQ(machine.game.server.CountPlaying(), 2U);
}

TEST(Overload, WhoComesMeanwhileIsLetInWhereThatIsAskedFor) {
  SlowMachine machine(2, test::MakeYard(), {.admitsWhenBusy = true});
  machine.Run(2);
  machine.share = 2;
  machine.Run(5);
  ASSERT_EQ(machine.game.server.ReadLoad().Level(), LoadLevel::kSlowed);
  EXPECT_TRUE(machine.game.server.AcceptsJoins());
  auto& late = machine.game.AddClient();
  machine.Run(1);
  EXPECT_EQ(late.ReadState(), client::State::kPlaying);
}

TEST(Overload, NoStepIsLeftOutOrMadeLonger) {
  const auto play = [](double share) {
    SlowMachine machine(0, test::LoadShippedScene("arena"), {.pauseAfter = 0});
    machine.share = share;
    while (machine.game.server.World().Tick() < 300) machine.Step();
    return machine.game.server.World().Hash();
  };
  EXPECT_EQ(play(0.1), play(3));
}

TEST(Overload, AWorldThatHasWaitedBeginsAnew) {
  SlowMachine machine(1, test::MakeYard(), {.pauseAfter = 1});
  machine.Run(1);
  machine.share = 3;
  machine.Run(5);
  machine.game.clients[0]->Leave(machine.game.now);
  machine.Run(4);
  ASSERT_TRUE(machine.game.server.IsPaused());
  machine.share = 0.1;
  auto& next = machine.game.AddClient();
  machine.Run(1);
  EXPECT_EQ(next.ReadState(), client::State::kPlaying);
  EXPECT_EQ(machine.game.server.SnapshotHz(), 30);
  EXPECT_GT(machine.game.server.Clock().TimeRatio(), 0.98) << "the world is no longer slowed";
}

}  // namespace
}  // namespace wobble::server
