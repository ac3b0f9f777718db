// A server that goes on from its state, on virtual time: players come back to their bodies, each once, and nobody stays
// whom nobody plays.
#include <gmock/gmock.h>

#include "tests/support/game.h"
#include "tests/unit/recording/matches.h"

namespace wobble::test {
namespace {

using recording::Identity;
using server::ClientId;

transport::Admission MakeAdmission(std::uint8_t who) {
  transport::Admission admission;
  admission.identity = Identity{who};
  return admission;
}

class Resumed : public testing::Test {
 protected:
  static constexpr const char* kScene = "pitch";

  // A game that keeps its state in the folder, and goes on from it if it is there.
  std::unique_ptr<Game> Start(double pauseAfter = 30) {
    auto game = std::make_unique<Game>(LoadShippedScene(kScene), server::Config{.pauseAfter = pauseAfter}, ++m_seed);
    auto checkpoints =
        std::make_unique<recording::Checkpoints>(m_folder.Path(), std::vector{recording::MakeHead(kScene)});
    const auto found = checkpoints->FindNewest();
    EXPECT_THAT(found.complaints, testing::IsEmpty());
    if (found.checkpoint) {
      EXPECT_EQ(game->server.Resume(*found.checkpoint, game->now), "");
    }
    game->server.KeepState(std::move(checkpoints));
    return game;
  }
  client::Client& Join(Game& game, std::uint8_t who, const std::string& name) {
    game.admission = MakeAdmission(who);
    client::Client& client = game.AddClient({.name = name});
    game.Run(1);
    EXPECT_EQ(client.ReadState(), client::State::kPlaying);
    return client;
  }

  recording::Folder m_folder;
  std::uint64_t m_seed = 0;
};

TEST_F(Resumed, PlayersComeBackToTheirBodiesOnce) {
  auto game = Start();
  const std::uint32_t first = Join(*game, 1, "Ada").Welcome().ownBody;
  const std::uint32_t second = Join(*game, 2, "Bo").Welcome().ownBody;
  game->Run(2);
  const std::size_t bodies = game->server.World().Bodies().size();
  const std::uint32_t tick = game->server.World().Tick();
  game.reset();  // the last checkpoint is written before

  game = Start();
  EXPECT_LE(tick - game->server.World().Tick(), 60U);
  EXPECT_EQ(game->server.World().Bodies().size(), bodies);
  EXPECT_EQ(game->server.CountEmptySeats(), 2U);
  client::Client& back = Join(*game, 2, "another name");
  EXPECT_EQ(back.Welcome().ownBody, second);
  EXPECT_EQ(game->server.ListPlayers(game->now)[0].name, "Bo");
  EXPECT_EQ(game->server.World().Bodies().size(), bodies);
  // A stranger, and one without any ticket, get bodies of their own.
  EXPECT_NE(Join(*game, 9, "Cy").Welcome().ownBody, first);
  EXPECT_NE(Join(*game, 0, "Di").Welcome().ownBody, first);
  EXPECT_EQ(game->server.World().Bodies().size(), bodies + 2);
  EXPECT_EQ(Join(*game, 1, "Ada").Welcome().ownBody, first);
  EXPECT_EQ(game->server.CountEmptySeats(), 0U);
  // The seat is taken: the same ticket in another tab is another player.
  EXPECT_NE(Join(*game, 1, "Ada").Welcome().ownBody, first);
}

TEST_F(Resumed, WhoDoesNotComeBackLeavesNoGhost) {
  auto game = Start();
  const std::size_t empty = game->server.World().Bodies().size();
  Join(*game, 1, "Ada");
  Join(*game, 0, "without a ticket");
  game->Run(2);
  game.reset();
  game = Start();
  EXPECT_EQ(game->server.CountEmptySeats(), 1U) << "who has no ticket cannot come back";
  EXPECT_EQ(game->server.World().Bodies().size(), empty + 1);
  game->Run(server::kSeatPatience + 1);
  EXPECT_EQ(game->server.CountEmptySeats(), 0U);
  EXPECT_EQ(game->server.World().Bodies().size(), empty);
}

TEST_F(Resumed, ADeadConnectionGivesWayToItsPlayer) {
  auto game = Start();
  game->admission = MakeAdmission(1);
  RawConnection& dead = game->AddRaw();
  game->Run(0.5);
  dead.Send(transport::Channel::kControl, protocol::MakeHello("Ada", protocol::wire::Role::Player));
  game->Run(2);
  ASSERT_EQ(game->server.ListPlayers(game->now).size(), 1U);
  const std::uint32_t body = game->server.World().Bodies().back().id;
  EXPECT_EQ(Join(*game, 1, "Ada").Welcome().ownBody, body);
  EXPECT_EQ(game->server.ListPlayers(game->now).size(), 1U);
}

TEST_F(Resumed, AnEmptyWorldThatWasPausedIsAsItWas) {
  auto game = Start(1);
  client::Client& client = Join(*game, 1, "Ada");
  game->Run(3);
  client.Leave(game->now);
  game->Run(4);
  ASSERT_TRUE(game->server.IsPaused());
  const std::uint64_t hash = game->server.World().Hash();
  const std::uint32_t tick = game->server.World().Tick();
  game.reset();
  game = Start(1);
  EXPECT_EQ(game->server.World().Hash(), hash);
  EXPECT_EQ(game->server.World().Tick(), tick);
}

}  // namespace
}  // namespace wobble::test
