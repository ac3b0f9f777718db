// Servers and clients over ENet on the loopback interface, for tests: connected directly, or through a forwarder that
// the test controls.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "protocol/transport/enet_transport.h"
#include "tests/support/udp_socket.h"

namespace wobble::test {

using transport::Channel;
using transport::ConnectionId;
using transport::EnetTransport;
using transport::Event;
using transport::ListenOptions;
using transport::SendResult;

// An event, with a copy of its bytes.
struct ReportedEvent {
  Event::Kind kind;
  ConnectionId connection;
  Channel channel;
  Bytes bytes;
};

// A transport and the events that it has reported.
struct Endpoint {
  void Poll() { PollAt(Now()); }
  void PollAt(double now) {
    transport->Poll(now, [this](const Event& event) {
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(event.bytes.data()) % 8, 0u);
      log.push_back({event.kind, event.connection, event.channel, {event.bytes.begin(), event.bytes.end()}});
    });
  }
  std::size_t Count(Event::Kind kind) const {
    return static_cast<std::size_t>(
        std::count_if(log.begin(), log.end(), [&](const ReportedEvent& seen) { return seen.kind == kind; }));
  }
  bool IsConnected() const { return Count(Event::Kind::kConnected) == 1; }
  bool HasEnded() const { return Count(Event::Kind::kDisconnected) == 1; }
  SendResult SendTo(ConnectionId connection, Channel channel, const Bytes& message) {
    return transport->Send(connection, channel, message);
  }

  std::unique_ptr<EnetTransport> transport;
  std::vector<ReportedEvent> log;
};

inline Endpoint MakeServer(ListenOptions options = {}) {
  std::string error;
  Endpoint server{EnetTransport::Listen(options, error), {}};
  EXPECT_NE(server.transport, nullptr) << error;
  return server;
}

inline Endpoint MakeClient(std::uint16_t port, double timeout = 5) {
  std::string error;
  Endpoint client{EnetTransport::Connect("127.0.0.1", port, error, {timeout}), {}};
  EXPECT_NE(client.transport, nullptr) << error;
  return client;
}

// Runs `step` every millisecond until `isDone`, for five seconds at most.
inline bool RunUntil(const std::function<void()>& step, const std::function<bool()>& isDone) {
  for (const double end = Now() + 5; Now() < end;) {
    step();
    if (isDone()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

inline void RunFor(double seconds, const std::function<void()>& step) {
  for (const double end = Now() + seconds; Now() < end;) {
    step();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// Passes datagrams between one client and the server, and lets the test read, delay and inject them.
struct Forwarder {
  explicit Forwarder(std::uint16_t port) : serverPort(port) {}
  void Step() {
    Bytes bytes;
    std::uint16_t from = 0;
    while (toClient.Receive(bytes, from)) {
      clientPort = from;
      toServer.SendTo(serverPort, bytes);
      seen.push_back(bytes);
    }
    while (toServer.Receive(bytes, from)) held.push_back({Now() + holdBack, bytes});
    while (!held.empty() && held.front().due <= Now()) {
      toClient.SendTo(clientPort, held.front().bytes);
      held.pop_front();
    }
  }
  void Inject(const Bytes& bytes) { toServer.SendTo(serverPort, bytes); }

  std::uint16_t serverPort;
  std::uint16_t clientPort = 0;
  UdpSocket toClient;
  UdpSocket toServer;
  std::vector<Bytes> seen;  // from the client
  double holdBack = 0;      // seconds by which datagrams to the client are delayed
  struct Held {
    double due;
    Bytes bytes;
  };
  std::deque<Held> held;
};

// A connected server and client.
struct ConnectedPair {
  explicit ConnectedPair(ListenOptions options = {})
      : server(MakeServer(options)), client(MakeClient(server.transport->ReadPort())) {
    EXPECT_TRUE(Run([this] { return server.IsConnected() && client.IsConnected(); }));
  }
  bool Run(const std::function<bool()>& isDone) {
    return RunUntil([this] { Step(); }, isDone);
  }
  void Step() {
    client.Poll();
    server.Poll();
  }
  ConnectionId Id() const { return server.log.at(0).connection; }

  Endpoint server;
  Endpoint client;
};

// A server and a client that are connected through a forwarder.
struct ForwardedPair {
  explicit ForwardedPair(double holdBack = 0)
      : server(MakeServer()), forwarder(server.transport->ReadPort()), client(MakeClient(forwarder.toClient.Port())) {
    forwarder.holdBack = holdBack;
    EXPECT_TRUE(Run([this] { return server.IsConnected() && client.IsConnected(); }));
    RunFor(0.1, [this] { Step(); });  // the acknowledgements that follow the handshake
  }
  bool Run(const std::function<bool()>& isDone) {
    return RunUntil([this] { Step(); }, isDone);
  }
  void Step() {
    client.Poll();
    forwarder.Step();
    server.Poll();
    forwarder.Step();
  }
  // Number of the `count` datagrams just injected that the server rejected, once it has had time to.
  std::uint64_t RejectedOf(std::size_t count) {
    const std::uint64_t target = rejectedBefore + count;
    EXPECT_TRUE(Run([&] { return server.transport->ReadStatistics().datagramsRejected >= target; }));
    const std::uint64_t rejected = server.transport->ReadStatistics().datagramsRejected - rejectedBefore;
    rejectedBefore += rejected;
    return rejected;
  }
  void ExpectEcho(std::uint8_t value) {
    EXPECT_EQ(client.SendTo(1, Channel::kControl, {value}), SendResult::kQueued);
    EXPECT_TRUE(Run([&] { return server.log.back().bytes == Bytes{value}; }));
    EXPECT_FALSE(server.HasEnded());
    EXPECT_FALSE(client.HasEnded());
  }

  Endpoint server;
  Forwarder forwarder;
  Endpoint client;
  std::uint64_t rejectedBefore = 0;
};

}  // namespace wobble::test
