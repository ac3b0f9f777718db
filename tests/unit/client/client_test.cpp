// The client library against a scripted server: what it sends, what it makes of what it gets, how it ends.
#include "client/client.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <random>
#include <string>
#include <vector>

#include "client/newest_poses.h"
#include "protocol/pose.h"
#include "protocol/shape_codec.h"
#include "protocol/snapshot.h"

namespace wobble::client {
namespace {

using protocol::Message;
using protocol::Pose;
using protocol::Vector3;
using transport::Channel;

constexpr transport::ConnectionId kConnection = 5;
constexpr std::uint16_t kTickHz = 60;

// What the test sees of a transport that the client owns.
struct Link {
  struct Arrival {
    double at;
    transport::Event::Kind kind;
    Channel channel;
    Message bytes;
  };
  struct Sent {
    double at;
    Channel channel;
    Message bytes;
  };
  std::deque<Arrival> arrivals;  // in order of `at`
  std::vector<Sent> sent;
  int disconnects = 0;
  double roundTrip = 0;
  transport::SendResult answer = transport::SendResult::kQueued;
};

class ScriptedTransport final : public transport::Transport {
 public:
  explicit ScriptedTransport(Link& link) : m_link(link) {}
  void Poll(double now, const Sink& sink) override {
    m_now = now;
    while (!m_link.arrivals.empty() && m_link.arrivals.front().at <= now) {
      const Link::Arrival arrival = std::move(m_link.arrivals.front());
      m_link.arrivals.pop_front();
      sink({arrival.kind, kConnection, arrival.channel, arrival.bytes});
    }
  }
  transport::SendResult Send(transport::ConnectionId connection, Channel channel,
                             std::span<const std::uint8_t> message) override {
    EXPECT_EQ(connection, kConnection);
    EXPECT_LE(message.size(), protocol::kMaxPacketBytes);
    m_link.sent.push_back({m_now, channel, {message.begin(), message.end()}});
    return m_link.answer;
  }
  void Disconnect(transport::ConnectionId connection) override {
    EXPECT_EQ(connection, kConnection);
    ++m_link.disconnects;
  }
  void Flush() override {}
  [[nodiscard]] transport::Statistics ReadStatistics() const override { return {}; }
  [[nodiscard]] double ReadRoundTrip(transport::ConnectionId) const override { return m_link.roundTrip; }

