// A server of the test's own that a wobble_client joins over loopback: two tetrahedra, the first one its own.
#pragma once

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "client/wobble.h"
#include "protocol/transport/enet_transport.h"
#include "tests/unit/client/scripted_server.h"

namespace wobble::c {

using client::Message;
using transport::Channel;
namespace wire = protocol::wire;

inline constexpr std::uint32_t kOwnBody = 3, kOtherBody = 8;

class ScriptedWorld {
 public:
  ScriptedWorld() {
    std::string error;
    m_transport = transport::EnetTransport::Listen({.host = "127.0.0.1"}, error);
    if (m_transport == nullptr) throw std::runtime_error(error);
  }

  [[nodiscard]] std::string Address() const { return "127.0.0.1:" + std::to_string(m_transport->ReadPort()); }

  // One tick: takes in what has come and sends where the bodies are. The own one moves.
  void Tick(double now) {
    m_transport->Poll(now, [this](const transport::Event& event) { TakeIn(event); });
    if (welcomed) {
      const float x = static_cast<float>(++m_sequence) * 0.01F;
      const client::Message snapshot = client::MakeSnapshot(
          {.sequence = m_sequence, .tick = 100 + m_sequence},
          {client::MakeRecord(kOwnBody, {{x, 0, 2}, {}}), client::MakeRecord(kOtherBody, {{0, 5, 2}, {}})});
      static_cast<void>(m_transport->Send(connection, Channel::kSnapshot, snapshot));
    }
    m_transport->Flush();
  }
  void Send(const Message& message) { static_cast<void>(m_transport->Send(connection, Channel::kControl, message)); }

  bool welcomed = false;
  int commands = 0;     // pushes and cuts
  int badMessages = 0;  // that no honest client sends
  wire::InputFrame newestInput;
  std::uint32_t heldBody = 0;
  transport::ConnectionId connection = 0;

 private:
  void TakeIn(const transport::Event& event) {
    if (event.kind == transport::Event::Kind::kConnected) connection = event.connection;
    if (event.kind == transport::Event::Kind::kDisconnected) welcomed = false;
    if (event.kind == transport::Event::Kind::kOffence) ++badMessages;
    if (event.kind != transport::Event::Kind::kMessage) return;
    const wire::ClientMessage* message = nullptr;
    if (protocol::ParseClientMessage(event.bytes, message) != protocol::ParseResult::kOk) {
      ++badMessages;
      return;
    }
    if (message->body_as_Hello() != nullptr) Welcome();
    if (message->body_as_Push() != nullptr || message->body_as_Cut() != nullptr) ++commands;
    if (const auto* input = message->body_as_Input()) {
      newestInput = *input->frames()->Get(0);
      heldBody = input->hand() == nullptr ? 0 : input->hand()->body();
    }
  }

  void Welcome() {
    welcomed = true;
    Send(protocol::MakeWelcome({.clientId = 9,
                                .ownBody = kOwnBody,
                                .tick = 100,
                                .tickHz = 60,
                                .snapshotHz = 60,
                                .scene = "pond",
                                .blueprintCount = 1,
                                .obstacles = {{wire::ObstacleKind::Sphere, {1, 2, 3}, {}, 4}},
                                .hands = protocol::kMayGrab | protocol::kMayBuild,
                                .reach = 2.5F}));
    for (const Message& chunk : client::CutIntoChunks(0, client::MakeTetrahedron(), 64)) Send(chunk);
  }

  std::unique_ptr<transport::EnetTransport> m_transport;
  std::uint32_t m_sequence = 0;
};

// A client, and the world that it joins.
struct Joined {
  Joined() {
    const std::string address = world.Address();
    const wobble_connect_options options{.struct_size = sizeof options,
                                         .flags = 0,
                                         .address = address.c_str(),
                                         .name = "Ada",
                                         .password = nullptr,
                                         .token = nullptr,
                                         .invite = nullptr,
                                         .server_key = nullptr};
    EXPECT_EQ(wobble_connect(&options, now, &client), WOBBLE_OK);
  }
  ~Joined() { wobble_destroy(client); }
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;

  // Ticks of virtual time, each at least a millisecond of the threads' and ENet's own.
  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      now += 1.0 / 60;
      world.Tick(now);
      EXPECT_EQ(wobble_update(client, now), WOBBLE_OK);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  [[nodiscard]] wobble_status Status() const {
    wobble_status status{};
    status.struct_size = sizeof status;
    EXPECT_EQ(wobble_read_status(client, &status), WOBBLE_OK);
    return status;
  }
  // Until it is in that state, for 20 s of virtual time.
  [[nodiscard]] bool RunUntil(std::int32_t state) {
    for (int i = 0; i < 1200 && Status().state != state; ++i) Run(1);
    return Status().state == state;
  }

  ScriptedWorld world;
  wobble_client* client = nullptr;
  double now = 10;
};

}  // namespace wobble::c
