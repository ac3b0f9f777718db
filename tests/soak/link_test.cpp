// Whole games over the worst links, on virtual time: which clients join and stay, the reasons given to the others, and
// that no burst of packets follows a black-out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/game.h"

namespace wobble::test {
namespace {

// Players that run in circles, each at its own pace, and counts of the bytes that both sides send.
class Crowd {
 public:
  Crowd(int players, const server::Config& config, std::uint64_t seed) : game(MakeYard(), config, seed) {
    for (int i = 0; i < players; ++i) {
      auto transport = game.network.MakeClient();
      m_transports.push_back(transport.get());
      client::Options options;
      options.decode = false;
      game.clients.push_back(std::make_unique<client::Client>(std::move(transport), options, 0));
    }
  }
  void Run(double seconds) {
    for (const double end = game.now + seconds; game.now < end; game.Step()) {
      for (std::size_t i = 0; i < game.clients.size(); ++i) {
        const double angle = game.now * (1 + 0.1 * static_cast<double>(i));
        game.clients[i]->SetInput({.moveX = static_cast<float>(std::cos(angle)),
                                   .moveY = static_cast<float>(std::sin(angle)),
                                   .jump = std::fmod(angle, 7) < 0.1});
      }
    }
  }
  [[nodiscard]] std::size_t CountIn(client::State state) const {
    return static_cast<std::size_t>(std::count_if(game.clients.begin(), game.clients.end(),
                                                  [&](const auto& each) { return each->ReadState() == state; }));
  }
  [[nodiscard]] double BytesUp() const {
    double bytes = 0;
    for (const transport::Transport* each : m_transports) bytes += static_cast<double>(each->ReadStatistics().bytesOut);
    return bytes;
  }
  [[nodiscard]] double BytesDown() const { return static_cast<double>(game.server.ReadTransport().bytesOut); }

  Game game;