 private:
  Link& m_link;
  double m_now = 0;
};

// A tetrahedron, and a strip longer than a patch.
Message MakeTetrahedron() {
  const std::vector<Vector3> rest{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return protocol::MakeBlueprint({.name = "tetrahedron", .rest = rest, .faces = faces, .size = 1.732F});
}
Message MakeStrip() {
  std::vector<Vector3> rest;
  std::vector<std::array<std::uint16_t, 3>> faces;
  for (std::uint16_t i = 0; i < 600; ++i) {
    rest.push_back({static_cast<float>(i) * 0.01F, static_cast<float>(i % 2), 0});
    if (i >= 2) faces.push_back({static_cast<std::uint16_t>(i - 2), static_cast<std::uint16_t>(i - 1), i});
  }
  return protocol::MakeBlueprint({.name = "strip", .rest = rest, .faces = faces, .size = 2.0F});
}

std::vector<Message> CutIntoChunks(std::uint8_t index, const Message& blueprint, std::size_t chunkBytes,
                                   std::uint8_t generation = 0) {
  std::vector<Message> chunks;
  for (std::size_t offset = 0; offset < blueprint.size(); offset += chunkBytes) {
    const auto part = std::span(blueprint).subspan(offset, std::min(chunkBytes, blueprint.size() - offset));
    chunks.push_back(protocol::MakeBlueprintChunk(index, protocol::HashBytes(blueprint),
                                                  static_cast<std::uint32_t>(blueprint.size()),
                                                  static_cast<std::uint32_t>(offset), part, generation));
  }
  return chunks;
}

// A body at rest in shape, at this pose; patch 0 of the tetrahedron.
std::vector<std::uint8_t> MakeRecord(std::uint32_t body, const Pose& pose, std::uint8_t blueprint = 0,
                                     std::uint8_t generation = 0,
                                     const std::vector<Vector3>& rest = {
                                         {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}) {
  const protocol::PatchModel model{.rest = rest, .size = rest.size() == 4 ? 1.732F : 0.8F};  // as their blueprints say
  const Pose seen = protocol::Dequantise(protocol::Quantise(pose, protocol::MakePoseGrid(12, model.size)));
  std::vector<Vector3> world;
  for (const Vector3& point : rest) world.push_back(protocol::Transform(seen, point));
  std::vector<std::uint8_t> payload, record;
  protocol::ShapeEncoder encoder;
  EXPECT_TRUE(encoder.Encode(model, pose, world, 0.001F, 512, payload).fits);
  protocol::AppendRecord({body, blueprint, 0, generation}, payload, record);
  return record;
}

Message MakeSnapshot(const protocol::SnapshotHead& head, const std::vector<std::vector<std::uint8_t>>& records = {}) {
  protocol::PacketBuilder builder;
  for (const auto& record : records) EXPECT_TRUE(builder.Add(record));
  const auto bytes = builder.Finish(head);
  return {bytes.begin(), bytes.end()};
}

class ClientTest : public testing::Test {
 protected:
  void Start(const Options& options = {}) {
    client = std::make_unique<Client>(std::make_unique<ScriptedTransport>(link), options, now);
  }
  void Arrive(Channel channel, Message bytes) {
    link.arrivals.push_back({now, transport::Event::Kind::kMessage, channel, std::move(bytes)});
    client->Update(now);
  }
  void Arrive(transport::Event::Kind kind) {
    link.arrivals.push_back({now, kind, Channel::kControl, {}});
    client->Update(now);
  }
  void Connect() { Arrive(transport::Event::Kind::kConnected); }
  void Welcome(std::uint16_t blueprints = 1) {
    Arrive(Channel::kControl, protocol::MakeWelcome({9, 3, 100, kTickHz, 30, "arena", blueprints, {}}));
  }
  // Connected, welcomed at tick 100, one blueprint.
  void Join(const Options& options = {}) {
    Start(options);
    Connect();
    Welcome();
    for (const Message& chunk : CutIntoChunks(0, MakeTetrahedron(), 64)) Arrive(Channel::kControl, chunk);
    ASSERT_EQ(client->ReadState(), State::kPlaying);
    joinedAt = now;
  }
  void Snapshot(std::uint32_t sequence, const std::vector<std::vector<std::uint8_t>>& records = {},
                std::uint32_t inputTick = 0) {
    Arrive(Channel::kSnapshot, MakeSnapshot({sequence, CurrentTick(), 1, inputTick}, records));
  }
  [[nodiscard]] std::uint32_t CurrentTick() const {
    return 100 + static_cast<std::uint32_t>(std::lround((now - joinedAt) * kTickHz));
  }
  // The inputs among what was sent, parsed.
  [[nodiscard]] std::vector<const wire::Input*> Inputs() const {
    std::vector<const wire::Input*> inputs;
    for (const Link::Sent& sent : link.sent) {
      if (sent.channel != Channel::kInput) continue;
      const wire::ClientMessage* message = nullptr;
      EXPECT_EQ(protocol::ParseClientMessage(sent.bytes, message), protocol::ParseResult::kOk);
      inputs.push_back(message->body_as_Input());
    }
    return inputs;
  }

  Link link;  // outlives the client
  std::unique_ptr<Client> client;
  double now = 50;
  double joinedAt = 50;
};

TEST_F(ClientTest, SaysHelloOnceConnectedAndPlaysOnceItHasAllBlueprints) {
  Start({"Ada", true, true});
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
  for (const Message& chunk : first) Arrive(Channel::kControl, chunk);
  for (const Message& chunk : second) {
    EXPECT_EQ(client->ReadState(), State::kJoining);
    Arrive(Channel::kControl, chunk);
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_EQ(client->Welcome().ownBody, 3U);
  EXPECT_EQ(client->Welcome().scene, "arena");
  EXPECT_NEAR(client->ReadStatistics().joinSeconds, 0.25, 1e-9);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
}

TEST_F(ClientTest, ShowsBodiesWhereTheyWereADelayAgo) {
  Join();
  std::vector<BodySample> samples;
  client->Sample(now, Detail::kVertices, samples);
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(client->ServerTime(now), 0);

  // Body 3 goes along x at 3 m/s, body 8 stands still.
  const auto placeAt = [](double time) { return static_cast<float>(3 * (time - 100.0 / kTickHz)); };
  for (std::uint32_t i = 1; i <= 60; ++i) {
    now = joinedAt + i / 30.0;
    Snapshot(i, {MakeRecord(8, {{0, 5, 0}, {}}), MakeRecord(3, {{placeAt(CurrentTick() / 60.0), 0, 1}, {}})});
  }
  EXPECT_NEAR(client->ServerTime(now), CurrentTick() / 60.0, 1e-3);
  EXPECT_NEAR(client->InterpolationDelay(), 2.0 / 30, 0.005);
  client->Sample(now, Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].body, 3U);
  EXPECT_EQ(samples[1].body, 8U);
  EXPECT_EQ(samples[0].blueprint, samples[1].blueprint);
  EXPECT_EQ(samples[0].blueprint->name, "tetrahedron");
  EXPECT_EQ(samples[0].blueprint->faces.size(), 4U);
  const double shown = client->ServerTime(now) - client->InterpolationDelay();
  EXPECT_NEAR(samples[0].pose.centroid.x, placeAt(shown), 0.002);
  ASSERT_EQ(samples[0].vertices.size(), 4U);
  EXPECT_NEAR(samples[0].vertices[1].y, -1, 0.005);
  EXPECT_NEAR(samples[0].vertices[1].x, placeAt(shown) + 1, 0.005);
  EXPECT_FALSE(samples[0].held);
  EXPECT_NEAR(client->NewestPose(3)->centroid.x, placeAt(CurrentTick() / 60.0), 0.002);
  EXPECT_FALSE(client->NewestPose(4).has_value());

  client->Sample(now, Detail::kPosesOnly, samples);
  EXPECT_TRUE(samples.at(0).vertices.empty());
  EXPECT_EQ(client->ReadStatistics().stalls, 0U);
  client->Update(now += 1);
  client->Sample(now, Detail::kPosesOnly, samples);
  EXPECT_TRUE(samples.at(0).held);
  EXPECT_EQ(client->ReadStatistics().stalls, 2U);

  Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::BodyRemoved, CurrentTick(), 0, 8, ""));
  client->Sample(now, Detail::kPosesOnly, samples);
  EXPECT_EQ(samples.size(), 1U);
}

TEST_F(ClientTest, SendsAnInputEachTickWithTheLastFourFramesAndTheAcknowledgement) {
  Join();
  link.sent.clear();
  const double begin = now;
  std::uint32_t sequence = 0;
  for (int i = 1; i <= 600; ++i) {
    now = begin + i / 120.0;  // polled twice a tick
    client->SetInput({0.5F, -2.0F, i > 300, false, true});
    if (i % 4 == 0 && ++sequence != 148) Snapshot(sequence);  // one is lost
    client->Update(now);
  }
  const auto inputs = Inputs();
  EXPECT_NEAR(static_cast<double>(inputs.size()), 5 * kTickHz, 2);
  EXPECT_EQ(client->ReadStatistics().inputsSent, inputs.size() + 1);  // and one when the welcome came

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
    Arrive(Channel::kSnapshot, MakeSnapshot({++sequence, tick, 0.5F, 0}));
  }
  EXPECT_LT(Inputs().back()->frames()->Get(0)->tick(), tick + 4);
  EXPECT_NEAR(static_cast<double>(Inputs().size()), 60 * 20, 3);  // acknowledgements go on at the same rate
  EXPECT_NEAR(client->ReadStatistics().timeRatio, 0.5, 1e-4);
}

TEST_F(ClientTest, MeasuresFromInputToSnapshotAndAge) {
  Join();
  std::vector<SnapshotArrival> arrivals;
  client->OnSnapshot([&](const SnapshotArrival& arrival) { arrivals.push_back(arrival); });
  link.sent.clear();
  client->Update(now += 0.1);
  const std::uint32_t frame = Inputs().at(0)->frames()->Get(0)->tick();
  const std::uint32_t tick = CurrentTick();
  now += 0.080;
  Arrive(Channel::kSnapshot, MakeSnapshot({1, tick, 1, frame}));
  Arrive(Channel::kSnapshot, MakeSnapshot({2, tick, 1, frame}));
  Arrive(Channel::kSnapshot, MakeSnapshot({3, tick, 1, 4000000000U}));  // was never sent
  ASSERT_EQ(arrivals.size(), 3U);
  EXPECT_EQ(arrivals[0].tick, tick);
  EXPECT_NEAR(arrivals[0].inputToSnapshot, 0.080, 1e-9);
  EXPECT_EQ(arrivals[1].inputToSnapshot, -1);
  EXPECT_EQ(arrivals[2].inputToSnapshot, -1);
  EXPECT_NEAR(client->ReadStatistics().inputToSnapshot, 0.080, 1e-9);
  // The welcome came without delay, this 80 ms later than that; and half of 80 ms less a tick for the trip itself.
  EXPECT_NEAR(arrivals[0].age, 0.080 + (0.080 - 1.0 / kTickHz) / 2, 1e-6);
}

TEST_F(ClientTest, IgnoresDuplicateAndAncientPackets) {
  Join();
  now += 0.1;
  const auto record = MakeRecord(3, {{1, 0, 0}, {}});
  Snapshot(200, {record});
  Snapshot(200, {MakeRecord(3, {{2, 0, 0}, {}}), record});
  Snapshot(100, {record});
  EXPECT_EQ(client->ReadStatistics().snapshots, 1U);
  EXPECT_EQ(client->ReadStatistics().duplicates, 2U);
  EXPECT_EQ(client->ReadStatistics().records, 1U);
  EXPECT_NEAR(client->NewestPose(3)->centroid.x, 1, 1e-3);
}

TEST_F(ClientTest, WithoutDecodingKnowsWhereBodiesAreAndNoMore) {
  Join({"bot", false, false});
  now += 0.1;
  Snapshot(1, {MakeRecord(3, {{1.5F, 0, 0}, {}}), MakeRecord(8, {{2, 0, 0}, {}})});
  EXPECT_EQ(client->ReadStatistics().records, 2U);
  EXPECT_NEAR(client->NewestPose(3)->centroid.x, 1.5, 1e-3);
  EXPECT_NEAR(client->NewestPose(8)->centroid.x, 2, 1e-3);
  EXPECT_FALSE(client->NewestPose(9).has_value());
  std::vector<BodySample> samples(3);
  client->Sample(now, Detail::kVertices, samples);
  EXPECT_TRUE(samples.empty());
}

TEST_F(ClientTest, KnowsHowFastBodiesGoWithAndWithoutDecoding) {
  for (const bool decode : {true, false}) {
    SCOPED_TRACE(decode);
    Join({"bot", false, decode});
    const auto hear = [&](std::uint32_t sequence, double after, float x) {
      now += after;
      Snapshot(sequence, {MakeRecord(8, {{x, 5, 0}, {}})});
      return client->FindSighting(8);
    };
    EXPECT_FALSE(client->FindSighting(8).has_value());
    EXPECT_FALSE(hear(1, 0.1, 1)->velocity.has_value());  // one pose is no motion
    const auto second = hear(2, 0.05, 1.25F);
    EXPECT_NEAR(second->pose.centroid.x, 1.25F, 1e-3);
    EXPECT_NEAR(second->velocity.value().x, 5, 0.02);
    EXPECT_NEAR(second->velocity.value().y, 0, 0.02);
    EXPECT_EQ(second->age, 0);

    Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::Respawn, CurrentTick() + 1, 0, 8, ""));
    EXPECT_FALSE(hear(3, 0.05, -4)->velocity.has_value());  // it was carried there
    EXPECT_NEAR(hear(4, 0.05, -3)->velocity.value().x, 20, 0.1);
    EXPECT_FALSE(hear(5, kMaxVelocitySpan + 0.1, -2)->velocity.has_value());  // too long ago to tell

