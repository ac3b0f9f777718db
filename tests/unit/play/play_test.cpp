// Hands, cuts, tuning and the workshop, from the client that asks to the world that changes.
#include <gtest/gtest.h>

#include <cmath>

#include "server/server.h"
#include "tests/support/game.h"

namespace wobble::server {
namespace {

using physics::Vector3d;
using protocol::Vector3;
using protocol::wire::BuildKind;
using protocol::wire::TuneKind;
using test::Game;

constexpr std::uint32_t kBall = 1;  // of the yard

Vector3d CentreOf(const Game& game, std::uint32_t body) {
  return game.server.World().FindCentre(game.server.World().ReadBody(body));
}

// The vertex of a body nearest to a place.
std::uint16_t FindNearest(const Game& game, std::uint32_t body, const Vector3d& place) {
  std::uint16_t nearest = 0;
  double least = 1e9;
  physics::VisitVertices(game.server.World().ReadBody(body), [&](std::size_t i, const Vector3d& x) {
    if ((x - place).norm() >= least) return;
    least = (x - place).norm();
    nearest = static_cast<std::uint16_t>(i);
  });
  return nearest;
}

// Records the notices that a client gets.
struct Notices {
  explicit Notices(client::Client& client) {
    client.OnNotice([this](const std::string& text) { lines.push_back(text); });
  }
  std::vector<std::string> lines;
};

TEST(Play, AHandLiftsABallAndLetsItFall) {
  Game game(test::MakeYard("[hands]\ngrab = true\n"));
  client::Client& client = game.AddClient();
  game.Run(2);
  EXPECT_EQ(client.Welcome().hands, protocol::kMayGrab);
  const std::uint16_t top = FindNearest(game, kBall, CentreOf(game, kBall) + Vector3d(0, 0, 1));
  client.SetHand(client::Hand{kBall, top, {3, 3, 3}});
  game.Run(2);
  EXPECT_NEAR(CentreOf(game, kBall).z(), 2.5, 0.6) << "hangs from a hand at 3 m";
  client.SetHand({});
  game.Run(2);
  EXPECT_LT(CentreOf(game, kBall).z(), 0.7);
  EXPECT_EQ(game.server.ReadCounts().quarantined, 0U);
}

TEST(Play, AHandHoldsWhatIsInReachAndOfOthers) {
  Game game(test::MakeYard("[hands]\ngrab = true\nreach = 2\n"));
  client::Client& client = game.AddClient();
  game.Run(2);
  const Vector3d before = CentreOf(game, kBall);
  client.SetHand(client::Hand{kBall, 0, {0, 0, 3}});
  game.Run(1);
  // It still bounces, but is not pulled to the side.
  EXPECT_LT((CentreOf(game, kBall) - before).head<2>().norm(), 0.05) << "four metres are too far";
  const std::uint32_t own = client.Welcome().ownBody;
  client.SetHand(client::Hand{own, 0, {0, 0, 5}});
  game.Run(1);
  EXPECT_LT(CentreOf(game, own).z(), 1) << "a hand does not hold its own body";
  client.SetHand(client::Hand{77, 0, {0, 0, 5}});
  game.Run(0.2);
  client.SetHand(client::Hand{kBall, 9999, {0, 0, 5}});
  game.Run(0.2);
  EXPECT_EQ(game.server.CountPlaying(), 1U);
}

TEST(Play, WithoutLeaveNoHandHolds) {
  Game game(test::MakeYard());
  client::Client& client = game.AddClient();
  const Notices notices(client);
  game.Run(2);
  client.SetHand(client::Hand{kBall, 0, {3, 3, 4}});
  client.Push(kBall, 0, {1, 0, 0});
  client.Cut(kBall, {0, 0, 5}, {3, 3, 0}, {3, 3, 1});
  client.Tune(TuneKind::Gravity, {0, 0, 9.81F});
  client.Build({});
  game.Run(1);
  EXPECT_LT(CentreOf(game, kBall).z(), 0.7);
  EXPECT_EQ(notices.lines.size(), 4U) << "one refusal each; the hand, sent 60 times a second, gets none";
}

TEST(Play, APushSendsABallAwayAndPushesBack) {
  Game game(test::MakeYard("[hands]\npush = true\nreach = 10\nimpulse = 12\n"));
  client::Client& client = game.AddClient();
  game.Run(2);
  const std::uint32_t own = client.Welcome().ownBody;
  const Vector3d ballBefore = CentreOf(game, kBall), ownBefore = CentreOf(game, own);
  client.Push(kBall, FindNearest(game, kBall, ballBefore + Vector3d(1, 0, 0)), {-2, 0, 0});
  game.Run(0.3);
  EXPECT_LT(CentreOf(game, kBall).x(), ballBefore.x() - 0.2);
  EXPECT_GT(CentreOf(game, own).x(), ownBefore.x() + 0.1);
}

constexpr const char* kSheet = R"(
[[blueprint]]
name = "sheet"
kind = "cloth"
points = [9, 9]
spacing = 0.2
pinned = "edge"
[[bodies]]
blueprint = "sheet"
position = [0, 2, 1.2]
[hands]
cut = true
)";

TEST(Play, ACutSheetFallsForEverybody) {
  Game game(test::MakeYard(kSheet));
  client::Client& client = game.AddClient();
  client::Client& other = game.AddClient();
  game.Run(1);
  std::uint32_t sheet = 0;
  for (const physics::Body& body : game.server.World().Bodies()) {
    if (game.server.World().BlueprintOf(body).name == "sheet") sheet = body.id;
  }
  ASSERT_NE(sheet, 0U);
  const auto countFaces = [&](client::Client& who) {
    std::vector<client::BodySample> samples;
    who.Sample(game.now, client::Detail::kVertices, samples);
    for (const auto& sample : samples) {
      if (sample.body == sheet) return sample.blueprint->faces.size();
    }
    return std::size_t{0};
  };
  const std::size_t before = countFaces(other);
  ASSERT_GT(before, 100U);
  client.Cut(sheet, {0, -4, 1.5}, {-1.5, 2.3F, 1.5}, {1.5, 2.3F, 1.5});
  game.Run(1);
  EXPECT_LT(countFaces(other), before);
  EXPECT_EQ(countFaces(client), countFaces(other));
  const auto heightOf = [&](std::size_t vertex) {
    double height = 0;
    physics::VisitVertices(game.server.World().ReadBody(sheet), [&](std::size_t i, const Vector3d& x) {
      if (i == vertex) height = x.z();
    });
    return height;
  };
  EXPECT_NEAR(heightOf(2 * 9 + 4), 1.6, 0.02) << "what hangs above the cut stays";
  EXPECT_LT(heightOf(3 * 9 + 4), 1.2) << "the row below it was at 1.4 m and has come down to stand on the floor";
}

TEST(Play, TuningIsForWhomTheSceneNamesAndToldToAll) {
  Game game(test::MakeYard("[tuning]\ngravity = \"everyone\"\nstiffness = \"host\"\n"));
  client::Client& first = game.AddClient();
  game.Run(0.5);
  client::Client& second = game.AddClient();
  game.Run(0.5);
  const Notices notices(second);
  EXPECT_EQ(first.ReadTuning().may, protocol::kMayTuneGravity) << "who came first is nobody in particular";
  EXPECT_TRUE(game.server.SetRank(first.Welcome().clientId, transport::Rank::kOwner));
  game.Run(0.1);
  EXPECT_EQ(first.ReadTuning().may, protocol::kMayTuneGravity | protocol::kMayTuneStiffness);
  EXPECT_EQ(second.ReadTuning().may, protocol::kMayTuneGravity);
  second.Tune(TuneKind::Gravity, {2, 0, -9});
  second.Tune(TuneKind::Stiffness, {2, 0, 0});
  second.Tune(TuneKind::TimeRate, {0.5F, 0, 0});
  second.Tune(TuneKind::Gravity, {0, 0, -900});
  game.Run(0.5);
  EXPECT_EQ(first.ReadTuning().gravity.x, 2);
  EXPECT_EQ(game.server.World().Settings().gravity, Vector3d(2, 0, -9));
  EXPECT_EQ(first.ReadTuning().stiffness, 1);
  ASSERT_EQ(notices.lines.size(), 3U);
  EXPECT_NE(notices.lines[2].find("0 to 30"), std::string::npos) << notices.lines[2];
  first.Leave(game.now);
  game.Run(0.5);
  EXPECT_EQ(second.ReadTuning().may, protocol::kMayTuneGravity) << "nobody inherits that";
  second.Leave(game.now);
  game.Run(0.5);
  EXPECT_EQ(game.server.World().Settings().gravity, Vector3d(0, 0, -9.81)) << "as the scene has it, for who comes next";
}

TEST(Play, SlowMotionAndJumpsAreTheSameTickMoreOrLessOften) {
  Game game(test::MakeYard("[tuning]\ntime = \"everyone\"\n"));
  client::Client& client = game.AddClient();
  game.Run(1);
  client.Tune(TuneKind::TimeRate, {0.25F, 0, 0});
  game.Run(1);
  EXPECT_EQ(client.ReadTuning().timeRate, 0.25F);
  const std::uint32_t slowFrom = game.server.World().Tick();
  game.Run(4);
  EXPECT_NEAR(game.server.World().Tick() - slowFrom, 60, 2);
  EXPECT_NEAR(client.ReadStatistics().timeRatio, 0.25, 0.01);
  client.Tune(TuneKind::TimeRate, {1, 0, 0});
  client.Tune(TuneKind::Jump, {5, 0, 0});
  const std::uint32_t jumpFrom = game.server.World().Tick();
  game.Run(2);
  EXPECT_NEAR(game.server.World().Tick() - jumpFrom, 7 * 60, 8);
  EXPECT_EQ(client.ReadState(), client::State::kPlaying);
  game.Run(1);
  EXPECT_NEAR(client.ServerTime(game.now), game.server.World().Tick() / 60.0, 0.1) << "the client has followed";
}

TEST(Play, ForcesComeToWhoAsksAndAddUp) {
  Game game(test::MakeYard());
  client::Client& client = game.AddClient();
  client::Client& other = game.AddClient();
  game.Run(3);
  client.Inspect(kBall);
  game.Run(0.5);
  const client::Forces& forces = client.ReadForces();
  ASSERT_EQ(forces.body, kBall);
  EXPECT_EQ(forces.stride, 1);
  EXPECT_LT(game.server.World().Tick() - forces.tick, 12U);
  std::map<protocol::wire::ForceKind, double> sums;
  for (const protocol::ForceField& field : forces.fields) {
    ASSERT_EQ(field.values.size(), 42U);
    for (const Vector3& v : field.values) sums[field.kind] += static_cast<double>(v.z);
  }
  EXPECT_NEAR(sums[protocol::wire::ForceKind::Weight], -4 * 9.81, 0.5);
  double force = 0;
  for (const auto& [kind, sum] : sums) force += kind == protocol::wire::ForceKind::Acceleration ? 0 : sum;
  EXPECT_NEAR(force, 4.0 / 42 * sums[protocol::wire::ForceKind::Acceleration], 2)
      << "all forces: mass times acceleration, as far as steps of 1/127 of the largest of 42 add up";
  EXPECT_GT(sums[protocol::wire::ForceKind::Contact], 1) << "it lies on the floor";
  EXPECT_EQ(other.ReadForces().body, 0U);
  client.Inspect(0);
  game.Run(0.3);
  const std::uint32_t last = client.ReadForces().tick;
  game.Run(0.5);
  EXPECT_EQ(client.ReadForces().tick, last);
}

constexpr const char* kWorkshop = R"(
[[blueprint]]
name = "frame"
kind = "graph"
particle = [{ position = [0, 0, 0], fixed = true }, { position = [1, 0, 0] }]
spring = [{ ends = [0, 1], stiffness = 500 }]
[[bodies]]
blueprint = "frame"
position = [0, 0, 2]
[workshop]
blueprint = "frame"
particles_each = 3
springs_each = 4
[hands]
cut = true
)";

