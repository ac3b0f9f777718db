// The server with real clients and hostile connections on a virtual network, and what a tick allocates.
#include "server/server.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <new>
#include <set>
#include <string>

#include "server/physics/shapes/finish_blueprint.h"
#include "tests/support/game.h"
#include "tests/support/pace.h"
#include "tests/support/replace_blueprint.h"

namespace {
std::atomic<bool> countsAllocations{false};
std::atomic<std::uint64_t> allocations{0};

void* Allocate(std::size_t size) {
  if (countsAllocations.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
  return std::malloc(size == 0 ? 1 : size);
}
void* AllocateOrThrow(std::size_t size) {
  if (void* memory = Allocate(size)) return memory;
  throw std::bad_alloc();
}
void* AllocateAligned(std::size_t size, std::align_val_t alignment) {
  if (countsAllocations.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
  const auto step = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(step, (size + step - 1) / step * step)) return memory;
  throw std::bad_alloc();
}
}  // namespace

// Every form that the library may call, for the whole test program; they count only while a test asks them to.
void* operator new(std::size_t size) { return AllocateOrThrow(size); }
void* operator new[](std::size_t size) { return AllocateOrThrow(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return Allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return Allocate(size); }
void* operator new(std::size_t size, std::align_val_t alignment) { return AllocateAligned(size, alignment); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return AllocateAligned(size, alignment); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace wobble::server {
namespace {

using client::State;
using protocol::wire::EventKind;
using protocol::wire::GoodbyeReason;
using test::Game;
using test::MakeYard;
using test::RawConnection;
using transport::Channel;

// Events of one kind about one body, as a client heard them.
struct Ear {
  explicit Ear(client::Client& client) {
    client.OnEvent([this](const client::Client::Event& event) { events.push_back(event); });
  }
  [[nodiscard]] int Count(EventKind kind, std::uint32_t body) const {
    int count = 0;
    for (const auto& event : events) count += event.kind == kind && event.body == body ? 1 : 0;
    return count;
  }
  std::vector<client::Client::Event> events;
};

std::vector<std::uint32_t> ShownBodies(client::Client& client, double now) {
  std::vector<client::BodySample> samples;
  client.Sample(now, client::Detail::kVertices, samples);
  std::vector<std::uint32_t> bodies;
  for (const auto& sample : samples) {
    bodies.push_back(sample.body);
    EXPECT_EQ(sample.vertices.size(), sample.blueprint->rest.size());
  }
  return bodies;
}

// Seconds until what was dropped on the yard lies still.
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
  ASSERT_EQ(samples.size(), 13U);  // twelve balls and its own
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
  EXPECT_NEAR(client.InterpolationDelay(), 2.0 / 30, 0.02) << "as long as without turns";
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

// A ball of the yard's kind without its first `torn` faces, or another one.
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

// What a client shows of a body.
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

  // More vertices, in the next slot; then the first slot again, with other content.
  ASSERT_TRUE(ReplaceBlueprint(world, body, MakeTornBall(0, 2)));
  game.Run(1);
  for (client::Client* each : {&first, &second}) {
    EXPECT_EQ(Look(*each, game.now, body).vertices.size(), 162U);
  }
  ASSERT_TRUE(ReplaceBlueprint(world, body, MakeTornBall(79)));
  EXPECT_EQ(world.Blueprints().size(), 3U) << "a slot that nobody used";
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

// A body that is changed ten times a second over a bad link: nothing is ever read under the wrong blueprint.
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
  double reach = 0;  // the furthest that a vertex has been from the middle, m
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

TEST(Server, TheOwnBodyMovesWhenTheClientMoves) {
  Game game(MakeYard());
  auto& mover = game.AddClient();
  auto& other = game.AddClient();
  game.Run(kToRest);
  const physics::Vector3d start = game.Centre(mover.Welcome().ownBody);
  const physics::Vector3d otherStart = game.Centre(other.Welcome().ownBody);
  mover.SetInput({1, 0, false, false, false});
  game.Run(0.5);
  const physics::Vector3d end = game.Centre(mover.Welcome().ownBody);
  EXPECT_GT(end.x() - start.x(), 0.5);
  EXPECT_LT(std::abs(end.y() - start.y()), 0.2);
  EXPECT_LT((game.Centre(other.Welcome().ownBody) - otherStart).norm(), 0.05);

  // Both see it: the newest pose is at most a snapshot and a trip behind.
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
  client.SetInput({0, 0, true, false, false});
  double highest = floor;
  int flights = 0;
  bool isUp = false;
  for (int i = 0; i < 240; ++i) {  // held for 4 s
    game.Step();
    const double height = game.Centre(own).z();
    highest = std::max(highest, height);
    if (!isUp && height > floor + 0.8) ++flights;
    isUp = height > floor + 0.8;
  }
  EXPECT_GT(highest, floor + 1);  // v²/2g = 1.8 m at 6 m/s, less what the jump takes from the shape
  EXPECT_EQ(flights, 1);
}

TEST(Server, AShortPressIsNotLost) {
  Game game(MakeYard());
  auto& client = game.AddClient();
  game.Run(kToRest);
  const double floor = game.Centre(client.Welcome().ownBody).z();
  client.SetInput({0, 0, true, false, false});
  game.Step();
  client.SetInput({});
  double highest = floor;
  for (int i = 0; i < 60; ++i) {
    game.Step();
    highest = std::max(highest, game.Centre(client.Welcome().ownBody).z());
  }
  EXPECT_GT(highest, floor + 1);
}

TEST(Server, LeavingTakesTheBodyAwayFromTheOthers) {
  Game game(MakeYard());
  auto& leaver = game.AddClient({"Leo"});
  auto& stayer = game.AddClient({"Sue"});
  const Ear ear(stayer);
  game.Run(1);
  const std::uint32_t body = leaver.Welcome().ownBody;
  auto shown = ShownBodies(stayer, game.now);
  EXPECT_EQ(std::count(shown.begin(), shown.end(), body), 1);

  leaver.Leave(game.now);
  game.Run(0.5);
  EXPECT_FALSE(game.HasBody(body));
  shown = ShownBodies(stayer, game.now);
  EXPECT_EQ(std::count(shown.begin(), shown.end(), body), 0);
  EXPECT_EQ(shown.size(), 2U);
  EXPECT_EQ(ear.Count(EventKind::Leave, body), 1);
  EXPECT_EQ(ear.Count(EventKind::BodyRemoved, body), 1);
  EXPECT_EQ(leaver.ReadState(), State::kEnded);
  EXPECT_FALSE(leaver.EndedUnasked());
  EXPECT_EQ(game.server.ReadCounts().leaves, 1U);
  EXPECT_EQ(game.server.ReadCounts().disconnects, 0U);
  EXPECT_EQ(game.server.CountPlaying(), 1U);
}

TEST(Server, ALostClientIsTakenOutAndCounted) {
  Game game(MakeYard());
  game.AddClient();
  auto& stayer = game.AddClient();
  game.Run(1);
  const std::uint32_t body = game.clients[0]->Welcome().ownBody;
  game.clients.erase(game.clients.begin());  // its process died: the link closes
  game.Run(0.5);
  EXPECT_FALSE(game.HasBody(body));
  EXPECT_EQ(game.server.ReadCounts().disconnects, 1U);
  EXPECT_EQ(game.server.ReadCounts().leaves, 0U);
  EXPECT_EQ(stayer.ReadState(), State::kPlaying);
}

TEST(Server, ASilentClientIsSentAwayAfterEightSeconds) {
  Game game(MakeYard());
  auto& raw = game.AddRaw();
  game.Run(0.1);
  raw.Send(Channel::kControl, protocol::MakeHello("mute", protocol::wire::Role::Player));
  game.Run(7.8);
  EXPECT_EQ(game.server.CountPlaying(), 1U);
  game.Run(0.5);
  EXPECT_EQ(game.server.CountPlaying(), 0U);
  EXPECT_EQ(raw.GoodbyeReason(), static_cast<int>(GoodbyeReason::Silent));
  EXPECT_TRUE(raw.Closed());
  EXPECT_EQ(game.server.ReadCounts().disconnects, 1U);
}

TEST(Server, WhoSaysNoHelloIsSentAwayAfterThreeSeconds) {
  Game game(MakeYard());
  auto& raw = game.AddRaw();
  game.Run(2.9);
  EXPECT_TRUE(raw.Connected());
  game.Run(0.4);
  EXPECT_TRUE(raw.Closed());
  EXPECT_EQ(raw.GoodbyeReason(), static_cast<int>(GoodbyeReason::NoHello));
  EXPECT_EQ(game.server.ReadCounts().refusals, 1U);
  EXPECT_EQ(game.server.ReadCounts().joins, 0U);
  EXPECT_EQ(game.server.ReadCounts().disconnects, 0U);
  EXPECT_TRUE(game.server.IsEmpty());
}

TEST(Server, WhoSaysNoHelloOverASlowLinkHasEightRoundTripsMore) {
  Game game(MakeYard());
  game.network.SetConditions({.delay = 0.25});
  auto& raw = game.AddRaw();
  game.Run(0.25 + 3 + 8 * 0.5 - 0.1);
  EXPECT_EQ(game.server.ReadCounts().refusals, 0U);
  EXPECT_TRUE(raw.Connected());
  game.Run(1);
  EXPECT_EQ(game.server.ReadCounts().refusals, 1U);
  EXPECT_EQ(raw.GoodbyeReason(), static_cast<int>(GoodbyeReason::NoHello));
}

TEST(Server, WhoFallsOffStartsAgainAndEverybodyHears) {
  Game game(MakeYard());
  auto& faller = game.AddClient();
  auto& watcher = game.AddClient();
  const Ear ear(watcher);
  game.Run(1);
  const std::uint32_t own = faller.Welcome().ownBody;
  faller.SetInput({1, 0, false, false, false});
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

TEST(Server, AFullServerSaysSo) {
  Config config;
  config.maxClients = 2;
  Game game(MakeYard(), config);
  game.AddClient();
  game.AddClient();
  game.Run(0.5);
  auto& third = game.AddClient();
  game.Run(0.5);
  EXPECT_EQ(third.ReadState(), State::kEnded);
  EXPECT_NE(third.EndReason().find("server is full"), std::string::npos) << third.EndReason();
  EXPECT_EQ(game.server.CountPlaying(), 2U);
  EXPECT_EQ(game.server.ReadCounts().refusals, 1U);
  EXPECT_EQ(game.server.ReadCounts().disconnects, 0U);

  game.clients[0]->Leave(game.now);
  game.Run(0.2);
  auto& fourth = game.AddClient();
  game.Run(0.5);
  EXPECT_EQ(fourth.ReadState(), State::kPlaying);
}

TEST(Server, AnotherVersionIsRefusedWithAReason) {
  Game game(MakeYard());
  client::Options options;
  options.protocolVersion = 99;
  auto& client = game.AddClient(options);
  game.Run(0.5);
  EXPECT_EQ(client.ReadState(), State::kEnded);
  EXPECT_NE(client.EndReason().find("wrong protocol version"), std::string::npos);
  EXPECT_NE(client.EndReason().find("99"), std::string::npos);
  EXPECT_EQ(game.server.ReadCounts().refusals, 1U);
}

TEST(Server, CloseSaysGoodbyeToAll) {
  Game game(MakeYard());
  for (int i = 0; i < 4; ++i) game.AddClient();
  auto& raw = game.AddRaw();  // has not said hello
  game.Run(0.5);
  game.server.Close("", game.now);
  const std::uint32_t tick = game.server.World().Tick();
  for (int i = 0; i < 60 && !game.server.IsEmpty(); ++i) {
    game.now += 1.0 / 60;
    game.server.Poll(game.now);
    for (auto& client : game.clients) client->Update(game.now);
    raw.Poll(game.now);
  }
  EXPECT_TRUE(game.server.IsEmpty());
  EXPECT_EQ(game.server.World().Tick(), tick);
  for (auto& client : game.clients) {
    EXPECT_EQ(client->ReadState(), State::kEnded);
    EXPECT_NE(client->EndReason().find("server is closing"), std::string::npos) << client->EndReason();
  }
  EXPECT_EQ(raw.GoodbyeReason(), static_cast<int>(GoodbyeReason::ServerClosing));
  EXPECT_EQ(game.server.ReadCounts().disconnects, 0U);  // it was the server that left
}

TEST(Server, ASpectatorSeesAllAndHasNoBody) {
  Game game(MakeYard());
  auto& player = game.AddClient();
  client::Options options;
  options.spectator = true;
  auto& spectator = game.AddClient(options);
  game.Run(1);
  EXPECT_EQ(spectator.ReadState(), State::kPlaying);
  EXPECT_EQ(spectator.Welcome().ownBody, 0U);
  EXPECT_EQ(game.server.World().Bodies().size(), 2U);  // the ball and the player
  EXPECT_EQ(ShownBodies(spectator, game.now), (std::vector<std::uint32_t>{1, player.Welcome().ownBody}));
  spectator.SetInput({1, 1, true, true, true});
  game.Run(0.5);
  spectator.Leave(game.now);
  game.Run(0.5);
  EXPECT_EQ(game.server.World().Bodies().size(), 2U);
  EXPECT_EQ(game.server.ReadCounts().leaves, 1U);
}

TEST(Server, HostileMessagesAreCountedAndNobodyNotices) {
  Game game(MakeYard());
  Game quiet(MakeYard());
  for (Game* each : {&game, &quiet}) {
    each->AddClient();
    each->AddClient();
    each->Run(1);
  }
  auto& spammer = game.AddRaw();
  auto& faker = game.AddRaw();
  auto& floods = game.AddRaw();
  game.Run(0.1);
  quiet.Run(0.1);
  // Below what ends a session: counted and no more.
  for (int i = 0; i < 3; ++i) {
    spammer.Send(Channel::kControl, {0xFF, 0xFF, 0xFF, 0xFF});
    spammer.Send(Channel::kSnapshot, protocol::Message(1200, 0x5A));
    spammer.Send(Channel::kInput, protocol::MakeHello("x", protocol::wire::Role::Player));
  }
  const protocol::wire::InputFrame future(4000000000U, 1, 1, 1);
  faker.Send(Channel::kInput, protocol::MakeInput({&future, 1}, 0, 0));  // before its hello
  game.Run(0.1);
  quiet.Run(0.1);
  const Counts& counts = game.server.ReadCounts();
  EXPECT_EQ(counts.dropped[static_cast<std::size_t>(DropReason::kParse)], 6U);
  EXPECT_EQ(counts.parse[static_cast<std::size_t>(protocol::ParseResult::kMalformed)], 6U);
  EXPECT_EQ(counts.dropped[static_cast<std::size_t>(DropReason::kWrongChannel)], 3U);
  EXPECT_EQ(counts.dropped[static_cast<std::size_t>(DropReason::kOutOfOrder)], 1U);
  EXPECT_TRUE(spammer.Connected());

  for (int i = 0; i < 200; ++i) floods.Send(Channel::kInput, protocol::Message(32, 0xEE));
  game.Run(0.2);
  quiet.Run(0.2);
  EXPECT_TRUE(floods.Closed());
  EXPECT_EQ(floods.GoodbyeReason(), static_cast<int>(GoodbyeReason::BadMessages));
  EXPECT_EQ(counts.refusals, 1U);

  // The players' world is, bit for bit, the one where none of this happened.
  ASSERT_EQ(game.server.World().Tick(), quiet.server.World().Tick());
  EXPECT_EQ(game.server.World().Hash(), quiet.server.World().Hash());
  for (auto& client : game.clients) {
    EXPECT_EQ(client->ReadState(), State::kPlaying);
    EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
  }
  EXPECT_EQ(counts.disconnects, 0U);
}

TEST(Server, EveryClientGetsTheSameBytesOfABody) {
  // Two raw connections keep whole packets: records of one tick, body and patch are to be equal in all, but for the
  // quality, which depends on who looks.
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
  EXPECT_GT(equal, 100U);  // which bodies fit, and how exactly, differs between the two
}

// All bodies of the yard, the player's own too, as a client shows them: none of them held.
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
  EXPECT_LT(client.ReadStatistics().snapshotAge, 0.2) << "the clock goes on";

  auto& late = game.AddClient({"Late", true});
  game.Run(5);
  ASSERT_EQ(late.ReadState(), State::kPlaying);
  ExpectShowsAllAtRest(game, late, 2);
  EXPECT_GT(game.server.ReadSendCounts().vertices, vertices);

  // It wakes, and the next snapshot has it.
  client.SetInput({1, 0});
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

TEST(Server, SameCallsSameWorld) {
  const auto play = [] {
    Game game(test::LoadShippedScene("arena"));
    game.network.SetConditions({0.05, 0.05, 0.02, 0.01, 0.02, 0.05});
    for (int i = 0; i < 4; ++i) game.AddClient();
    for (int i = 0; i < 180; ++i) {
      for (int j = 0; j < 4; ++j) {
        const float turn = 0.05F * static_cast<float>(i) + static_cast<float>(j);
        game.clients[static_cast<std::size_t>(j)]->SetInput(
            {std::sin(turn), std::cos(turn), i % 50 == 0, false, false});
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
  EXPECT_LE(calls, 600 * 50 + 1) << "and it is seldom asked";

  client::Client& client = game.AddClient();
  game.Run(1);
  EXPECT_FALSE(game.server.IsPaused());
  EXPECT_EQ(client.ReadState(), client::State::kPlaying);
  EXPECT_NEAR(game.server.World().Tick() - tick, 60, 4) << "from its first packet on";
  EXPECT_EQ(game.server.Clock().DroppedTicks(), 0U);
  EXPECT_EQ(game.server.Clock().TimeRatio(), 1);
  EXPECT_NEAR(game.server.ReadCounts().pausedTime, 600, 0.5);

  client.Leave(game.now);
  game.Run(1.5);
  EXPECT_FALSE(game.server.IsPaused()) << "he may come back";
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

TEST(Server, StepCaptureAndEncodeDoNotAllocateOnceWarm) {
  const scenes::Scene scene = test::LoadShippedScene("arena");
  physics::World world(scenes::MakeWorldSettings(scene, 1.0 / 60, 1));
  const auto placed = scenes::FillWorld(scene, 1, world);
  std::vector<CapturedBlueprint> blueprints;
  for (const auto& blueprint : world.Blueprints()) blueprints.push_back(CaptureBlueprint(blueprint));
  for (std::uint32_t i = 1; i <= 8; ++i) {
    (void)world.AddBody(static_cast<std::uint8_t>(scene.player.blueprint), scenes::FindSpawn(scene.player, i));
  }
  BodyCaptures captures;
  Encoder encoder;
  const auto play = [&](int from, int to) {
    for (int tick = from; tick < to; ++tick) {
      for (const physics::Body& body : world.Bodies()) {
        const double turn = 0.01 * tick + body.id;
        world.SetControl(body.id, {std::cos(turn), std::sin(turn), tick % 90 == 0, false, tick % 200 < 50}, {});
      }
      world.Step();
      captures.Follow(world);
      if (tick % 2 != 0) continue;
      encoder.Follow(captures.Bodies(), world.Tick());
      for (std::size_t i = 0; i < captures.Bodies().size(); ++i) {
        const CapturedBody& captured = captures.Read(world, i);
        for (std::size_t quality = 0; quality < kQualities; ++quality) {
          (void)encoder.Encode(i, quality, captured, blueprints[captured.blueprint]);
        }
      }
    }
  };
  play(0, test::Shorten(400));
  if (test::kIsSanitized) GTEST_SKIP() << "not warm yet";
  allocations = 0;
  countsAllocations = true;
  play(400, 700);
  countsAllocations = false;
  EXPECT_EQ(allocations.load(), 0U);
  EXPECT_EQ(captures.Bodies().size(), 20U);

  countsAllocations = true;  // it does count
  const auto one = std::make_unique<int>(1);
  countsAllocations = false;
  EXPECT_EQ(allocations.load(), 1U);
}

// What threads encode ahead is what would have been encoded when it was asked for.
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