    now += 0.2;
    Snapshot(6, {MakeRecord(9, {})});
    std::vector<Sighting> sightings;
    client->ListSightings(sightings);
    ASSERT_EQ(sightings.size(), 2U);
    EXPECT_NEAR(client->FindSighting(8)->age, 0.2, 1e-6);

    Arrive(Channel::kControl, protocol::MakeEvent(wire::EventKind::BodyRemoved, CurrentTick(), 0, 8, ""));
    Arrive(Channel::kSnapshot, MakeSnapshot({7, CurrentTick() - 6, 1, 0}, {MakeRecord(8, {})}));  // is late
    EXPECT_FALSE(client->FindSighting(8).has_value());
    client->ListSightings(sightings);
    ASSERT_EQ(sightings.size(), 1U);
    EXPECT_EQ(sightings[0].body, 9U);
  }
}

TEST_F(ClientTest, CountsRecordsThatItCannotUse) {
  Join();
  now += 0.1;
  Snapshot(1, {MakeRecord(3, {{1, 0, 0}, {}}, 7)});  // a blueprint that is not here
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  std::vector<std::uint8_t> noise(40, 0xFF), broken, beyond;
  protocol::AppendRecord({4, 0, 0}, noise, broken);
  protocol::AppendRecord({5, 0, 1}, noise, beyond);  // a patch the blueprint does not have
  Snapshot(2, {broken, beyond, MakeRecord(6, {{1, 0, 0}, {}})});
  EXPECT_EQ(client->ReadStatistics().badRecords, 2U);
  EXPECT_TRUE(client->NewestPose(6).has_value());
  EXPECT_FALSE(client->NewestPose(4).has_value());
}

