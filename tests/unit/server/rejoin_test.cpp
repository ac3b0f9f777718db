// A server that is killed and started again, on virtual time: its players come back by themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "client/lasting_client.h"
#include "tests/support/game.h"

namespace wobble::test {
namespace {

using client::LastingState;

// A server that can be away, and players who last.
class Restarts : public testing::Test {
 protected:
  Restarts() { MakeNetwork(); }
  // Finds everybody who asks just now, as a server does whose players' clients repeat their requests.
  void Open() { server = std::make_unique<server::Server>(server::Config{}, MakeYard(), network->MakeServer(), now); }
  // Without a goodbye; who asks gets no answer.
  void Kill() {
    server.reset();
    MakeNetwork();
  }
  void AddPlayers(std::size_t count, double patience = 60) {
    for (std::uint64_t i = 0; i < count; ++i) {
      client::LastingOptions options;
      options.client.name = "player " + std::to_string(i);
      options.rejoin = {.patience = patience, .seed = i};
      options.connect = [this](std::string&) { return network->MakeClient(); };
      players.push_back(std::make_unique<client::LastingClient>(network->MakeClient(), options, now));
    }
  }
  void Run(double seconds) {
    for (const double end = now + seconds; now < end; now += 1.0 / 60) {
      if (server != nullptr) server->Tick(now);
      for (auto& player : players) player->Update(now);
    }
  }
  [[nodiscard]] std::size_t Count(LastingState state) const {
    return static_cast<std::size_t>(
        std::count_if(players.begin(), players.end(), [&](const auto& each) { return each->ReadState() == state; }));
  }
  // Seconds until all play; 30 at most.
  [[nodiscard]] double AwaitAll() {
    const double begin = now;
    while (now < begin + 30 && Count(LastingState::kPlaying) < players.size()) Run(1.0 / 60);
    return now - begin;
  }

  std::unique_ptr<transport::VirtualNetwork> network;
  std::unique_ptr<server::Server> server;
  std::vector<std::unique_ptr<client::LastingClient>> players;
  double now = 0;

 private:
  void MakeNetwork() {
    network = std::make_unique<transport::VirtualNetwork>(transport::VirtualNetworkOptions{.seed = ++m_seed});
    network->SetConditions({.loss = 0.02, .delay = 0.04, .jitter = 0.02});
  }

  std::uint64_t m_seed = 0;
};

TEST_F(Restarts, EverybodyIsBackWithinFiveSeconds) {
  Open();
  AddPlayers(8);
  ASSERT_LT(AwaitAll(), 5);
  std::uint64_t restarts = 0;
  for (const double away : {1.2, 0.1, 30.0}) {
    Run(12);
    Kill();
    Run(away);
    EXPECT_EQ(Count(LastingState::kRejoining), 8U);
    Open();
    EXPECT_LT(AwaitAll(), 5) << "after " << away << " s";
    EXPECT_EQ(server->ReadCounts().joins, 8U);
    ++restarts;
    for (const auto& player : players) EXPECT_EQ(player->CountRejoins(), restarts);
  }
  Run(2);
  std::vector<client::BodySample> samples;
  for (const auto& player : players) {
    player->Current().Sample(now, client::Detail::kVertices, samples);
    EXPECT_EQ(samples.size(), 9U);
  }
}

// Both ends give the link up, and the server has room for its players again.
TEST_F(Restarts, ABlackoutThatEndsTheConnectionsIsOvercome) {
  Open();
  AddPlayers(4);
  ASSERT_LT(AwaitAll(), 5);
  network->SetBlackout(true);
  Run(protocol::kSilenceTimeout + 4);
  EXPECT_EQ(Count(LastingState::kRejoining), 4U);
  network->SetBlackout(false);
  EXPECT_LT(AwaitAll(), 5);
  EXPECT_EQ(server->ReadCounts().joins, 8U);
}

TEST_F(Restarts, AServerThatStaysAwayIsGivenUp) {
  Open();
  AddPlayers(3, 20);
  ASSERT_LT(AwaitAll(), 5);
  Kill();
  Run(19);
  EXPECT_EQ(Count(LastingState::kRejoining), 3U);
  Run(2);
  ASSERT_EQ(Count(LastingState::kEnded), 3U);
  for (const auto& player : players) {
    EXPECT_EQ(player->Reason(), "connection lost; gave up joining again after 20 s: no answer from the server");
  }
}

}  // namespace
}  // namespace wobble::test
