// Server with clients and hostile connections on a virtual network: leaving, refusing, timing out, closing.
#include "server/server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/game.h"
#include "tests/unit/server/ear.h"

namespace wobble::server {
namespace {

using client::State;
using protocol::wire::EventKind;
using protocol::wire::GoodbyeReason;
using test::Ear;
using test::Game;
using test::MakeYard;
using transport::Channel;

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
  game.clients.erase(game.clients.begin());  // as if its process had died: the connection closes
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
  EXPECT_EQ(game.server.ReadCounts().disconnects, 0U);  // the server ended these
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
  spectator.SetInput({.moveX = 1, .moveY = 1, .jump = true, .puff = true, .stiffen = true});
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
  // Fewer bad messages than end a session: they are only counted.
  for (int i = 0; i < 3; ++i) {
    spammer.Send(Channel::kControl, {0xFF, 0xFF, 0xFF, 0xFF});
    spammer.Send(Channel::kSnapshot, protocol::Message(protocol::kMaxClientMessageBytes, 0x5A));
    spammer.Send(Channel::kInput, protocol::MakeHello("x", protocol::wire::Role::Player));
  }
  const protocol::wire::InputFrame future(4000000000U, 1, 1, 1);
  faker.Send(Channel::kInput, protocol::MakeInput({.frames = {&future, 1}}));  // before its hello
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

  // The players' world equals, bit for bit, the one without attacks.
  ASSERT_EQ(game.server.World().Tick(), quiet.server.World().Tick());
  EXPECT_EQ(game.server.World().Hash(), quiet.server.World().Hash());
  for (auto& client : game.clients) {
    EXPECT_EQ(client->ReadState(), State::kPlaying);
    EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
  }
  EXPECT_EQ(counts.disconnects, 0U);
}

}  // namespace
}  // namespace wobble::server
