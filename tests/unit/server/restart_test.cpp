// A world that begins anew while clients are in, as they see it: whole for who was there and for who comes later.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "server/server.h"
#include "tests/support/game.h"
#include "tests/unit/server/ear.h"

namespace wobble::server {
namespace {

using protocol::wire::BuildKind;
using protocol::wire::TuneKind;
using test::Ear;
using test::Game;
using test::MakeYard;

constexpr const char* kHungSheet = R"(
[[blueprint]]
name = "sheet"
kind = "cloth"
points = [9, 7]
spacing = 0.2
pinned = "edge"
[[bodies]]
blueprint = "sheet"
position = [0, 2, 1.2]
[hands]
cut = true
[tuning]
gravity = "everyone"
time = "everyone"
)";
constexpr std::uint32_t kSheetBody = 2;  // behind the yard's ball

std::size_t CountFaces(const Game& game) {
  return game.server.World().BlueprintOf(game.server.World().ReadBody(kSheetBody)).full.faces.size();
}

void CutSheet(client::Client& client) { client.Cut(kSheetBody, {0, -4, 1.5}, {-1.5, 2.3F, 1.5}, {1.5, 2.3F, 1.5}); }

client::BodySample FindShownSheet(client::Client& client, double now) {
  std::vector<client::BodySample> samples;
  client.Sample(now, client::Detail::kVertices, samples);
  const auto found = std::ranges::find(samples, kSheetBody, &client::BodySample::body);
  return found == samples.end() ? client::BodySample{} : *found;
}

// The greatest distance between where the client shows a vertex of the sheet and where it is, m.
double FindError(const Game& game, const client::BodySample& shown) {
  double error = 0;
  physics::VisitVertices(game.server.World().ReadBody(kSheetBody), [&](std::size_t i, const physics::Vector3d& x) {
    const protocol::Vector3& at = shown.vertices[i];
    const physics::Vector3d seen{double{at.x}, double{at.y}, double{at.z}};
    error = std::max(error, (seen - x).norm());
  });
  return error;
}

void ExpectWhole(const Game& game, client::Client& client, std::size_t faces) {
  const client::BodySample shown = FindShownSheet(client, game.now);
  ASSERT_NE(shown.blueprint, nullptr);
  EXPECT_EQ(shown.blueprint->faces.size(), faces);
  EXPECT_LT(FindError(game, shown), 0.03);
  const client::Statistics& statistics = client.ReadStatistics();
  EXPECT_EQ(statistics.badMessages + statistics.badRecords + statistics.badSnapshots, 0U);
}

TEST(Restart, WhatOneHasTornIsWholeForWhoIsInAndWhoComesLater) {
  Game game(MakeYard(kHungSheet));
  client::Client& vandal = game.AddClient({"Val"});
  game.Run(1);
  const std::size_t whole = CountFaces(game);
  CutSheet(vandal);
  game.Run(1);
  client::Client& witness = game.AddClient({"Wim"});
  game.Run(1);
  ASSERT_LT(CountFaces(game), whole);
  ASSERT_LT(FindShownSheet(witness, game.now).blueprint->faces.size(), whole);
  const Ear ear(vandal);
  const std::uint32_t tick = game.server.World().Tick();
  game.server.RestartWorld();
  EXPECT_EQ(CountFaces(game), whole);
  game.Run(5);
  EXPECT_GT(game.server.World().Tick(), tick) << "ticks count on";
  EXPECT_EQ(ear.Count(protocol::wire::EventKind::Respawn, kSheetBody), 1);
  EXPECT_EQ(ear.Count(protocol::wire::EventKind::Respawn, witness.Welcome().ownBody), 1);
  client::Client& visitor = game.AddClient({"Vic"});
  game.Run(2);
  for (client::Client* each : {&vandal, &witness, &visitor}) ExpectWhole(game, *each, whole);

  // And so again: what is torn a second time takes the blueprint's slot of the first.
  CutSheet(visitor);
  game.Run(1);
  ASSERT_LT(FindShownSheet(vandal, game.now).blueprint->faces.size(), whole);
  game.server.RestartWorld();
  game.Run(5);
  for (client::Client* each : {&vandal, &witness, &visitor}) ExpectWhole(game, *each, whole);
}

TEST(Restart, RestoresTuningAndThePaceOfTime) {
  Game game(MakeYard(kHungSheet));
  client::Client& client = game.AddClient();
  game.Run(1);
  client.Tune(TuneKind::Gravity, {1, 0, -3});
  client.Tune(TuneKind::TimeRate, {0.25F, 0, 0});
  game.Run(1);
  ASSERT_EQ(client.ReadTuning().timeRate, 0.25F);
  game.server.RestartWorld();
  game.Run(1);
  EXPECT_EQ(client.ReadTuning().timeRate, 1);
  EXPECT_EQ(client.ReadTuning().gravity.x, 0);
  EXPECT_EQ(game.server.World().Settings().gravity, physics::Vector3d(0, 0, -9.81));
}

TEST(Restart, TheWorkshopIsTheScenesAndProtectionStays) {
  Game game(test::LoadShippedScene("sandbox"));
  client::Client& client = game.AddClient();
  game.Run(1);
  const auto count = [&] {
    std::vector<client::BodySample> samples;
    client.Sample(game.now, client::Detail::kVertices, samples);
    const auto found = std::ranges::find(samples, client.Welcome().workshop, &client::BodySample::body);
    return found == samples.end() ? 0 : found->blueprint->particles.size();
  };
  const std::size_t before = count();
  const auto build = [&] {
    client.Build({.kind = BuildKind::AddParticle, .at = {0, 0, 2}, .mass = 0.5F, .fixed = true});
    game.Run(1);
  };
  build();
  ASSERT_EQ(count(), before + 1);
  EXPECT_TRUE(game.server.SetProtected(true));
  game.server.RestartWorld();
  game.Run(1);
  EXPECT_EQ(count(), before);
  EXPECT_TRUE(game.server.IsProtected());
  build();
  EXPECT_EQ(count(), before + 1) << "and everybody builds on";
}

// With a world that pauses and one that never does.
TEST(Restart, AWorldThatAllHaveLeftIsWholeForTheNext) {
  for (const double pauseAfter : {2.0, 0.0}) {
    Game game(MakeYard(kHungSheet), {.pauseAfter = pauseAfter, .resetsWhenEmpty = true});
    const std::size_t whole = CountFaces(game);
    client::Client& vandal = game.AddClient({"Val"});
    client::Client& watcher = game.AddClient({.name = "Wim", .spectator = true});
    game.Run(1);
    CutSheet(vandal);
    game.Run(1);
    const std::size_t torn = CountFaces(game);
    ASSERT_LT(torn, whole);
    vandal.Leave(game.now);
    game.Run(1);
    EXPECT_EQ(CountFaces(game), torn) << "somebody still watches";
    watcher.Leave(game.now);
    game.Run(0.5);
    EXPECT_EQ(CountFaces(game), whole);
    game.Run(10);
    EXPECT_EQ(game.server.IsPaused(), pauseAfter > 0);
    client::Client& visitor = game.AddClient({"Vic"});
    game.Run(5);
    ExpectWhole(game, visitor, whole);
  }
}

TEST(Restart, OnlyWhoAsksForItHasAWorldThatForgets) {
  Game game(MakeYard(kHungSheet), {.pauseAfter = 2});
  const std::size_t whole = CountFaces(game);
  client::Client& vandal = game.AddClient();
  game.Run(1);
  CutSheet(vandal);
  game.Run(1);
  vandal.Leave(game.now);
  game.Run(10);
  ASSERT_TRUE(game.server.IsPaused());
  EXPECT_LT(CountFaces(game), whole);
  game.server.RestartWorld();
  EXPECT_EQ(CountFaces(game), whole) << "a paused world as well";
  client::Client& visitor = game.AddClient();
  game.Run(5);
  ExpectWhole(game, visitor, whole);
}

TEST(Restart, AWorldThatClosesStaysAsItWasPlayed) {
  Game game(MakeYard(kHungSheet), {.resetsWhenEmpty = true});
  client::Client& vandal = game.AddClient();
  game.Run(1);
  CutSheet(vandal);
  game.Run(1);
  const std::size_t torn = CountFaces(game);
  game.server.Close("", game.now);
  EXPECT_EQ(CountFaces(game), torn);
}

TEST(Restart, AMatchEndsWithTheServerOrIsFollowedByTheNext) {
  for (const AfterMatch afterMatch : {AfterMatch::kEnd, AfterMatch::kRestart}) {
    scenes::Scene scene = test::LoadShippedScene("sumo");
    scene.game.roundSeconds = 3;
    Game game(std::move(scene), {.rounds = 1, .afterMatch = afterMatch});
    client::Client& ada = game.AddClient({"Ada"});
    client::Client& bob = game.AddClient({"Bob"});
    std::vector<std::string> notices;
    ada.OnNotice([&](const std::string& line) { notices.push_back(line); });
    game.Run(3 + 8 + 1.5);  // a round, the pause behind it, and some time
    EXPECT_EQ(ada.ReadState(), client::State::kPlaying);
    EXPECT_EQ(bob.ReadState(), client::State::kPlaying);
    if (afterMatch == AfterMatch::kEnd) {
      EXPECT_TRUE(game.server.IsMatchOver());
      EXPECT_FALSE(game.server.AcceptsJoins());
      continue;
    }
    EXPECT_FALSE(game.server.IsMatchOver());
    EXPECT_TRUE(game.server.AcceptsJoins());
    ASSERT_EQ(notices.size(), 1U);
    EXPECT_NE(notices[0].find("next one begins"), std::string::npos) << notices[0];
    EXPECT_EQ(ada.ReadScoreboard().round, 1);
    EXPECT_EQ(ada.ReadScoreboard().phase, protocol::wire::GamePhase::Playing);
    EXPECT_EQ(ada.ReadScoreboard().scores.size(), 2U);
    game.Run(3 + 8 + 0.5);
    EXPECT_EQ(notices.size(), 2U) << "and so on";
  }
}

}  // namespace
}  // namespace wobble::server