// The workshop's body as a client has it.
struct Shown {
  std::shared_ptr<const client::Blueprint> blueprint;
  std::vector<Vector3> vertices;
};
Shown FindShown(const Game& game, client::Client& client) {
  std::vector<client::BodySample> samples;
  client.Sample(game.now, client::Detail::kVertices, samples);
  for (const auto& sample : samples) {
    if (sample.body == client.Welcome().workshop) return {sample.blueprint, sample.vertices};
  }
  return {};
}

TEST(Play, WhatOneBuildsAllSee) {
  Game game(test::MakeYard(kWorkshop));
  client::Client& client = game.AddClient();
  client::Client& other = game.AddClient();
  const Notices notices(client);
  game.Run(1);
  EXPECT_NE(client.Welcome().workshop, 0U);
  const Shown before = FindShown(game, client);
  ASSERT_EQ(before.blueprint->particles.size(), 2U);
  ASSERT_EQ(before.blueprint->springs.size(), 1U);
  EXPECT_TRUE(before.blueprint->particles[0].fixed());
  client.Build({.kind = BuildKind::AddParticle, .at = {-2, -1, 1.5F}, .mass = 0.5F, .fixed = true});
  game.Run(0.5);
  Shown shown = FindShown(game, other);
  ASSERT_EQ(shown.blueprint->particles.size(), 3U);
  EXPECT_EQ(shown.blueprint->particles[2].owner(), client.Welcome().clientId);
  EXPECT_NEAR(shown.vertices[2].x, -2, 0.02);
  EXPECT_NEAR(shown.vertices[2].z, 1.5, 0.02);

  const std::uint16_t made = shown.blueprint->particles[2].number();
  const std::uint16_t old = shown.blueprint->particles[1].number();
  other.Build({.kind = BuildKind::AddSpring, .a = made, .b = old, .stiffness = 300, .damping = 2});
  game.Run(0.5);
  shown = FindShown(game, client);
  ASSERT_EQ(shown.blueprint->springs.size(), 2U);
  EXPECT_EQ(shown.blueprint->springs[1].stiffness(), 300);
  EXPECT_GT(shown.blueprint->springs[1].rest_length(), 1) << "as far as they were apart";

  client.Build({.kind = BuildKind::SetSpring,
                .a = shown.blueprint->springs[1].number(),
                .stiffness = 50,
                .damping = 1,
                .restLength = 0.7F});
  client.Build({.kind = BuildKind::SetParticle, .a = old, .mass = 2, .fixed = true});
  client.Build({.kind = BuildKind::RemoveParticle, .a = before.blueprint->particles[0].number()});
  game.Run(0.5);
  shown = FindShown(game, other);
  ASSERT_EQ(shown.blueprint->particles.size(), 2U) << "with the spring that ended in it";
  ASSERT_EQ(shown.blueprint->springs.size(), 1U);
  EXPECT_EQ(shown.blueprint->springs[0].rest_length(), 0.7F);
  EXPECT_EQ(shown.blueprint->particles[0].mass(), 2);
  EXPECT_TRUE(shown.blueprint->particles[0].fixed());
  EXPECT_TRUE(notices.lines.empty());
  EXPECT_EQ(client.ReadStatistics().badRecords + client.ReadStatistics().badMessages, 0U);
}

