// A whole game in one process on virtual time: a server, clients and raw connections on one seeded network.
//
// A step is one tick of the server, then one update of each client. A test gives the seconds to run, and gets the same
// bits each time.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/client.h"
#include "protocol/transport/admission.h"
#include "protocol/transport/virtual_network.h"
#include "server/scenes/loader.h"
#include "server/server.h"
#include "tests/support/places.h"

namespace wobble::test {

inline scenes::Scene LoadShippedScene(const std::string& name) {
  scenes::LoadResult loaded = scenes::LoadScene(name, FindSource("server/scenes"));
  for (const std::string& error : loaded.errors) ADD_FAILURE() << error;
  return std::move(loaded.scene);
}

// A floor of 12 m by 12 m, a kill height below it, one ball of 42 vertices and players of the same kind. more: further
// TOML tables.
inline scenes::Scene MakeYard(const std::string& more = "") {
  scenes::LoadResult loaded = scenes::ParseScene(std::string(R"(
kill_height = -5
[[obstacle]]
kind = "box"
center = [0, 0, -1]
half_extents = [6, 6, 1]
[[blueprint]]
name = "ball"
subdivisions = 1
mass = 4
gas = 150
[[bodies]]
blueprint = "ball"
position = [3, 3, 1]
[player]
blueprint = "ball"
spawn = [0, 0, 1]
spawn_radius = 2
)") + more,
                                                 "yard");
  for (const std::string& error : loaded.errors) ADD_FAILURE() << error;
  return std::move(loaded.scene);
}

// A connection that sends what the test asks for and stores what it receives.
class RawConnection {
 public:
  explicit RawConnection(std::unique_ptr<transport::Transport> transport) : m_transport(std::move(transport)) {}

  void Poll(double now) {
    m_transport->Poll(now, [this](const transport::Event& event) {
      using Kind = transport::Event::Kind;
      if (event.kind == Kind::kConnected) m_connection = event.connection;
      if (event.kind == Kind::kDisconnected) m_closed = true;
      if (event.kind == Kind::kMessage && event.channel == transport::Channel::kControl) {
        m_control.emplace_back(event.bytes.begin(), event.bytes.end());
      }
      if (event.kind == Kind::kMessage && event.channel == transport::Channel::kSnapshot) {
        m_snapshots.emplace_back(event.bytes.begin(), event.bytes.end());
      }
    });
  }
  void Send(transport::Channel channel, const std::vector<std::uint8_t>& bytes) {
    ASSERT_EQ(m_transport->Send(m_connection, channel, bytes), transport::SendResult::kQueued);
  }

  [[nodiscard]] bool Connected() const { return m_connection != 0 && !m_closed; }
  [[nodiscard]] bool Closed() const { return m_closed; }
  [[nodiscard]] const std::vector<protocol::Message>& Control() const { return m_control; }
  [[nodiscard]] const std::vector<protocol::Message>& Snapshots() const { return m_snapshots; }
  // Reason of the goodbye that arrived; -1: none.
  [[nodiscard]] int GoodbyeReason() const {
    for (const protocol::Message& bytes : m_control) {
      const protocol::wire::ServerMessage* message = nullptr;
      if (protocol::ParseServerMessage(bytes, message) != protocol::ParseResult::kOk) continue;
      if (const auto* goodbye = message->body_as_Goodbye()) return static_cast<int>(goodbye->reason());
    }
    return -1;
  }

 private:
  std::unique_ptr<transport::Transport> m_transport;
  transport::ConnectionId m_connection = 0;
  bool m_closed = false;
  std::vector<protocol::Message> m_control;
  std::vector<protocol::Message> m_snapshots;
};

// A server's endpoint that says of each client what a vestibule would have said, `admission` at that moment, and of
// those who were not let in `turnaways`.
class AdmittingTransport final : public transport::Transport {
 public:
  using Turnaways = std::array<transport::Turnaways, transport::kTurnawayCount>;
  AdmittingTransport(std::unique_ptr<transport::Transport> inner, const transport::Admission& admission,
                     const Turnaways& turnaways)
      : m_inner(std::move(inner)), m_admission(admission), m_turnaways(turnaways) {}

  void Poll(double now, const Sink& sink) override {
    m_inner->Poll(now, [&](transport::Event event) {
      if (event.kind == transport::Event::Kind::kConnected) event.admission = &m_admission;
      sink(event);
    });
  }
  transport::SendResult Send(transport::ConnectionId connection, transport::Channel channel,
                             std::span<const std::uint8_t> message) override {
    return m_inner->Send(connection, channel, message);
  }
  void Disconnect(transport::ConnectionId connection) override { m_inner->Disconnect(connection); }
  void Flush() override { m_inner->Flush(); }
  [[nodiscard]] transport::Statistics ReadStatistics() const override {
    transport::Statistics statistics = m_inner->ReadStatistics();
    statistics.turnaways = m_turnaways;
    return statistics;
  }
  [[nodiscard]] double ReadRoundTrip(transport::ConnectionId connection) const override {
    return m_inner->ReadRoundTrip(connection);
  }

 private:
  std::unique_ptr<transport::Transport> m_inner;
  const transport::Admission& m_admission;
  const Turnaways& m_turnaways;
};

class Game {
 public:
  explicit Game(scenes::Scene scene, const server::Config& config = {}, std::uint64_t networkSeed = 1,
                server::TimeSource clock = {})
      : network({networkSeed}),
        server(config, std::move(scene),
               std::make_unique<AdmittingTransport>(network.MakeServer(), admission, turnaways), 0, {},
               std::move(clock)) {}

  client::Client& AddClient(const client::Options& options = {}) {
    clients.push_back(std::make_unique<client::Client>(network.MakeClient(), options, now));
    return *clients.back();
  }
  RawConnection& AddRaw() {
    raw.push_back(std::make_unique<RawConnection>(network.MakeClient()));
    return *raw.back();
  }

  void Step() {
    now = server.NextCall();
    server.Tick(now);
    for (auto& each : clients) each->Update(now);
    for (auto& each : raw) each->Poll(now);
  }
  void Run(double seconds) {
    for (const double end = now + seconds; now < end;) Step();
  }
  // The centre of the body in the server's world.
  [[nodiscard]] physics::Vector3d Centre(std::uint32_t body) const {
    return server.World().FindCentre(server.World().ReadBody(body));
  }
  [[nodiscard]] bool HasBody(std::uint32_t wanted) const {
    for (const physics::Body& body : server.World().Bodies()) {
      if (body.id == wanted) return true;
    }
    return false;
  }

  transport::VirtualNetwork network;
  transport::Admission admission;  // of who connects from now on
  AdmittingTransport::Turnaways turnaways{};
  server::Server server;
  std::vector<std::unique_ptr<client::Client>> clients;
  std::vector<std::unique_ptr<RawConnection>> raw;
  double now = 0;
};

}  // namespace wobble::test
