// A server of the test's own that a wobble_client joins over loopback: two tetrahedra, the first one its own. With a
// workshop they are made of particles and springs, and the other one is what players build.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "client/wobble.h"
#include "protocol/transport/enet_transport.h"
#include "tests/unit/client/scripted_server.h"

namespace wobble::c {

using client::Message;
using transport::Channel;
namespace wire = protocol::wire;

inline constexpr std::uint32_t kOwnBody = 3, kOtherBody = 8;

// A struct of wobble.h that says its size; all else is zero.
template <typename Struct>
Struct Make() {
  Struct made{};
  made.struct_size = sizeof made;
  return made;
}

// Particles 10 to 13 and three springs, 20 to 22.
inline Message MakeGraph() {
  const std::vector<protocol::Vector3> rest{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const std::vector<std::array<std::uint16_t, 2>> edges{{0, 1}, {1, 2}, {2, 3}};
  const std::vector<wire::ParticleTag> particles{
      {0.5F, 0, 10, true}, {1, 9, 11, false}, {1, 9, 12, false}, {2, 0, 13, false}};
  const std::vector<wire::SpringTag> springs{{100, 1, 2.5F, 0, 20}, {200, 2, 3, 9, 21}, {300, 3, 3.5F, 9, 22}};
  return protocol::MakeBlueprint(
      {.name = "graph", .rest = rest, .size = 1.732F, .edges = edges, .particles = particles, .springs = springs});
}

class ScriptedWorld {
 public:
  explicit ScriptedWorld(transport::ListenOptions options) {
    std::string error;
    options.host = "127.0.0.1";
    m_transport = transport::EnetTransport::Listen(options, error);
    if (m_transport == nullptr) throw std::runtime_error(error);
  }

  [[nodiscard]] std::uint16_t Port() const { return m_transport->ReadPort(); }

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

  bool hasWorkshop = false;
  bool welcomed = false;
  bool isSpectator = false;
  int commands = 0;               // pushes and cuts
  std::vector<std::string> told;  // lines, numbers of emotes, and names
  int badMessages = 0;            // that no honest client sends
  // Newest of these commands.
  protocol::BuildFields built;
  std::pair<wire::TuneKind, protocol::Vector3> tuned{wire::TuneKind::Gravity, {}};
  std::string ordered;
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
    if (const auto* hello = message->body_as_Hello()) {
      isSpectator = hello->role() == wire::Role::Spectator;
      Welcome();
    }
    if (const auto* say = message->body_as_Say()) told.push_back(say->text()->str());
    if (const auto* emote = message->body_as_Emote()) told.push_back(std::to_string(static_cast<int>(emote->kind())));
    if (const auto* rename = message->body_as_Rename()) told.push_back(rename->name()->str());
    if (message->body_as_Push() != nullptr || message->body_as_Cut() != nullptr) ++commands;
    if (const auto* build = message->body_as_Build()) {
      built = {build->kind(),       build->a(),
               build->b(),          {build->at()->x(), build->at()->y(), build->at()->z()},
               build->mass(),       build->fixed(),
               build->stiffness(),  build->damping(),
               build->rest_length()};
    }
    if (const auto* tune = message->body_as_Tune()) {
      tuned = {tune->kind(), {tune->value()->x(), tune->value()->y(), tune->value()->z()}};
    }
    if (const auto* order = message->body_as_Order()) ordered = order->line()->str();
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
                                .reach = 2.5F,
                                .game = hasWorkshop ? "sumo" : "",
                                .workshop = hasWorkshop ? kOtherBody : 0,
                                .rank = wire::Rank::Moderator}));
    const Message blueprint = hasWorkshop ? MakeGraph() : client::MakeTetrahedron();
    for (const Message& chunk : client::CutIntoChunks(0, blueprint, 64)) Send(chunk);
  }

  std::unique_ptr<transport::EnetTransport> m_transport;
  std::uint32_t m_sequence = 0;
};

// A client, and the world that it joins.
struct Joined {
  explicit Joined(const transport::ListenOptions& listen = {}, const char* password = nullptr, std::uint32_t flags = 0)
      : world(std::make_unique<ScriptedWorld>(listen)) {
    const std::string address = "127.0.0.1:" + std::to_string(world->Port());
    auto options = Make<wobble_connect_options>();
    options.flags = flags;
    options.address = address.c_str();
    options.password = password;
    EXPECT_EQ(wobble_connect(&options, now, &client), WOBBLE_OK);
  }
  ~Joined() { wobble_destroy(client); }
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;

  // Ticks of virtual time, each at least two milliseconds of the door's thread and of ENet, which have clocks of their
  // own.
  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      now += 1.0 / 60;
      if (world != nullptr) world->Tick(now);
      EXPECT_EQ(wobble_update(client, now), WOBBLE_OK);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  // For 20 s of virtual time at most.
  template <typename Condition>
  [[nodiscard]] bool RunUntil(Condition&& holds) {
    for (int i = 0; i < 1200; ++i) {
      if (holds()) return true;
      Run(1);
    }
    return false;
  }
  [[nodiscard]] bool RunUntilState(std::int32_t state) {
    return RunUntil([&] { return Status().state == state; });
  }
  [[nodiscard]] wobble_status Status() const {
    auto status = Make<wobble_status>();
    EXPECT_EQ(wobble_read_status(client, &status), WOBBLE_OK);
    return status;
  }

  std::unique_ptr<ScriptedWorld> world;  // null: it is not there at present
  wobble_client* client = nullptr;
  double now = 10;
};

}  // namespace wobble::c