TEST_F(ClientTest, PlaysWhenAllHeightsAreThereAndTakesNoOthers) {
  Start();
  Connect();
  protocol::WelcomeFields welcome{9, 3, 100, kTickHz, 30, "arena", 0, {}};
  welcome.heightFields = {{{1, 2, 10}, 0.5F, -1, 0.25F, 3, 4}};
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
  EXPECT_EQ(client->Grounds()[0].heights[4], 10) << "10 - 1 + 4 / 4";
  EXPECT_EQ(send(0, 4, {1, 2, 3}), 6U);
}

TEST_F(ClientTest, TakesASnapshotThatOvertookTheWelcome) {
  Start();
  Connect();
  Arrive(Channel::kSnapshot, MakeSnapshot({1, 100, 1, 0}, {MakeRecord(3, {})}));
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  EXPECT_EQ(client->ReadStatistics().snapshots, 1U);
  EXPECT_EQ(client->ServerTime(now), 0);
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

// Every bit of an honest snapshot flipped and every length. The head's first six bytes (kind, version, sequence) come
// last: a packet with a sequence far ahead makes all that follow too old to look at.
TEST_F(ClientTest, SurvivesDamagedSnapshots) {
  Join();
  const auto first = MakeRecord(3, {{1, 2, 3}, {}}), second = MakeRecord(8, {});
  std::uint32_t sequence = 0;
  const auto makeWhole = [&] { return MakeSnapshot({++sequence, 130, 1, 0}, {first, second}); };
  const std::size_t size = makeWhole().size();
  for (std::size_t length = 0; length < size; ++length) {
    const Message whole = makeWhole();
    Arrive(Channel::kSnapshot, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
  }
  // All but two are broken: the head alone, and the head with the first record.
  EXPECT_EQ(client->ReadStatistics().badSnapshots, size - 2);

  std::vector<BodySample> samples;
  for (std::size_t i = 0; i < size * 8; ++i) {
    Message damaged = makeWhole();
    const std::size_t bit = (i + 6 * 8) % (size * 8);
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    Arrive(Channel::kSnapshot, std::move(damaged));
    client->Sample(now += 0.001, Detail::kVertices, samples);
    for (const BodySample& sample : samples) {
      ASSERT_TRUE(std::isfinite(sample.pose.centroid.x) && std::isfinite(sample.pose.rotation.w));
    }
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_GT(client->ReadStatistics().badRecords, 20U);
  EXPECT_GT(client->ReadStatistics().snapshots, 100U);
}

// The tetrahedron without two of its faces, and a body of springs alone.
Message MakeTornTetrahedron() {
  const std::vector<Vector3> rest{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 3, 1}};
  return protocol::MakeBlueprint({.name = "torn", .rest = rest, .faces = faces, .size = 1.732F});
}
const std::vector<Vector3> kChainRest{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
Message MakeChain() {
  const std::vector<std::array<std::uint16_t, 2>> edges{{0, 1}, {1, 2}};
  return protocol::MakeBlueprint({.name = "chain", .rest = kChainRest, .size = 0.8F, .edges = edges});
}

TEST_F(ClientTest, KnowsWhichBlueprintsAreOpenAndWhichAreOfEdges) {
  Join();
  for (const Message& chunk : CutIntoChunks(1, MakeTornTetrahedron(), 64)) Arrive(Channel::kControl, chunk);
  for (const Message& chunk : CutIntoChunks(2, MakeChain(), 64)) Arrive(Channel::kControl, chunk);
  Snapshot(1, {MakeRecord(3, {}), MakeRecord(4, {}, 1), MakeRecord(5, {}, 2, 0, kChainRest)});
  std::vector<BodySample> samples;
  client->Sample(now, Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), 3U) << "blueprints beyond the welcome's count may come at any time";
  EXPECT_FALSE(samples[0].blueprint->open);
  EXPECT_TRUE(samples[1].blueprint->open);
  EXPECT_TRUE(samples[0].blueprint->edges.empty());
  ASSERT_EQ(samples[2].blueprint->edges.size(), 2U);
  EXPECT_EQ(samples[2].blueprint->edges[1][1], 2);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
}

TEST_F(ClientTest, ARecordIsReadUnderItsOwnGenerationAlone) {
  Join();
  const auto chunks = CutIntoChunks(0, MakeChain(), 64, 1);
  Snapshot(1, {MakeRecord(3, {})});
  now += 1.0 / 30;
  // Overtakes the blueprint that it needs: held back by nothing, left out.
  Snapshot(2, {MakeRecord(3, {}, 0, 1, kChainRest)});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U);
  for (std::size_t i = 0; i + 1 < chunks.size(); ++i) Arrive(Channel::kControl, chunks[i]);
  Snapshot(3, {MakeRecord(8, {})});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 1U) << "the old one holds until the new one is whole";
  Arrive(Channel::kControl, chunks.back());
  Snapshot(4, {MakeRecord(9, {})});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 2U) << "late, of the generation before";
  Snapshot(5, {MakeRecord(10, {}, 0, 1, kChainRest)});
  EXPECT_EQ(client->ReadStatistics().unknownRecords, 2U);
  EXPECT_EQ(client->ReadStatistics().badRecords, 0U);
  EXPECT_EQ(client->ReadStatistics().badMessages, 0U);
  Arrive(Channel::kControl, chunks[0]);
  EXPECT_EQ(client->ReadStatistics().badMessages, 1U) << "the generation that is here already";

  std::vector<BodySample> samples;
  client->Sample(now, Detail::kVertices, samples);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[0].blueprint->name, "tetrahedron") << "bodies keep what they were made from";
  EXPECT_EQ(samples[2].blueprint->name, "chain");
  EXPECT_EQ(samples[2].vertices.size(), 3U);
}

