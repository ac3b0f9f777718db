// A server that goes from scene to scene with everybody taken along, as clients see it, on virtual time.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "client/lasting_client.h"
#include "server/recording/verify.h"
#include "tests/support/game.h"
#include "tests/support/places.h"
#include "tests/unit/recording/matches.h"
#include "tests/unit/server/ear.h"

namespace wobble::server {
namespace {

using protocol::wire::EventKind;
using test::Ear;
using test::Game;
using test::LoadShippedScene;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RotationScene LoadForRotation(const std::string& name) {
  scenes::LoadResult loaded = scenes::LoadScene(name, test::FindSource("server/scenes"));
  EXPECT_THAT(loaded.errors, IsEmpty());
  if (loaded.scene.game.kind == scenes::GameRules::Kind::kSumo) loaded.scene.game.roundSeconds = 3;
  return {.scene = std::move(loaded.scene), .source = std::move(loaded.source), .bases = {}};
}

// Of these scenes, the first one is played.
std::unique_ptr<Game> MakeGame(const std::vector<std::string>& names, Config config = {}) {
  config.afterMatch = AfterMatch::kNext;
  std::vector<RotationScene> scenes;
  for (const std::string& name : names) scenes.push_back(LoadForRotation(name));
  auto game = std::make_unique<Game>(scenes.front().scene, config);
  game->server.Rotate(std::move(scenes));
  return game;
}

std::size_t CountBad(const client::Client& client) {
  const client::Statistics& statistics = client.ReadStatistics();
  return statistics.badMessages + statistics.badRecords + statistics.badSnapshots;
}

// The client plays the server's scene, and shows each of its bodies where it is.
void ExpectShown(Game& game, client::Client& client) {
  ASSERT_EQ(client.ReadState(), client::State::kPlaying) << client.EndReason();
  EXPECT_EQ(client.Welcome().scene, game.server.SceneName());
  std::vector<client::BodySample> samples;
  client.Sample(game.now, client::Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), game.server.World().Bodies().size());
  for (const client::BodySample& sample : samples) {
    const physics::Vector3d at = game.Centre(sample.body);
    const protocol::Vector3& shown = sample.pose.centroid;
    EXPECT_LT((physics::Vector3d(double{shown.x}, double{shown.y}, double{shown.z}) - at).norm(), 1)
        << "body " << sample.body;
  }
  EXPECT_EQ(CountBad(client), 0U);
}

TEST(Rotation, EverybodyComesAlongOverEachLink) {
  struct Link {
    double loss, delay, jitter;
  };
  for (const Link link : {Link{0, 0, 0}, Link{0.2, 0.05, 0.03}}) {
    SCOPED_TRACE(link.loss);
    auto game = MakeGame({"pitch", "pair", "curtain"});
    game->network.SetConditions({.loss = link.loss, .delay = link.delay, .jitter = link.jitter});
    client::Client& ada = game->AddClient({"Ada"});
    client::Client& bob = game->AddClient({"Bob"});
    client::Client& wim = game->AddClient({.name = "Wim", .spectator = true});
    game->Run(5);
    std::vector<std::string> scenes;
    ada.OnNextScene([&](const std::string& scene) { scenes.push_back(scene); });
    for (const std::string next : {"pair", "curtain", "pitch", "pair"}) {
      SCOPED_TRACE(next);
      ASSERT_EQ(game->server.GoToNextScene(), "");
      game->Run(0.02);
      EXPECT_EQ(game->server.SceneName(), next);
      EXPECT_EQ(game->server.CountPlaying(), 3U) << "who comes along is in";
      game->Run(6);
      for (client::Client* each : {&ada, &bob, &wim}) ExpectShown(*game, *each);
      EXPECT_EQ(wim.Welcome().ownBody, 0U);
    }
    EXPECT_THAT(scenes, ElementsAre("pair", "curtain", "pitch", "pair"));
    const Counts& counts = game->server.ReadCounts();
    EXPECT_EQ(counts.joins, 3U);
    EXPECT_EQ(counts.disconnects + counts.leaves, 0U);
    for (const DropReason reason : {DropReason::kParse, DropReason::kOutOfOrder, DropReason::kBadAcknowledgement}) {
      EXPECT_EQ(counts.dropped[static_cast<std::size_t>(reason)], 0U) << Name(reason);
    }
  }
}

TEST(Rotation, RankNameNumberAndMutenessComeAlong) {
  auto game = MakeGame({"pitch", "pair"});
  client::Client& ada = game->AddClient({"Ada"});
  client::Client& other = game->AddClient({"Ada"});
  game->Run(1);
  const Ear ear(ada);
  ASSERT_TRUE(game->server.SetRank(1, transport::Rank::kModerator));
  ASSERT_TRUE(game->server.Mute(2));
  ASSERT_EQ(game->server.GoToNextScene(), "");
  game->Run(2);
  const auto players = game->server.ListPlayers(game->now);
  ASSERT_EQ(players.size(), 2U);
  EXPECT_EQ(players[0].name, "Ada");
  EXPECT_EQ(players[0].admission.rank, transport::Rank::kModerator);
  EXPECT_EQ(players[1].name, "Ada 2");
  EXPECT_TRUE(players[1].isMuted);
  EXPECT_GT(players[1].seconds, 2.5) << "since it connected";
  EXPECT_EQ(ada.Welcome().clientId, 1U);
  EXPECT_EQ(ada.Welcome().rank, protocol::wire::Rank::Moderator);
  EXPECT_EQ(ear.Count(EventKind::Join, ada.Welcome().ownBody), 1);
  EXPECT_EQ(ear.Count(EventKind::Join, other.Welcome().ownBody), 1);
}

// What was sent for the scene before arrives in the next: commands that name a body, an open hand, acknowledgements.
TEST(Rotation, WhatIsUnderWayFromTheSceneBeforeHarmsNothing) {
  auto game = MakeGame({"curtain", "pitch"});
  game->network.SetConditions({.delay = 0.2, .jitter = 0.1});
  client::Client& ada = game->AddClient({"Ada"});
  game->Run(3);
  const std::uint64_t torn = game->server.ReadCounts().torn;
  ada.OnNextScene([&](const std::string&) { ADD_FAILURE() << "too early"; });
  ASSERT_EQ(game->server.GoToNextScene(), "");
  // It knows nothing of it for 0.2 s.
  for (int i = 0; i < 10; ++i) {
    ada.Push(1, 0, {0, 0, 1});
    ada.Cut(1, {0, -4, 1.5F}, {-3, 3, 1.5F}, {3, 3, 1.5F});
    ada.SetHand(client::Hand{.body = 1, .vertex = 0, .target = {5, 5, 5}});
    game->Step();
  }
  ada.OnNextScene({});
  game->Run(4);
  ExpectShown(*game, ada);
  const Counts& counts = game->server.ReadCounts();
  EXPECT_GE(counts.dropped[static_cast<std::size_t>(DropReason::kOldScene)], 20U);
  EXPECT_EQ(counts.goodbyes[static_cast<std::size_t>(protocol::wire::GoodbyeReason::BadMessages)], 0U);
  EXPECT_EQ(counts.torn, torn);
}

TEST(Rotation, WhoDoesNotComeAlongIsSentAwayAndLeavesNoGhost) {
  auto game = MakeGame({"pitch", "pair"});
  client::Client& ada = game->AddClient({"Ada"});
  test::RawConnection& mute = game->AddRaw();
  game->Run(0.5);
  mute.Send(transport::Channel::kControl, protocol::MakeHello("Mo", protocol::wire::Role::Player));
  game->Run(1);
  ASSERT_EQ(game->server.CountPlaying(), 2U);
  ASSERT_EQ(game->server.GoToNextScene(), "");
  game->Run(2);
  EXPECT_EQ(game->server.CountPlaying(), 2U);
  game->Run(8);
  EXPECT_EQ(mute.GoodbyeReason(), static_cast<int>(protocol::wire::GoodbyeReason::NoHello));
  EXPECT_EQ(game->server.CountPlaying(), 1U);
  EXPECT_EQ(game->server.ReadCounts().disconnects, 1U);
  EXPECT_EQ(game->server.ReadCounts().refusals, 0U);
  ExpectShown(*game, ada);
}

TEST(Rotation, AMatchIsFollowedByTheNextScene) {
  auto game = MakeGame({"sumo", "pitch"}, {.rounds = 1});
  client::Client& ada = game->AddClient({"Ada"});
  game->AddClient({"Bob"});
  std::vector<std::string> notices;
  ada.OnNotice([&](const std::string& line) { notices.push_back(line); });
  game->Run(3 + 8 + 2);  // a round, the pause behind it, and some time
  EXPECT_EQ(game->server.SceneName(), "pitch");
  EXPECT_FALSE(game->server.IsMatchOver());
  EXPECT_THAT(notices, ElementsAre("the match is over; the next scene is pitch"));
  ASSERT_EQ(game->server.GoToScene("sumo"), "");
  game->Run(2);
  ExpectShown(*game, ada);
  EXPECT_EQ(ada.Welcome().game, "sumo");
  EXPECT_EQ(ada.ReadScoreboard().round, 1);
  EXPECT_EQ(ada.ReadScoreboard().scores.size(), 2U);
}

TEST(Rotation, PlayersVoteForTheNextScene) {
  auto game = MakeGame({"pitch", "pair"});
  for (const char* name : {"Ada", "Bob", "Cy"}) game->AddClient({name});
  game->Run(1);
  using Question = Server::Question;
  EXPECT_EQ(game->server.VoteFor(Question::kNextScene, 1, game->now), "");
  EXPECT_THAT(game->server.VoteFor(Question::kRestart, 2, game->now), HasSubstr("go to the next scene"));
  EXPECT_EQ(game->server.SceneName(), "pitch");
  EXPECT_EQ(game->server.VoteFor(Question::kNextScene, 2, game->now), "");
  game->Run(2);
  EXPECT_EQ(game->server.SceneName(), "pair");
  EXPECT_THAT(game->server.VoteFor(Question::kNextScene, 3, game->now), HasSubstr("has just passed"));
  Game single(LoadShippedScene("pair"));
  EXPECT_THAT(single.server.VoteFor(Question::kNextScene, 1, 0), HasSubstr("stays in its scene"));
}

TEST(Rotation, AnEmptyServerGoesOnceToTheNextScene) {
  auto game = MakeGame({"pitch", "pair", "curtain"}, {.pauseAfter = 2, .resetsWhenEmpty = true});
  client::Client& ada = game->AddClient({"Ada"});
  game->Run(1);
  ada.Leave(game->now);
  game->Run(5);
  EXPECT_EQ(game->server.SceneName(), "pair");
  EXPECT_TRUE(game->server.IsPaused());
  client::Client& bob = game->AddClient({"Bob"});
  game->Run(3);
  ExpectShown(*game, bob);
}

TEST(Rotation, RefusesWhatIsNotInIt) {
  auto game = MakeGame({"pitch", "pair"});
  EXPECT_EQ(game->server.GoToScene("arena"), "scene arena: must be one of pitch, pair");
  EXPECT_EQ(game->server.GoToScene("pair"), "");
  EXPECT_EQ(game->server.GoToScene("pitch"), "scene pair is about to begin");
  game->Step();
  EXPECT_EQ(game->server.SceneName(), "pair");
}

// Made on another thread, the next scene takes no tick: the present one is played until it is there.
TEST(Rotation, TheSceneIsPlayedOnWhileTheNextIsMade) {
  std::vector<RotationScene> scenes{LoadForRotation("pair"), LoadForRotation("crowd")};
  Game game(scenes.front().scene, {.afterMatch = AfterMatch::kNext}, 1, [] { return 0.0; });
  game.server.Rotate(std::move(scenes));
  game.Run(0.5);
  ASSERT_EQ(game.server.GoToNextScene(), "");
  const std::uint32_t before = game.server.ShownTick();
  game.Step();
  EXPECT_EQ(game.server.SceneName(), "pair") << "a thousand balls are not made in no time";
  EXPECT_EQ(game.server.ShownTick(), before + 1);
  for (int tries = 0; game.server.SceneName() == "pair" && tries < 20'000; ++tries) {
    usleep(1000);
    game.Step();
  }
  EXPECT_EQ(game.server.SceneName(), "crowd");
}

TEST(Rotation, EachSceneIsARecordingOfItsOwn) {
  const recording::Folder folder;
  auto game = MakeGame({"pitch", "pair"});
  recording::Head head{.version = "test", .scene = LoadForRotation("pitch").source};
  game->server.Record(recording::MakeSettings(folder), head);
  client::Client& ada = game->AddClient({"Ada"});
  ada.SetInput({.moveX = 1});
  game->Run(1.5);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(game->server.GoToNextScene(), "");
    game->Run(1.5);
  }
  game->server.EndRecording();
  const auto files = folder.List();
  ASSERT_EQ(files.size(), 4U);
  for (const auto& file : files) {
    const recording::Proof proof = recording::Verify(file, {}, [](double, double) { return true; });
    EXPECT_EQ(proof.verdict, recording::Verdict::kIdentical) << proof.words;
    recording::Recording recorded;
    ASSERT_EQ(recorded.Open(file), "");
    EXPECT_TRUE(recorded.ReadHead().beginsFresh);
    EXPECT_GT(recorded.LastTick(), 80U);
    EXPECT_EQ(file.filename().string().rfind(recorded.ReadHead().scene.name, 0), 0U);
  }
}