TEST(Play, BuildingIsBoundedAndRefusedInWords) {
  Game game(test::MakeYard(kWorkshop));
  client::Client& client = game.AddClient();
  const Notices notices(client);
  game.Run(1);
  for (int i = 0; i < 4; ++i) {
    client.Build({.kind = BuildKind::AddParticle, .at = {static_cast<float>(i), -1, 1}, .mass = 0.5F});
  }
  game.Run(0.5);
  ASSERT_EQ(notices.lines.size(), 1U);
  EXPECT_NE(notices.lines[0].find("3 particles, the most per player"), std::string::npos) << notices.lines[0];
  const Shown shown = FindShown(game, client);
  const auto number = [&](std::size_t i) { return shown.blueprint->particles[i].number(); };
  client.Build({.kind = BuildKind::AddSpring, .a = 9999, .b = number(0)});
  client.Build({.kind = BuildKind::AddSpring, .a = number(0), .b = number(1)});
  client.Build({.kind = BuildKind::AddSpring, .a = number(0), .b = number(2), .stiffness = 1e8F});
  client.Build({.kind = BuildKind::AddParticle, .at = {3000, 0, 0}});
  client.Build({.kind = BuildKind::SetParticle, .a = number(0), .mass = -1});
  game.Run(0.5);
  EXPECT_EQ(notices.lines.size(), 6U);
  EXPECT_EQ(FindShown(game, client).blueprint->particles.size(), 5U);
}