// Moves at 6 m/s and is a chain from 0.5 s on, then torn; half of the records come in the wrong order.
TEST_F(ClientTest, ABodyGoesOverToAnotherBlueprintWithoutAJump) {
  for (const bool isTorn : {false, true}) {
    SCOPED_TRACE(isTorn ? "the same rest shape" : "another number of vertices");
    link = {};
    now = 50;
    Join();
    const Message other = isTorn ? MakeTornTetrahedron() : MakeChain();
    for (const Message& chunk : CutIntoChunks(1, other, 64)) Arrive(Channel::kControl, chunk);
    std::uint32_t sequence = 0;
    std::vector<BodySample> samples;
    double changedAt = 0, before = 0;
    for (int frame = 0; frame < 60; ++frame) {
      const auto makePacket = [&](int i) {
        const double time = i / 30.0;
        const Pose pose{{static_cast<float>(6 * time), 0, 0}, {}};
        const protocol::SnapshotHead head{++sequence, 100 + static_cast<std::uint32_t>(2 * i), 1, 0};
        if (i < 15) return MakeSnapshot(head, {MakeRecord(3, pose)});
        return MakeSnapshot(head, {isTorn ? MakeRecord(3, pose, 1) : MakeRecord(3, pose, 1, 0, kChainRest)});
      };
      if (frame % 2 == 1) {
        Arrive(Channel::kSnapshot, makePacket(frame));
        Arrive(Channel::kSnapshot, makePacket(frame - 1));
      }
      now += 1.0 / 30;
      client->Sample(now, Detail::kVertices, samples);
      if (samples.empty()) continue;
      ASSERT_EQ(samples.size(), 1U);
      ASSERT_EQ(samples[0].vertices.size(), samples[0].blueprint->rest.size());
      const double x = static_cast<double>(samples[0].pose.centroid.x);
      EXPECT_TRUE(frame <= 8 || std::fabs(x - before - 0.2) < 0.05) << "frame " << frame << ": " << x - before;
      before = x;
      if (changedAt == 0 && samples[0].blueprint->name != "tetrahedron") changedAt = x;
    }
    EXPECT_NEAR(changedAt, 6 * 0.5, 0.21) << "where it was when it changed, within a frame";
    EXPECT_EQ(client->ReadStatistics().badRecords, 0U);
  }
}