 private:
  std::vector<const transport::Transport*> m_transports;
};

TEST(Link, AllJoinAndStayWithASecondOfDelayAndAQuarterLostEachWay) {
  for (const std::uint64_t seed : {1, 2}) {
    Crowd crowd(16, {}, seed);
    crowd.game.network.SetConditions({.loss = 0.25, .delay = 1, .jitter = 0.1, .duplicate = 0.25});
    crowd.Run(40);
    EXPECT_EQ(crowd.CountIn(client::State::kPlaying), 16U) << "seed " << seed;
    EXPECT_EQ(crowd.game.server.ReadCounts().joins, 16U);
    EXPECT_EQ(crowd.game.server.ReadCounts().disconnects, 0U);
    EXPECT_EQ(crowd.game.server.ReadCounts().refusals, 0U);
    for (const auto& each : crowd.game.clients) {
      EXPECT_EQ(each->EndReason(), "");
      EXPECT_NEAR(each->ReadStatistics().inputToSnapshot, 2.1, 0.5);  // and the players' inputs reach the world
    }
  }
}

TEST(Link, APlayerWhoLosesNineOfTenPacketsIsToldAndTheServerDropsThem) {
  Crowd crowd(8, {}, 1);
  crowd.Run(5);
  ASSERT_EQ(crowd.CountIn(client::State::kPlaying), 8U);
  crowd.game.network.SetConditions({.loss = 0.9});
  crowd.Run(32);  // two windows of 16 s; the first began earlier
  EXPECT_EQ(crowd.CountIn(client::State::kEnded), 8U);
  for (const auto& each : crowd.game.clients) {
    EXPECT_TRUE(each->EndedUnasked());
    EXPECT_NE(each->EndReason().find("connection too poor: "), std::string::npos) << each->EndReason();
  }
  crowd.Run(12);  // the goodbye may be lost; silence ends the connection
  EXPECT_TRUE(crowd.game.server.IsEmpty());
  EXPECT_EQ(crowd.game.server.ReadCounts().disconnects, 8U);
}

TEST(Link, JoiningWithNineOfTenPacketsLostEndsInPlayOrInAReasonInTime) {
  Crowd crowd(32, {}, 1);
  crowd.game.network.SetConditions({.loss = 0.9, .delay = 0.05});
  crowd.Run(90);
  EXPECT_EQ(crowd.CountIn(client::State::kEnded), 32U);
  for (const auto& each : crowd.game.clients) EXPECT_FALSE(each->EndReason().empty());
  crowd.Run(12);
  EXPECT_TRUE(crowd.game.server.IsEmpty());
}

// The link is down for 2 s of every 10 s, and the budget is always used up, so that packets accumulate.
TEST(Link, BlackoutsOfTwoSecondsDropNobodyAndNoStormFollows) {
  server::Config config;
  config.clientKbit = 100;
  Crowd crowd(8, config, 1);
  crowd.game.network.SetConditions({.delay = 0.03, .jitter = 0.01, .blackout = {2, 10}});
  crowd.Run(4);
  ASSERT_EQ(crowd.CountIn(client::State::kPlaying), 8U);
  for (int round = 0; round < 4; ++round) {
    const double up = crowd.BytesUp(), down = crowd.BytesDown();
    crowd.Run(4);  // up, until just before the black-out
    const double steadyUp = (crowd.BytesUp() - up) / 16, steadyDown = (crowd.BytesDown() - down) / 16;
    ASSERT_GT(steadyUp, 0);
    ASSERT_GT(steadyDown, 0);
    for (int quarter = 0; quarter < 24; ++quarter) {  // the black-out and the time after it
      const double upBefore = crowd.BytesUp(), downBefore = crowd.BytesDown();
      crowd.Run(0.25);
      EXPECT_LE(crowd.BytesUp() - upBefore, 1.5 * steadyUp) << quarter;
      EXPECT_LE(crowd.BytesDown() - downBefore, 1.5 * steadyDown) << quarter;
    }
  }
  EXPECT_EQ(crowd.CountIn(client::State::kPlaying), 8U);
  EXPECT_EQ(crowd.game.server.ReadCounts().disconnects, 0U);
  EXPECT_GT(crowd.game.network.CountsToClients().lost, 1000U);
}

TEST(Link, AWideLinkIsGivenAllThatItsPlayerSees) {
  Crowd crowd(24, {}, 1);
  crowd.game.network.SetConditions({.delay = 0.03, .jitter = 0.02});
  crowd.Run(8);
  const server::SendCounts before = crowd.game.server.ReadSendCounts();
  crowd.Run(3);
  const server::SendCounts& after = crowd.game.server.ReadSendCounts();
  EXPECT_EQ(after.bodiesLeftOut, before.bodiesLeftOut);
  EXPECT_LT(after.bodiesCoarsened - before.bodiesCoarsened, 24 * 24 * 90 / 100) << "1 % of all bodies sent";
}

// As many bytes as pass, and neither a standing queue nor more loss than snapshots bear.
TEST(Link, ANarrowLinkIsFoundAndNotOverfilled) {
  for (const double rate : {300e3, 600e3}) {
    Crowd crowd(24, {}, 1);
    crowd.game.network.SetConditions({.delay = 0.03, .jitter = 0.01, .rate = rate});
    crowd.Run(8);
    const transport::LinkCounts before = crowd.game.network.CountsToClients();
    const double bytes = crowd.BytesDown();
    crowd.Run(20);
    const transport::LinkCounts& after = crowd.game.network.CountsToClients();
    EXPECT_LT(static_cast<double>(after.lost - before.lost), 0.02 * static_cast<double>(after.sent - before.sent));
    const double used = 8 * (crowd.BytesDown() - bytes) / 20 / 24;
    EXPECT_GT(used, 0.7 * rate);
    EXPECT_LT(used, rate);
    for (const auto& each : crowd.game.clients) EXPECT_LT(each->ReadStatistics().snapshotAge, 0.2);
    EXPECT_EQ(crowd.CountIn(client::State::kPlaying), 24U);
  }
}

}  // namespace
}  // namespace wobble::test
