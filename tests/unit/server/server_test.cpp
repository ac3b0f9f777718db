// Server with clients on a virtual network: joining, moving, falling, pausing.
#include "server/server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/game.h"
#include "tests/unit/server/ear.h"

namespace wobble::server {
namespace {

using client::State;
using protocol::wire::EventKind;
using test::Ear;
using test::Game;
using test::MakeYard;

// Time until a body dropped on the yard lies still, s.
constexpr double kToRest = 5;

TEST(Server, AClientJoinsGetsBlueprintsAndPlays) {
  Game game(test::LoadShippedScene("arena"));
  auto& client = game.AddClient({"Ada"});
  const Ear ear(client);
  EXPECT_EQ(client.ReadState(), State::kConnecting);
  game.Run(0.5);
  ASSERT_EQ(client.ReadState(), State::kPlaying);
  EXPECT_LT(client.ReadStatistics().joinSeconds, 0.1);
  EXPECT_EQ(client.Welcome().scene, "arena");
  EXPECT_EQ(client.Welcome().tickHz, 60);
  EXPECT_EQ(client.Welcome().snapshotHz, 30);
  EXPECT_EQ(client.Welcome().obstacles.size(), 5U);
  EXPECT_EQ(client.Welcome().blueprintCount, 2);
  ASSERT_TRUE(game.HasBody(client.Welcome().ownBody));

  std::vector<client::BodySample> samples;
  client.Sample(game.now, client::Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), 13U);  // twelve balls and its own body
  for (const auto& sample : samples) {
    ASSERT_NE(sample.blueprint, nullptr);
    EXPECT_EQ(sample.blueprint->name, sample.body == client.Welcome().ownBody ? "player" : "ball");
    EXPECT_EQ(sample.vertices.size(), 162U);
  }
  EXPECT_EQ(ear.Count(EventKind::Join, client.Welcome().ownBody), 1);
  EXPECT_EQ(game.server.CountPlaying(), 1U);
  EXPECT_EQ(game.server.ReadCounts().joins, 1U);
  EXPECT_EQ(client.ReadStatistics().badMessages + client.ReadStatistics().badRecords, 0U);
}

TEST(Server, AClientHasTheGroundAndRoundObstaclesWhenItPlays) {
  scenes::Scene scene = MakeYard();
  physics::Obstacle ground;
  ground.kind = physics::Obstacle::Kind::kHeightField;
  ground.centre = physics::Vector3d(-20, 10, 2);
  std::vector<double> heights;
  for (int i = 0; i < 128 * 70; ++i) heights.push_back(0.5 * std::sin(0.2 * (i % 128)) + 0.1 * (i / 128));
  ground.field = physics::MakeHeightField(128, 0.25, heights);
  scene.obstacles.push_back(ground);
  physics::Obstacle sphere;
  sphere.kind = physics::Obstacle::Kind::kSphere;
  sphere.radius = 0.75;
  scene.obstacles.push_back(sphere);
  Game game(scene);
  auto& client = game.AddClient();
  while (client.ReadState() != State::kPlaying && game.now < 5) game.Step();
  ASSERT_EQ(client.ReadState(), State::kPlaying);
  ASSERT_EQ(client.Welcome().obstacles.size(), 2U);
  EXPECT_EQ(client.Welcome().obstacles[1].radius(), 0.75F);
  ASSERT_EQ(client.Grounds().size(), 1U);
  const client::Ground& shown = client.Grounds()[0];
  EXPECT_EQ(shown.columns, 128);
  ASSERT_EQ(shown.heights.size(), heights.size());
  for (std::size_t i = 0; i < heights.size(); i += 37) ASSERT_NEAR(shown.heights[i], 2 + heights[i], 1e-3) << i;
  EXPECT_EQ(client.ReadStatistics().badMessages, 0U);
}

TEST(Server, TheOwnBodyMovesWhenTheClientMoves) {
  Game game(MakeYard());
  auto& mover = game.AddClient();
  auto& other = game.AddClient();
  game.Run(kToRest);
  const physics::Vector3d start = game.Centre(mover.Welcome().ownBody);
  const physics::Vector3d otherStart = game.Centre(other.Welcome().ownBody);
  mover.SetInput({.moveX = 1});
  game.Run(0.5);
  const physics::Vector3d end = game.Centre(mover.Welcome().ownBody);
  EXPECT_GT(end.x() - start.x(), 0.5);
  EXPECT_LT(std::abs(end.y() - start.y()), 0.2);
  EXPECT_LT((game.Centre(other.Welcome().ownBody) - otherStart).norm(), 0.05);

  // Both clients show it: the newest pose is at most a snapshot and a trip behind.
  for (auto* client : {&mover, &other}) {
    const auto seen = client->NewestPose(mover.Welcome().ownBody);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(double{seen->centroid.x}, end.x(), 6.0 / 30 + 0.05);
    EXPECT_GT(double{seen->centroid.x}, start.x() + 0.3);
  }
}

TEST(Server, TheOwnBodyJumpsOnceAPress) {
  Game game(MakeYard());
  auto& client = game.AddClient();
  game.Run(kToRest);
  const std::uint32_t own = client.Welcome().ownBody;
  const double floor = game.Centre(own).z();
  client.SetInput({.jump = true});
  double highest = floor;
  int flights = 0;
  bool isUp = false;
  for (int i = 0; i < 240; ++i) {  // held for 4 s
    game.Step();
    const double height = game.Centre(own).z();
    highest = std::max(highest, height);
    const bool isFlight = height > floor + 1.2;  // the bounce after a flight of 2.1 m reaches 0.84 m
    if (!isUp && isFlight) ++flights;
    isUp = isFlight;
  }
  EXPECT_GT(highest, floor + 1);  // v²/2g = 1.8 m at 6 m/s, less what the jump takes from the shape
  EXPECT_EQ(flights, 1);
}

TEST(Server, AShortPressIsNotLost) {
  Game game(MakeYard());
  auto& client = game.AddClient();
  game.Run(kToRest);
  const double floor = game.Centre(client.Welcome().ownBody).z();
  client.SetInput({.jump = true});
  game.Step();
  client.SetInput({});
  double highest = floor;
  for (int i = 0; i < 60; ++i) {
    game.Step();
    highest = std::max(highest, game.Centre(client.Welcome().ownBody).z());
  }
  EXPECT_GT(highest, floor + 1);
}

TEST(Server, WhoFallsOffStartsAgainAndEverybodyHears) {
  Game game(MakeYard());
  auto& faller = game.AddClient();
  auto& watcher = game.AddClient();
  const Ear ear(watcher);
  game.Run(1);
  const std::uint32_t own = faller.Welcome().ownBody;
  faller.SetInput({.moveX = 1});
  double lowest = 0;
  for (int i = 0; i < 600 && game.server.ReadCounts().respawns == 0; ++i) {
    game.Step();
    lowest = std::min(lowest, game.Centre(own).z());
  }
  ASSERT_EQ(game.server.ReadCounts().respawns, 1U);
  EXPECT_LT(lowest, -4.5);
  EXPECT_GT(game.Centre(own).z(), 0.5);
  EXPECT_LT(game.Centre(own).head<2>().norm(), 2.2);  // on the circle where players start
  faller.SetInput({});
  game.Run(0.3);
  EXPECT_EQ(ear.Count(EventKind::Respawn, own), 1);
  EXPECT_TRUE(game.HasBody(own));
}

TEST(Server, ABallThatFallsOffStartsAgainWhereItWasPlaced) {
  scenes::Scene scene = MakeYard();
  scene.groups[0].position = {20, 0, 1};  // beside the floor
  Game game(std::move(scene));
  game.Run(2);
  EXPECT_GE(game.server.ReadCounts().respawns, 1U);
  EXPECT_NEAR(game.Centre(1).x(), 20, 1e-3);
  EXPECT_GT(game.Centre(1).z(), -5);
}

TEST(Server, SameCallsSameWorld) {
  const auto play = [] {
    Game game(test::LoadShippedScene("arena"));
    game.network.SetConditions(
        {.loss = 0.05, .delay = 0.05, .jitter = 0.02, .duplicate = 0.01, .reorder = 0.02, .reorderDelay = 0.05});
    for (int i = 0; i < 4; ++i) game.AddClient();
    for (int i = 0; i < 180; ++i) {
      for (int j = 0; j < 4; ++j) {
        const float turn = 0.05F * static_cast<float>(i) + static_cast<float>(j);
        game.clients[static_cast<std::size_t>(j)]->SetInput(
            {.moveX = std::sin(turn), .moveY = std::cos(turn), .jump = i % 50 == 0});
      }
      game.Step();
    }
    return game.server.World().Hash();
  };
  EXPECT_EQ(play(), play());
}

TEST(Server, AWorldWithoutAnybodyWaitsAndGoesOnForTheFirst) {
  Config config;
  config.pauseAfter = 2;
  test::Game game(test::MakeYard(), config);
  game.Run(1.9);
  EXPECT_FALSE(game.server.IsPaused());
  game.Run(0.2);
  EXPECT_TRUE(game.server.IsPaused());
  const std::uint32_t tick = game.server.World().Tick();
  EXPECT_NEAR(tick, 120, 2);
  const double begin = game.now;
  int calls = 0;
  for (; game.now < begin + 600; ++calls) game.Step();
  EXPECT_EQ(game.server.World().Tick(), tick);
  EXPECT_LE(calls, 600 * 20 + 1) << "a paused server is called 20 times a second";

  client::Client& client = game.AddClient();
  game.Run(1);
  EXPECT_FALSE(game.server.IsPaused());
  EXPECT_EQ(client.ReadState(), client::State::kPlaying);
  EXPECT_NEAR(game.server.World().Tick() - tick, 60, 4) << "the world resumes with the first packet";
  EXPECT_EQ(game.server.Clock().DroppedTicks(), 0U);
  EXPECT_EQ(game.server.Clock().TimeRatio(), 1);
  EXPECT_NEAR(game.server.ReadCounts().pausedTime, 600, 0.5);

  client.Leave(game.now);
  game.Run(1.5);
  EXPECT_FALSE(game.server.IsPaused()) << "the client may come back";
  game.Run(1.5);
  EXPECT_TRUE(game.server.IsPaused());
}

TEST(Server, AWorldThatNeedNotWaitDoesNot) {
  Config config;
  config.pauseAfter = 0;
  test::Game game(test::MakeYard(), config);
  game.Run(120);
  EXPECT_FALSE(game.server.IsPaused());
  EXPECT_NEAR(game.server.World().Tick(), 7200, 2);
}

// SIGSTOP, a laptop's lid, a virtual machine that moves: world time stands still, and the clients' clocks go on.
TEST(Server, InputsCountAgainHalfASecondAfterTheServerStoodStill) {
  test::Game game(test::MakeYard());
  client::Client& client = game.AddClient();
  game.Run(4);
  ASSERT_EQ(client.ReadState(), client::State::kPlaying);
  for (const double end = game.now + 5; game.now < end; game.now += 1.0 / 60) client.Update(game.now);
  while (game.server.NextCall() < game.now) game.server.Tick(game.now);  // it goes on
  game.Run(0.1);
  client.SetInput({.moveX = 1});
  const double before = game.Centre(client.Welcome().ownBody).x();
  game.Run(0.5);
  EXPECT_GT(game.Centre(client.Welcome().ownBody).x(), before + 0.02);
  EXPECT_EQ(game.server.ReadCounts().dropped[static_cast<std::size_t>(DropReason::kFutureInput)], 0U);
}

}  // namespace
}  // namespace wobble::server