TEST_F(ClientTest, RefusesBlueprintChunksThatDoNotAddUp) {
  const Message blueprint = MakeTetrahedron();
  const auto total = static_cast<std::uint32_t>(blueprint.size());
  const auto hash = protocol::HashBytes(blueprint);
  const auto part = [&](std::uint32_t begin, std::uint32_t end) {
    return std::span(blueprint).subspan(begin, end - begin);
  };
  Start();
  Connect();
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, hash, total, 0, part(0, 40)));  // before the welcome
  EXPECT_EQ(client->ReadStatistics().badMessages, 1U);
  Welcome();
  Welcome();  // again
  EXPECT_EQ(client->ReadStatistics().badMessages, 2U);
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(255, hash, total, 0, part(0, 40)));  // no such number
  EXPECT_EQ(client->ReadStatistics().badMessages, 3U);

  const auto begin = [&] { Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, hash, total, 0, part(0, 40))); };
  const std::vector<Message> wrongSeconds{
      protocol::MakeBlueprintChunk(0, hash, total, 48, part(48, 80)),        // a gap
      protocol::MakeBlueprintChunk(0, hash, total, 0, part(0, 40)),          // the first again
      protocol::MakeBlueprintChunk(0, hash, total - 8, 40, part(40, 80)),    // another total
      protocol::MakeBlueprintChunk(0, hash ^ 1, total, 40, part(40, 80)),    // another hash
      protocol::MakeBlueprintChunk(0, hash, total, 40, part(0, total - 40))  // whole, but not what the hash says
  };
  for (const Message& wrong : wrongSeconds) {
    const auto before = client->ReadStatistics().badMessages;
    begin();
    EXPECT_EQ(client->ReadStatistics().badMessages, before);
    Arrive(Channel::kControl, wrong);
    EXPECT_EQ(client->ReadStatistics().badMessages, before + 1);
    EXPECT_EQ(client->ReadState(), State::kJoining);
  }
  // A whole that could be drawn from, but not the one that its hash names.
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, hash ^ 1, total, 0, blueprint));
  EXPECT_EQ(client->ReadState(), State::kJoining);
  const Message nonsense(128, 0x41);  // the hash is right, the content is not
  Arrive(Channel::kControl, protocol::MakeBlueprintChunk(0, protocol::HashBytes(nonsense), 128, 0, nonsense));
  EXPECT_EQ(client->ReadState(), State::kJoining);
  const auto before = client->ReadStatistics().badMessages;

  for (const Message& chunk : CutIntoChunks(0, blueprint, 40)) Arrive(Channel::kControl, chunk);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_EQ(client->ReadStatistics().badMessages, before);
  begin();  // after it was complete
  EXPECT_EQ(client->ReadStatistics().badMessages, before + 1);
}