TEST(Play, AFloodOfChangesIsToldToComeAgain) {
  Game game(test::MakeYard(kWorkshop));
  client::Client& client = game.AddClient();
  const Notices notices(client);
  game.Run(1);
  const std::uint16_t number = FindShown(game, client).blueprint->particles[1].number();
  for (int i = 0; i < 55; ++i)
    client.Build({.kind = BuildKind::SetParticle, .a = number, .mass = 1.0F + 0.01F * static_cast<float>(i)});
  game.Run(1);
  ASSERT_FALSE(notices.lines.empty());
  EXPECT_NE(notices.lines[0].find("try again"), std::string::npos);
  client.Build({.kind = BuildKind::SetParticle, .a = number, .mass = 3});
  game.Run(0.5);
  EXPECT_EQ(FindShown(game, client).blueprint->particles[1].mass(), 3) << "it is heard again";
}

TEST(Play, ACutInTheWorkshopTakesSpringsAway) {
  Game game(test::MakeYard(kWorkshop));
  client::Client& client = game.AddClient();
  game.Run(1);
  const Shown shown = FindShown(game, client);
  client.Cut(client.Welcome().workshop, {0, -90, 2}, {-80, 90, 2.1F}, {80, 90, 2});
  client.Cut(client.Welcome().workshop, {0, -1e30F, 2}, {-1e30F, 1e30F, 3e30F}, {1e30F, 1e30F, -1e30F});
  game.Run(0.5);
  EXPECT_EQ(FindShown(game, client).blueprint->edges.size(), 1U) << "no blade is that long";
  const Vector3 middle = (shown.vertices[0] + shown.vertices[1]) * 0.5F;
  client.Cut(client.Welcome().workshop, middle + Vector3{0, -3, 0}, middle + Vector3{-0.4F, 0.5F, 0.4F},
             middle + Vector3{0.4F, 0.5F, -0.4F});
  game.Run(0.5);
  EXPECT_EQ(FindShown(game, client).blueprint->edges.size(), 0U);
}