TEST(Rotation, TheStateNamesItsScene) {
  const recording::Folder folder;
  const std::vector<std::string> names{"pitch", "pair", "curtain"};
  const auto keep = [&](Game& game) {
    std::vector<recording::Head> heads;
    for (const std::string& name : names) heads.push_back({.version = "test", .scene = LoadForRotation(name).source});
    auto checkpoints = std::make_unique<recording::Checkpoints>(folder.Path(), std::move(heads));
    const auto found = checkpoints->FindNewest();
    EXPECT_THAT(found.complaints, IsEmpty());
    if (found.checkpoint) {
      EXPECT_EQ(game.server.Resume(*found.checkpoint, game.now), "");
    }
    game.server.KeepState(std::move(checkpoints));
  };
  auto game = MakeGame(names);
  game->admission.identity = recording::Identity{1};
  keep(*game);
  game->AddClient({"Ada"});
  game->Run(1);
  ASSERT_EQ(game->server.GoToScene("curtain"), "");
  game->Run(3);
  const std::uint32_t body = game->clients.front()->Welcome().ownBody;
  const std::uint32_t tick = game->server.World().Tick();
  game.reset();

  game = MakeGame(names);
  game->admission.identity = recording::Identity{1};
  keep(*game);
  EXPECT_EQ(game->server.SceneName(), "curtain");
  EXPECT_LE(tick - game->server.World().Tick(), 60U);
  client::Client& back = game->AddClient({"Ada"});
  game->Run(2);
  EXPECT_EQ(back.Welcome().ownBody, body);
  ExpectShown(*game, back);
  ASSERT_EQ(game->server.GoToNextScene(), "");
  game->Run(2);
  EXPECT_EQ(game->server.SceneName(), "pitch") << "on from where it was";
  ExpectShown(*game, back);
}

}  // namespace
}  // namespace wobble::server