TEST_F(ClientTest, ShowsWhyTheServerSaidGoodbye) {
  Start();
  Connect();
  Arrive(Channel::kControl,
         protocol::MakeServerGoodbye(wire::GoodbyeReason::ServerFull, "64 of\n\x1b[31m 64 " + std::string(5000, 'x')));
  EXPECT_EQ(client->ReadState(), State::kEnded);
  EXPECT_TRUE(client->EndedUnasked());
  EXPECT_EQ(client->EndReason().substr(0, 27), "server is full: 64 of  [31m");
  EXPECT_LT(client->EndReason().size(), 250U);
  EXPECT_EQ(link.disconnects, 1);
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason().substr(0, 14), "server is full");
}

TEST_F(ClientTest, EndsWhenNobodyAnswersOrTheLinkIsLost) {
  Start();
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason(), "no answer from the server");
  Start();
  client->Update(now += protocol::kSilenceTimeout - 0.1);
  EXPECT_EQ(client->ReadState(), State::kConnecting);
  client->Update(now += 0.2);
  EXPECT_EQ(client->EndReason(), "no answer from the server");
  Join();
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason(), "connection lost");
  EXPECT_TRUE(client->EndedUnasked());
}

TEST_F(ClientTest, EndsWhenTheServerIsSilent) {
  Join();
  for (int i = 0; i < 79; ++i) client->Update(now += 0.1);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  for (int i = 0; i < 2; ++i) client->Update(now += 0.1);
  EXPECT_EQ(client->ReadState(), State::kEnded);
  EXPECT_EQ(client->EndReason(), "server silent for 8 s");
  const std::size_t sent = link.sent.size();
  client->Update(now += 1);
  EXPECT_EQ(link.sent.size(), sent);
}

TEST_F(ClientTest, WaitsEightRoundTripsLongerForItsWelcomeThanInPlay) {
  link.roundTrip = 0.5;
  Start();
  Connect();
  client->Update(now += 8 + 4 - 0.1);
  EXPECT_EQ(client->ReadState(), State::kJoining);
  client->Update(now += 0.2);
  EXPECT_EQ(client->EndReason(), "server silent for 12 s");
  Join();
  client->Update(now += 8 + 0.1);
  EXPECT_EQ(client->EndReason(), "server silent for 8 s");

  link.roundTrip = 100;  // nobody waits that long
  Start();
  Connect();
  client->Update(now += 8 + 24 + 0.1);
  EXPECT_EQ(client->EndReason(), "server silent for 32 s");
}

TEST_F(ClientTest, EndsOverALinkOnWhichHardlyAnythingArrives) {
  for (const unsigned everyNth : {4u, 10u}) {
    Join();
    const double begin = now;
    for (std::uint32_t sequence = 1; sequence <= 40 * 30 && client->ReadState() != State::kEnded; ++sequence) {
      now += 1.0 / 30;
      if (sequence % everyNth == 0) Snapshot(sequence);
      client->Update(now);
    }
    EXPECT_EQ(client->ReadState(), everyNth == 4 ? State::kPlaying : State::kEnded);
    if (everyNth == 4) continue;
    EXPECT_LT(now - begin, 2 * protocol::kSilenceTimeout + 0.1);
    EXPECT_EQ(client->EndReason(), "connection too poor: 432 of the last 480 packets were lost");
  }
}

TEST_F(ClientTest, ABlackoutThatEndsInTimeIsNoPoorLink) {
  Join();
  for (std::uint32_t sequence = 1; sequence <= 60 * 30; ++sequence) {
    now += 1.0 / 30;
    if (sequence % (16 * 30) >= 7 * 30) Snapshot(sequence);
    client->Update(now);
  }
  EXPECT_EQ(client->ReadState(), State::kPlaying) << client->EndReason();
}