TEST(Play, TooManyCommandsAreDroppedAndTheirSenderStays) {
  Game game(test::MakeYard());
  client::Client& client = game.AddClient();
  game.Run(1);
  for (int i = 0; i < 500; ++i) client.Inspect(kBall);
  game.Run(1);
  EXPECT_EQ(game.server.ReadCounts().dropped[static_cast<std::size_t>(DropReason::kTooMany)],
            500 - protocol::kMaxCommandsPerSecond);
  EXPECT_EQ(client.ReadState(), client::State::kPlaying);
}

TEST(Play, SumoScoresForThePusherAndTellsEverybody) {
  Game game(test::LoadShippedScene("sumo"));
  client::Client& pusher = game.AddClient({"Ada"});
  client::Client& victim = game.AddClient({"Bo"});
  game.Run(2);
  std::vector<client::Client::Event> events;
  victim.OnEvent([&](const client::Client::Event& event) { events.push_back(event); });
  ASSERT_EQ(victim.Welcome().game, "sumo");
  EXPECT_EQ(victim.ReadScoreboard().scores.size(), 2U);
  const auto has = [&](protocol::wire::EventKind kind) {
    for (const auto& event : events) {
      if (event.kind == kind && event.clientId == pusher.Welcome().clientId) return true;
    }
    return false;
  };
  for (int i = 0; i < 60 * 30 && !has(protocol::wire::EventKind::Fall); ++i) {
    const Vector3d own = CentreOf(game, pusher.Welcome().ownBody);
    const Vector3d other = CentreOf(game, victim.Welcome().ownBody);
    const Vector3d way = (other - own).normalized();
    pusher.SetInput({static_cast<float>(way.x()), static_cast<float>(way.y())});
    if (i % 30 == 0)
      pusher.Push(victim.Welcome().ownBody, 0, {static_cast<float>(way.x()), static_cast<float>(way.y()), 0});
    game.Step();
  }
  ASSERT_TRUE(has(protocol::wire::EventKind::Fall));
  game.Run(0.2);
  const client::Scoreboard& board = victim.ReadScoreboard();
  ASSERT_FALSE(board.scores.empty());
  EXPECT_EQ(board.scores[0].client_id(), pusher.Welcome().clientId);
  EXPECT_EQ(board.scores[0].points(), 1);
  EXPECT_GT(CentreOf(game, victim.Welcome().ownBody).z(), 0) << "back on the platform";
}

}  // namespace
}  // namespace wobble::server
