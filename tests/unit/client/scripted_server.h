// A client whose server is scripted by the test, message by message.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <vector>

#include "client/client.h"
#include "protocol/codec/encoding/shape_encoder.h"
#include "protocol/codec/pose.h"
#include "protocol/snapshot.h"

namespace wobble::client {

using protocol::Message;
using protocol::Pose;
using protocol::Vector3;
using transport::Channel;

inline constexpr transport::ConnectionId kConnection = 5;
inline constexpr std::uint16_t kTickHz = 60;

// The test's view of a transport that the client owns.
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
inline Message MakeTetrahedron() {
  const std::vector<Vector3> rest{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::vector<std::array<std::uint16_t, 3>> faces{{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  return protocol::MakeBlueprint({.name = "tetrahedron", .rest = rest, .faces = faces, .size = 1.732F});
}
inline Message MakeStrip() {
  std::vector<Vector3> rest;
  std::vector<std::array<std::uint16_t, 3>> faces;
  for (std::uint16_t i = 0; i < 600; ++i) {
    rest.push_back({static_cast<float>(i) * 0.01F, static_cast<float>(i % 2), 0});
    if (i >= 2) faces.push_back({static_cast<std::uint16_t>(i - 2), static_cast<std::uint16_t>(i - 1), i});
  }
  return protocol::MakeBlueprint({.name = "strip", .rest = rest, .faces = faces, .size = 2.0F});
}

inline std::vector<Message> CutIntoChunks(std::uint8_t index, const Message& blueprint, std::size_t chunkBytes,
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

// A record of a body in its rest shape at this pose; patch 0.
inline std::vector<std::uint8_t> MakeRecord(std::uint32_t body, const Pose& pose, std::uint8_t blueprint = 0,
                                            std::uint8_t generation = 0,
                                            const std::vector<Vector3>& rest = {
                                                {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}) {
  const protocol::PatchModel model{.rest = rest,
                                   .size = rest.size() == 4 ? 1.732F : 0.8F};  // the size of its blueprint
  const Pose seen = protocol::Dequantise(protocol::Quantise(pose, protocol::MakePoseGrid(12, model.size)));
  std::vector<Vector3> world;
  for (const Vector3& point : rest) world.push_back(protocol::Transform(seen, point));
  std::vector<std::uint8_t> payload, record;
  protocol::ShapeEncoder encoder;
  EXPECT_TRUE(encoder.Encode(model, pose, world, 0.001F, 512, payload).fits);
  protocol::AppendRecord({.body = body, .blueprint = blueprint, .generation = generation}, payload, record);
  return record;
}

inline Message MakeSnapshot(const protocol::SnapshotHead& head,
                            const std::vector<std::vector<std::uint8_t>>& records = {}) {
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
    Arrive(Channel::kControl, protocol::MakeWelcome({.clientId = 9,
                                                     .ownBody = 3,
                                                     .tick = 100,
                                                     .tickHz = kTickHz,
                                                     .snapshotHz = 30,
                                                     .scene = "arena",
                                                     .blueprintCount = blueprints,
                                                     .obstacles = {}}));
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
    Arrive(Channel::kSnapshot,
           MakeSnapshot({.sequence = sequence, .tick = CurrentTick(), .inputTick = inputTick}, records));
  }
  [[nodiscard]] std::uint32_t CurrentTick() const {
    return 100 + static_cast<std::uint32_t>(std::lround((now - joinedAt) * kTickHz));
  }
  // The inputs that were sent, parsed.
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

}  // namespace wobble::client