TEST_F(ClientTest, LeavesWithAGoodbyeAndDoesNotWaitForEver) {
  Join();
  link.sent.clear();
  client->Leave(now);
  ASSERT_EQ(link.sent.size(), 1U);
  const wire::ClientMessage* message = nullptr;
  ASSERT_EQ(protocol::ParseClientMessage(link.sent[0].bytes, message), protocol::ParseResult::kOk);
  ASSERT_NE(message->body_as_Goodbye(), nullptr);
  EXPECT_EQ(link.disconnects, 1);
  client->Update(now += 0.5);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  EXPECT_EQ(link.sent.size(), 1U);  // no inputs any more
  client->Update(now += 0.6);
  EXPECT_EQ(client->ReadState(), State::kEnded);
  EXPECT_EQ(client->EndReason(), "left");
  EXPECT_FALSE(client->EndedUnasked());

  Join();
  link.roundTrip = 0.5;
  client->Leave(now);
  client->Update(now += 2.9);
  EXPECT_EQ(client->ReadState(), State::kPlaying);
  client->Update(now += 0.2);
  EXPECT_EQ(client->ReadState(), State::kEnded);

  Join();
  link.roundTrip = 1000;  // whatever it claims
  client->Leave(now);
  client->Update(now += kLongestLeave);
  EXPECT_EQ(client->ReadState(), State::kEnded);
  link.roundTrip = 0;

  Join();
  client->Leave(now);
  Arrive(transport::Event::Kind::kDisconnected);
  EXPECT_EQ(client->EndReason(), "left");
  Start();
  client->Leave(now);  // before it was connected
  EXPECT_EQ(client->EndReason(), "left");
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

struct LinkCase {
  const char* name;
  double loss;       // share
  double jitter;     // seconds, uniform
  double reordered;  // share held back by another 40 ms
  double maxError;   // metres RMS, of a body that goes round at 6 m/s and bounces
  double maxDelay;   // seconds
  double maxHeld;    // share of frames
};

class ClientOverLink : public ClientTest, public testing::WithParamInterface<LinkCase> {};

Pose PoseAt(double t) {
  const double angle = 4 * t;
  return {{static_cast<float>(3 * std::cos(2 * t)), static_cast<float>(3 * std::sin(2 * t)),
           static_cast<float>(std::fabs(std::sin(3 * t)))},
          {static_cast<float>(std::cos(angle / 2)), 0, 0, static_cast<float>(std::sin(angle / 2))}};
}

// What is shown stays close to where the body was at the moment that is shown.
TEST_P(ClientOverLink, FollowsABody) {
  const LinkCase& conditions = GetParam();
  Join();
  std::mt19937 random(20);
  std::uniform_real_distribution<double> chance(0, 1);
  std::vector<Link::Arrival> arrivals;
  for (std::uint32_t i = 1; i <= 30 * 60; ++i) {
    if (chance(random) < conditions.loss) continue;
    const double delay =
        0.05 + conditions.jitter * chance(random) + (chance(random) < conditions.reordered ? 0.04 : 0.0);
    const std::uint32_t tick = 100 + 2 * i;
    arrivals.push_back({joinedAt + i / 30.0 + delay, transport::Event::Kind::kMessage, Channel::kSnapshot,
                        MakeSnapshot({i, tick, 1, 0}, {MakeRecord(3, PoseAt(tick / 60.0))})});
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const Link::Arrival& a, const Link::Arrival& b) { return a.at < b.at; });
  link.arrivals.assign(arrivals.begin(), arrivals.end());

  std::vector<BodySample> samples;
  double sum = 0, lastShown = 0;
  int frames = 0;
  for (; now < joinedAt + 60; now += 1.0 / kTickHz) {
    client->Update(now);
    client->Sample(now, Detail::kPosesOnly, samples);
    if (now < joinedAt + 3) continue;
    ASSERT_EQ(samples.size(), 1U);
    const double shown = client->ServerTime(now) - client->InterpolationDelay();
    ASSERT_GT(shown, lastShown);
    lastShown = shown;
    const float error = protocol::Length(samples[0].pose.centroid - PoseAt(shown).centroid);
    sum += static_cast<double>(error * error);
    ++frames;
  }
  const double rms = std::sqrt(sum / frames);
  const auto held = static_cast<double>(client->ReadStatistics().framesHeld) / frames;
  std::printf("%s: %.1f mm RMS off, delay %.0f ms, %.2f %% of frames held\n", conditions.name, 1000 * rms,
              1000 * client->InterpolationDelay(), 100 * held);
  EXPECT_LT(rms, conditions.maxError);
  EXPECT_LT(client->InterpolationDelay(), conditions.maxDelay);
  EXPECT_LE(held, conditions.maxHeld);
}

INSTANTIATE_TEST_SUITE_P(Links, ClientOverLink,
                         testing::Values(LinkCase{"Clean", 0, 0, 0, 0.006, 0.075, 0},
                                         LinkCase{"Loss5Jitter20", 0.05, 0.020, 0, 0.010, 0.110, 0},
                                         LinkCase{"Loss5Jitter20Reordered4", 0.05, 0.020, 0.04, 0.010, 0.150, 0},
                                         LinkCase{"Loss20Jitter100Reordered4", 0.20, 0.100, 0.04, 0.012, 0.250, 0.02}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace wobble::client
