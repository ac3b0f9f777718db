// What clients of a server are sent: snapshots at their rate, blueprints that change, bodies at rest.
#include "server/server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "tests/support/game.h"
#include "tests/support/replace_blueprint.h"

namespace wobble::server {
namespace {

using client::State;
using test::Game;
using test::MakeYard;
using test::RawConnection;
using transport::Channel;

TEST(Server, ManyBodiesComeInTurnsEachAsOftenAsOthers) {
  Game game(
      MakeYard("[[bodies]]\nblueprint = \"ball\"\nposition = [-4, -4, 20]\ncount = [6, 6, 1]\nspacing = [1.5, 1.5, 0]"),
      {.clientKbit = 20000});
  auto& client = game.AddClient();
  game.Run(0.5);
  std::map<std::uint32_t, std::set<std::uint32_t>> ticks;
  client.OnDecoded([&](const client::DecodedPatch& patch) { ticks[patch.body].insert(patch.tick); });
  game.Run(1);
  ASSERT_EQ(ticks.size(), game.server.World().Bodies().size());
  for (const auto& [body, seen] : ticks) {
    EXPECT_NEAR(static_cast<double>(seen.size()), 30, 1);
    for (const std::uint32_t tick : seen) EXPECT_EQ(tick % 2, body % 2);
  }
  EXPECT_EQ(client.ReadStatistics().stalls, 0U);
  EXPECT_NEAR(client.InterpolationDelay(), 2.0 / 30, 0.02) << "as without turns";
}

TEST(Server, SnapshotsComeAtTheirRate) {
  for (const int snapshotHz : {10, 25, 30, 60}) {
    Config config;
    config.snapshotHz = snapshotHz;
    Game game(MakeYard(), config);
    auto& client = game.AddClient();
    game.Run(1);
    const auto before = client.ReadStatistics().snapshots;
    game.Run(4);  // a small world: one packet each
    EXPECT_NEAR(static_cast<double>(client.ReadStatistics().snapshots - before), 4 * snapshotHz, 1) << snapshotHz;
  }
}

// A ball like the yard's without its first `torn` faces; with 2 subdivisions it has 162 vertices instead of 42.
physics::Blueprint MakeTornBall(std::size_t torn, int subdivisions = 1) {
  physics::BallDefinition ball;
  ball.name = "torn " + std::to_string(torn);
  ball.subdivisions = subdivisions;
  ball.material.mass = 4;
  ball.material.gas = 0;
  physics::Blueprint blueprint = physics::MakeBall(ball);
  blueprint.full.faces.erase(blueprint.full.faces.begin(),
                             blueprint.full.faces.begin() + static_cast<std::ptrdiff_t>(torn));
  physics::FinishBlueprint(blueprint);
  return blueprint;
}

// A body as a client shows it; empty when it shows none.
client::BodySample Look(client::Client& client, double now, std::uint32_t body) {
  std::vector<client::BodySample> samples;
  client.Sample(now, client::Detail::kVertices, samples);
  for (const client::BodySample& sample : samples) {
    if (sample.body == body) return sample;
  }
  return {};
}

TEST(Server, ABodyThatChangesItsBlueprintIsSeenSoByAllAndByLatecomers) {
  Game game(MakeYard());
  auto& world = const_cast<physics::World&>(game.server.World());
  const physics::BodyId body = world.Bodies()[0].id;
  auto& first = game.AddClient();
  game.Run(1);
  const std::size_t whole = Look(first, game.now, body).blueprint->faces.size();
  EXPECT_EQ(whole, 80U);

  ASSERT_TRUE(ReplaceBlueprint(world, body, MakeTornBall(30)));
  game.Run(1);
  auto& second = game.AddClient();
  game.Run(1);
  for (client::Client* each : {&first, &second}) {
    const client::BodySample sample = Look(*each, game.now, body);
    ASSERT_NE(sample.blueprint, nullptr);
    EXPECT_EQ(sample.blueprint->faces.size(), 50U);
    EXPECT_TRUE(sample.blueprint->open);
    EXPECT_EQ(sample.vertices.size(), 42U);
  }
  EXPECT_EQ(first.Welcome().blueprintCount, 1);
  EXPECT_EQ(second.Welcome().blueprintCount, 2);

  // First more vertices, in the next slot; then an unused slot again, with other content.
  ASSERT_TRUE(ReplaceBlueprint(world, body, MakeTornBall(0, 2)));
  game.Run(1);
  for (client::Client* each : {&first, &second}) {
    EXPECT_EQ(Look(*each, game.now, body).vertices.size(), 162U);
  }
  ASSERT_TRUE(ReplaceBlueprint(world, body, MakeTornBall(79)));
  EXPECT_EQ(world.Blueprints().size(), 3U) << "an unused slot is taken";
  auto& third = game.AddClient();
  game.Run(1);
  for (client::Client* each : {&first, &second, &third}) {
    const client::BodySample sample = Look(*each, game.now, body);
    ASSERT_NE(sample.blueprint, nullptr);
    EXPECT_EQ(sample.blueprint->name, "torn 79");
    EXPECT_EQ(sample.blueprint->faces.size(), 1U);
    EXPECT_EQ(sample.vertices.size(), 42U);
    const client::Statistics& statistics = each->ReadStatistics();
    EXPECT_EQ(statistics.badMessages + statistics.badRecords + statistics.badSnapshots, 0U);
  }
}

// A body changes its blueprint ten times a second over a bad link: no record is decoded with the wrong blueprint.
TEST(Server, ChangingBlueprintsSurviveABadLink) {
  Game game(MakeYard());
  transport::LinkConditions conditions;
  conditions.loss = 0.1;
  conditions.delay = 0.05;
  conditions.jitter = 0.1;
  conditions.reorder = 0.05;
  conditions.duplicate = 0.02;
  game.network.SetConditions(conditions);
  auto& world = const_cast<physics::World&>(game.server.World());
  const physics::BodyId body = world.Bodies()[0].id;
  auto& client = game.AddClient();
  game.Run(3);
  ASSERT_EQ(client.ReadState(), State::kPlaying);
  std::map<std::string, int> shown;
  double reach = 0;  // the largest distance of a vertex from the centre so far, m
  for (std::size_t change = 0; change < 79; ++change) {
    ASSERT_TRUE(ReplaceBlueprint(world, body, MakeTornBall(change, change % 7 == 3 ? 2 : 1)));
    for (int tick = 0; tick < 6; ++tick) {
      game.Step();
      const client::BodySample sample = Look(client, game.now, body);
      ASSERT_NE(sample.blueprint, nullptr);
      ASSERT_EQ(sample.vertices.size(), sample.blueprint->rest.size());
      ++shown[sample.blueprint->name];
      const physics::Vector3d centre = game.Centre(body);
      physics::VisitVertices(world.ReadBody(body), [&](std::size_t, const physics::Vector3d& x) {
        reach = std::max(reach, (x - centre).norm());
      });
      for (const protocol::Vector3& vertex : sample.vertices) {
        ASSERT_LT(Length(vertex - sample.pose.centroid), 1.1 * reach + 0.01) << "read under a wrong rest shape";
      }
    }
  }
  EXPECT_LE(world.Blueprints().size(), 3U);
  EXPECT_GT(shown.size(), 40U) << "of 79 that last a tenth of a second each";
  game.Run(3);
  EXPECT_EQ(Look(client, game.now, body).blueprint->name, "torn 78");
  const client::Statistics& statistics = client.ReadStatistics();
  EXPECT_EQ(statistics.badMessages + statistics.badRecords + statistics.badSnapshots, 0U);
}

TEST(Server, EveryClientGetsTheSameBytesOfABody) {
  // Two raw connections keep whole packets. Records of one tick, body and patch must be equal in both, except for the
  // quality, which depends on the viewpoint.
  Game game(test::LoadShippedScene("arena"));
  auto& a = game.AddRaw();
  auto& b = game.AddRaw();
  game.Run(0.1);
  for (RawConnection* raw : {&a, &b}) {
    raw->Send(Channel::kControl, protocol::MakeHello("raw", protocol::wire::Role::Player));
  }
  game.Run(3);
  using Key = std::tuple<std::uint32_t, std::uint32_t, int>;
  std::map<Key, std::set<std::string>> seen;
  std::size_t equal = 0;
  for (const RawConnection* raw : {&a, &b}) {
    for (const auto& packet : raw->Snapshots()) {
      protocol::SnapshotHead head;
      std::vector<protocol::Record> records;
      ASSERT_EQ(protocol::ReadSnapshot(packet, head, records), protocol::SnapshotResult::kOk);
      for (const auto& record : records) {
        auto& payloads = seen[{head.tick, record.head.body, record.head.patch}];
        equal += payloads.emplace(record.payload.begin(), record.payload.end()).second ? 0 : 1;
        ASSERT_LE(payloads.size(), kQualities);
      }
    }
  }
  EXPECT_GT(equal, 100U);  // the two differ in which bodies fit and at which quality
}

// Checks that the client shows `count` bodies at rest, all exact to the best quality and none of them held.
void ExpectShowsAllAtRest(Game& game, client::Client& client, std::size_t count) {
  std::vector<client::BodySample> samples;
  client.Sample(game.now, client::Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), count);
  for (const client::BodySample& sample : samples) {
    EXPECT_FALSE(sample.held) << sample.body;
    EXPECT_EQ(sample.age, 0) << sample.body;
    const physics::Body& body = game.server.World().ReadBody(sample.body);
    ASSERT_TRUE(body.asleep);
    double squares = 0;
    physics::VisitVertices(body, [&](std::size_t i, const physics::Vector3d& x) {
      const protocol::Vector3 shown = sample.vertices[i];
      squares += (physics::Vector3d(double{shown.x}, double{shown.y}, double{shown.z}) - x).squaredNorm();
    });
    const double size = game.server.World().BlueprintOf(body).size;
    EXPECT_LE(std::sqrt(squares / static_cast<double>(sample.vertices.size())), 0.0026 * size) << sample.body;
  }
}

TEST(Server, WhatRestsCostsNothingOnceAllHaveItAndIsThereForLatecomers) {
  Game game(MakeYard(), {}, 7);
  game.network.SetConditions({.loss = 0.2, .delay = 0.05});
  auto& client = game.AddClient({"Ada"});
  game.Run(1);
  ASSERT_EQ(client.ReadState(), State::kPlaying);
  const auto isAtRest = [&] {
    const auto bodies = game.server.World().Bodies();
    return std::all_of(bodies.begin(), bodies.end(), [](const physics::Body& body) { return body.asleep; });
  };
  for (int i = 0; i < 120 && !isAtRest(); ++i) game.Run(1);
  ASSERT_TRUE(isAtRest());
  game.Run(5);
  ExpectShowsAllAtRest(game, client, 2);
  const std::uint64_t vertices = game.server.ReadSendCounts().vertices;
  game.Run(60);
  EXPECT_EQ(game.server.ReadSendCounts().vertices, vertices);
  ExpectShowsAllAtRest(game, client, 2);
  EXPECT_LT(client.ReadStatistics().snapshotAge, 0.2) << "heads alone keep the clock going";

  auto& late = game.AddClient({"Late", true});
  game.Run(5);
  ASSERT_EQ(late.ReadState(), State::kPlaying);
  ExpectShowsAllAtRest(game, late, 2);
  EXPECT_GT(game.server.ReadSendCounts().vertices, vertices);

  // The body wakes and is in the next snapshot.
  client.SetInput({.moveX = 1});
  game.Run(1);
  std::vector<client::BodySample> samples;
  late.Sample(game.now, client::Detail::kPosesOnly, samples);
  const auto own = std::find_if(samples.begin(), samples.end(), [&](const client::BodySample& sample) {
    return sample.body == client.Welcome().ownBody;
  });
  ASSERT_NE(own, samples.end());
  const double there = game.server.World().FindCentre(game.server.World().ReadBody(own->body)).x();
  EXPECT_NEAR(double{own->pose.centroid.x}, there, 1.0);
  EXPECT_GT(game.server.ReadSendCounts().vertices, vertices + 15 * 42);
}

// Records that overtake their blueprint cannot be decoded: a body at rest must be sent again.
TEST(Server, LatecomersSeeWhatRestsThoughBlueprintsComeLate) {
  std::string more;
  for (int i = 0; i < 5; ++i) {
    const std::string name = "kind" + std::to_string(i);
    more += "[[blueprint]]\nname = \"" + name + "\"\nsubdivisions = 2\nmass = 5\n[[bodies]]\nblueprint = \"" + name +
            "\"\nposition = [-4, " + std::to_string(2 * i - 4) + ", 0.999]\n";
  }
  Game game(MakeYard(more), {}, 7);
  const auto isAtRest = [&] {
    const auto bodies = game.server.World().Bodies();
    return std::all_of(bodies.begin(), bodies.end(), [](const physics::Body& body) { return body.asleep; });
  };
  game.AddClient({.name = "First", .spectator = true});
  for (int i = 0; i < 120 && !isAtRest(); ++i) game.Run(1);
  ASSERT_TRUE(isAtRest());
  game.network.SetConditions({.loss = 0.3, .delay = 0.05, .jitter = 0.03});
  for (int i = 0; i < 10; ++i) {
    auto& late = game.AddClient({.name = "Late", .spectator = true});
    game.Run(5);
    ASSERT_EQ(late.ReadState(), State::kPlaying);
    ExpectShowsAllAtRest(game, late, 6);
    late.Leave(game.now);
  }
}

// Bodies that threads encode ahead have the same bytes as bodies encoded when they are sent.
TEST(Server, SendsTheSameBytesOnAnyNumberOfThreads) {
  const auto play = [](int threads) {
    Config config;
    config.threads = threads;
    Game game(test::LoadShippedScene("arena"), config);
    RawConnection& player = game.AddRaw();
    game.Run(0.2);
    player.Send(Channel::kControl, protocol::MakeHello("mira", protocol::wire::Role::Player));
    game.Run(3);
    return player.Snapshots();
  };
  const auto alone = play(1);
  EXPECT_GT(alone.size(), 60U);
  EXPECT_EQ(play(2), alone);
}

}  // namespace
}  // namespace wobble::server
