// The client library against a scripted server: joining, inputs and events.
#include "client/client.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/unit/client/scripted_server.h"

namespace wobble::client {
namespace {

TEST_F(ClientTest, SaysHelloOnceConnectedAndPlaysOnceItHasItsBlueprint) {
  Start({.name = "Ada", .spectator = true});
  client->Update(now);
  EXPECT_EQ(client->ReadState(), State::kConnecting);
  EXPECT_TRUE(link.sent.empty());

  Connect();
  ASSERT_EQ(link.sent.size(), 1U);
  const wire::ClientMessage* message = nullptr;
  ASSERT_EQ(protocol::ParseClientMessage(link.sent[0].bytes, message), protocol::ParseResult::kOk);
  ASSERT_NE(message->body_as_Hello(), nullptr);
  EXPECT_EQ(message->body_as_Hello()->name()->str(), "Ada");
  EXPECT_EQ(message->body_as_Hello()->role(), wire::Role::Spectator);
  EXPECT_EQ(message->body_as_Hello()->protocol_version(), protocol::kProtocolVersion);
  EXPECT_EQ(message->body_as_Hello()->schema_hash(), protocol::kSchemaHash);

  now += 0.25;
  Welcome(2);
  const auto first = CutIntoChunks(0, MakeTetrahedron(), 30);
  const auto second = CutIntoChunks(1, MakeStrip(), protocol::kBlueprintChunkBytes);
  ASSERT_GT(first.size(), 3U);
  ASSERT_GT(second.size(), 1U);
  for (const Message& chunk : first) {
    EXPECT_EQ(client->ReadState(), State::kJoining);
    Arrive(Channel::kControl, chunk);
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying) << "the first is its own";
  for (const Message& chunk : second) Arrive(Channel::kControl, chunk);
  EXPECT_EQ(client->Welcome().ownBody, 3U);
  EXPECT_EQ(client->Welcome().scene, "arena");
  EXPECT_NEAR(client->ReadStatistics().joinSeconds, 0.25, 1e-9);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
}

// A plane whose normal is huge presses vertices to infinity, and from there to NaN.
TEST_F(ClientTest, AHostileWelcomeIsDroppedWhole) {
  using Shape = wire::ObstacleKind;
  const std::vector<wire::Obstacle> hostile{{Shape::Plane, {0, 0, 1e30F}, {-1e30F, 0, 0}, 0},
                                            {Shape::Plane, {0, 0, 1}, {-3e38F, 0, 0}, 0},
                                            {Shape::Plane, {0, 0, 0}, {0, 0, 0}, 0},
                                            {Shape::Box, {3e38F, 0, 0}, {1, 1, 1}, 0},
                                            {Shape::Sphere, {0, 0, 0}, {0, 0, 0}, 1e20F}};
  Start();
  Connect();
  for (const wire::Obstacle& obstacle : hostile) {
    const wire::Obstacle good{Shape::Plane, {0, 0, 1}, {}, 0};
    Arrive(Channel::kControl, protocol::MakeWelcome({.clientId = 9,
                                                     .tickHz = kTickHz,
                                                     .snapshotHz = 30,
                                                     .scene = "trap",
                                                     .blueprintCount = 0,
                                                     .obstacles = {good, obstacle, good}}));
    EXPECT_EQ(client->ReadState(), State::kJoining);
  }
  EXPECT_EQ(client->ReadStatistics().badMessages, hostile.size());
  EXPECT_TRUE(client->Welcome().obstacles.empty() && client->Welcome().scene.empty());
  Welcome(0);  // an honest one counts
  EXPECT_EQ(client->ReadState(), State::kPlaying);
}

TEST_F(ClientTest, SendsAnInputEachTickWithTheLastFourFramesAndTheAcknowledgement) {
  Join();
  link.sent.clear();
  const double begin = now;
  std::uint32_t sequence = 0;
  for (int i = 1; i <= 600; ++i) {
    now = begin + i / 120.0;  // polled twice a tick
    client->SetInput({.moveX = 0.5F, .moveY = -2.0F, .jump = i > 300, .stiffen = true});
    if (i % 4 == 0 && ++sequence != 148) Snapshot(sequence);  // packet 148 is lost
    client->Update(now);
  }
  const auto inputs = Inputs();
  EXPECT_NEAR(static_cast<double>(inputs.size()), 5 * kTickHz, 2);
  EXPECT_EQ(client->ReadStatistics().inputsSent, inputs.size() + 1);  // plus the one after the welcome

  std::uint32_t last = 0;
  for (const wire::Input* input : inputs) {
    const auto& frames = *input->frames();
    ASSERT_GT(frames.Get(0)->tick(), last);
    last = frames.Get(0)->tick();
    for (unsigned i = 1; i < frames.size(); ++i) ASSERT_LT(frames.Get(i)->tick(), frames.Get(i - 1)->tick());
  }
  EXPECT_NEAR(last, CurrentTick(), 2);
  const wire::Input& input = *inputs.back();
  EXPECT_EQ(input.frames()->size(), protocol::kInputRedundancy);
  EXPECT_EQ(input.frames()->Get(0)->move_x(), 64);
  EXPECT_EQ(input.frames()->Get(0)->move_y(), -127);
  EXPECT_EQ(input.frames()->Get(0)->buttons(), 1 | 4);
  EXPECT_EQ(input.acked_sequence(), 150U);
  EXPECT_EQ(input.acked_history(), ~std::uint64_t{0} ^ 2U);  // all but 148, the second before
  EXPECT_NEAR(client->ReadStatistics().lossShare, 1.0 / 64, 1e-9);
}

TEST_F(ClientTest, CatchesUpWithAFewInputsAndNoMore) {
  Join();
  client->Update(now += 0.1);
  link.sent.clear();
  client->Update(now += 3.0);
  EXPECT_EQ(link.sent.size(), 3U);
  client->Update(now + 0.001);
  EXPECT_EQ(link.sent.size(), 3U);
}

TEST_F(ClientTest, DoesNotRunAheadOfAServerThatIsSlow) {
  Join();
  std::uint32_t tick = 100, sequence = 0;
  double world = 100;
  for (int i = 0; i < 60 * 20; ++i) {
    now += 1.0 / kTickHz;
    world += 0.5;
    tick = static_cast<std::uint32_t>(world);
    Arrive(Channel::kSnapshot, MakeSnapshot({.sequence = ++sequence, .tick = tick, .timeRatio = 0.5F}));
  }
  EXPECT_LT(Inputs().back()->frames()->Get(0)->tick(), tick + 4);
  EXPECT_NEAR(static_cast<double>(Inputs().size()), 60 * 20, 3);  // inputs are still sent at the tick rate
  EXPECT_NEAR(client->ReadStatistics().timeRatio, 0.5, 1e-4);
}

TEST_F(ClientTest, PlaysWhenAllHeightsAreThereAndTakesNoOthers) {
  Start();
  Connect();
  protocol::WelcomeFields welcome{
      .clientId = 9, .ownBody = 3, .tick = 100, .tickHz = kTickHz, .snapshotHz = 30, .scene = "arena", .obstacles = {}};
  welcome.heightFields = {{{1, 2, 10}, 0.5F, -1, 0.0625F, 3, 4}};
  Arrive(Channel::kControl, protocol::MakeWelcome(welcome));
  const auto send = [&](std::uint16_t field, std::uint16_t row, const std::vector<std::uint16_t>& heights) {
    Arrive(Channel::kControl, protocol::MakeHeightRows(field, row, heights));
    return client->ReadStatistics().badMessages;
  };
  EXPECT_EQ(client->ReadState(), State::kJoining);
  EXPECT_EQ(send(1, 0, {1, 2, 3}), 1U) << "no such field";
  EXPECT_EQ(send(0, 0, {1, 2, 3, 4}), 2U) << "no whole rows";
  EXPECT_EQ(send(0, 1, {1, 2, 3}), 3U) << "a gap";
  EXPECT_EQ(send(0, 0, {0, 1, 2, 3, 4, 5}), 3U);
  EXPECT_EQ(send(0, 0, {0, 1, 2}), 4U) << "twice";
  EXPECT_EQ(send(0, 2, {1, 1, 1, 1, 1, 1, 1, 1, 1}), 5U) << "more than there are";
  EXPECT_EQ(client->ReadState(), State::kJoining);
  EXPECT_EQ(send(0, 2, {6, 7, 8, 9, 10, 65535}), 5U);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  ASSERT_EQ(client->Grounds().size(), 1U);
  EXPECT_EQ(client->Grounds()[0].rows, 4);
  EXPECT_EQ(client->Grounds()[0].heights[4], 9.25F) << "10 - 1 + 4 / 16";
  EXPECT_EQ(send(0, 4, {1, 2, 3}), 6U);
}

TEST_F(ClientTest, HandsOnEvents) {
  Join();
  std::vector<Client::Event> events;
  client->OnEvent([&](const Client::Event& event) { events.push_back(event); });
  Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::Join, 120, 7, 12, "Grace"));
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, wire::EventKind::Join);
  EXPECT_EQ(events[0].clientId, 7U);
  EXPECT_EQ(events[0].body, 12U);
  EXPECT_EQ(events[0].name, "Grace");
}

TEST_F(ClientTest, CountsGarbageOnEveryChannel) {
  Join();
  std::mt19937 random(1);
  for (unsigned i = 0; i < 3000; ++i) {
    Message noise(random() % 300);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
    Arrive(static_cast<Channel>(i % transport::kChannelCount), std::move(noise));
    now += 0.001;
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_EQ(client->ReadStatistics().badMessages, 2000U);
  EXPECT_EQ(client->ReadStatistics().badSnapshots, 1000U);
}

}  // namespace
}  // namespace wobble::client
