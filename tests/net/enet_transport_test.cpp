// ENet over the loopback interface, with real sockets: what it must do for us, and what it must not let others do to
// us.
//
// Where the attacker has to sit at a client's address, the client talks through a forwarder that the test holds in its
// hand: it sees genuine datagrams, and what it adds comes from where the client seems to be.
#include "protocol/transport/enet_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>
#include <functional>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "tests/support/udp_socket.h"

namespace wobble::transport {
namespace {

using test::Bytes;
using test::Now;
using Socket = test::UdpSocket;

struct Seen {
  Event::Kind kind;
  ConnectionId connection;
  Channel channel;
  Bytes bytes;
};

// A transport and all that it has said.
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
        std::count_if(log.begin(), log.end(), [&](const Seen& seen) { return seen.kind == kind; }));
  }
  bool IsConnected() const { return Count(Event::Kind::kConnected) == 1; }
  bool HasEnded() const { return Count(Event::Kind::kDisconnected) == 1; }
  SendResult SendTo(ConnectionId connection, Channel channel, const Bytes& message) {
    return transport->Send(connection, channel, message);
  }

  std::unique_ptr<EnetTransport> transport;
  std::vector<Seen> log;
};

Endpoint MakeServer(ListenOptions options = {}) {
  std::string error;
  Endpoint server{EnetTransport::Listen(options, error), {}};
  EXPECT_NE(server.transport, nullptr) << error;
  return server;
}

Endpoint MakeClient(std::uint16_t port, double timeout = 5) {
  std::string error;
  Endpoint client{EnetTransport::Connect("127.0.0.1", port, error, {timeout}), {}};
  EXPECT_NE(client.transport, nullptr) << error;
  return client;
}

// Runs `step` every millisecond until `isDone`, for five seconds at most.
bool RunUntil(const std::function<void()>& step, const std::function<bool()>& isDone) {
  for (const double end = Now() + 5; Now() < end;) {
    step();
    if (isDone()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

void RunFor(double seconds, const std::function<void()>& step) {
  for (const double end = Now() + seconds; Now() < end;) {
    step();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// Stands between one client and the server.
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
  Socket toClient;
  Socket toServer;
  std::vector<Bytes> seen;  // from the client
  double holdBack = 0;      // of what goes to the client, seconds
  struct Held {
    double due;
    Bytes bytes;
  };
  std::deque<Held> held;
};

// A server and a client, connected.
struct Pair {
  explicit Pair(ListenOptions options = {})
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

// Likewise, through a forwarder.
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
  // What the server has counted of `count` datagrams just injected, once it has had time to.
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

// CRC-32 (IEEE 802.3), a bit at a time: reckoned apart from the library's.
std::uint32_t Crc32(const Bytes& bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

// ENet's DISCONNECT to the server's slot 0: head, CRC keyed with the connection's id, command (flagged unsequenced).
Bytes ForgeDisconnect(unsigned session, const std::array<std::uint8_t, 4>& key) {
  Bytes bytes = {std::uint8_t(session << 4), 0, key[0], key[1], key[2], key[3], 0x44, 0xFF, 0, 0, 0, 0, 0, 0};
  const std::uint32_t crc = Crc32(bytes);
  for (unsigned i = 0; i < 4; ++i) bytes[2 + i] = std::uint8_t(crc >> (24 - 8 * i));
  return bytes;
}

TEST(EnetTransportTest, MessagesArriveBothWaysInOrderOnControl) {
  Pair pair;
  EXPECT_EQ(pair.client.log[0].connection, EnetTransport::kClientConnection);
  constexpr std::size_t kCount = 300;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Bytes message(1 + i * 13, std::uint8_t(i));  // up to 3.9 kB: most are fragmented
    EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, message), SendResult::kQueued);
    EXPECT_EQ(pair.server.SendTo(pair.Id(), Channel::kControl, message), SendResult::kQueued);
  }
  const auto hasAll = [](const Endpoint& end) { return end.Count(Event::Kind::kMessage) == kCount; };
  ASSERT_TRUE(pair.Run([&] { return hasAll(pair.server) && hasAll(pair.client); }));
  for (const Endpoint* end : {&pair.server, &pair.client}) {
    for (std::size_t i = 0; i < kCount; ++i) {
      ASSERT_EQ(end->log[1 + i].bytes, Bytes(1 + i * 13, std::uint8_t(i)));
      ASSERT_EQ(end->log[1 + i].channel, Channel::kControl);
    }
  }
}

TEST(EnetTransportTest, LargestMessagesPassAndLargerAreRefused) {
  Pair pair;
  const auto sendDown = [&](Channel channel, std::size_t size) {
    return pair.server.SendTo(pair.Id(), channel, Bytes(size, 7));
  };
  const auto sendUp = [&](Channel channel, std::size_t size) { return pair.client.SendTo(1, channel, Bytes(size, 7)); };
  EXPECT_EQ(sendDown(Channel::kSnapshot, protocol::kMaxPacketBytes + 1), SendResult::kTooLarge);
  EXPECT_EQ(sendUp(Channel::kInput, protocol::kMaxPacketBytes + 1), SendResult::kTooLarge);
  EXPECT_EQ(sendDown(Channel::kControl, protocol::kMaxServerMessageBytes + 1), SendResult::kTooLarge);
  EXPECT_EQ(sendUp(Channel::kControl, protocol::kMaxClientMessageBytes + 1), SendResult::kTooLarge);
  EXPECT_EQ(pair.server.SendTo(99, Channel::kControl, {1}), SendResult::kUnknownConnection);

  EXPECT_EQ(sendDown(Channel::kSnapshot, protocol::kMaxPacketBytes), SendResult::kQueued);
  EXPECT_EQ(sendDown(Channel::kControl, protocol::kMaxServerMessageBytes), SendResult::kQueued);
  EXPECT_EQ(sendUp(Channel::kInput, protocol::kMaxPacketBytes), SendResult::kQueued);
  EXPECT_EQ(sendUp(Channel::kControl, protocol::kMaxClientMessageBytes), SendResult::kQueued);
  EXPECT_TRUE(pair.Run(
      [&] { return pair.server.Count(Event::Kind::kMessage) == 2 && pair.client.Count(Event::Kind::kMessage) == 2; }));
}

TEST(EnetTransportTest, MessageOverTheServersOwnLimitIsDroppedAndCounted) {
  Pair pair({.maxMessageBytes = 1000});
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, Bytes(1001, 1)), SendResult::kQueued);
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, Bytes(1000, 2)), SendResult::kQueued);
  ASSERT_TRUE(pair.Run([&] { return pair.server.Count(Event::Kind::kMessage) == 1; }));
  EXPECT_EQ(pair.server.log.back().bytes, Bytes(1000, 2));
  EXPECT_EQ(pair.server.transport->ReadStatistics().messagesRejected, 1u);
}

TEST(EnetTransportTest, SnapshotsLeaveWithFlushOneDatagramEach) {
  ForwardedPair pair;
  const std::uint64_t before = pair.server.transport->ReadStatistics().bytesOut;
  EXPECT_EQ(pair.server.SendTo(1, Channel::kSnapshot, Bytes(protocol::kMaxPacketBytes, 3)), SendResult::kQueued);
  pair.server.transport->Flush();
  const std::uint64_t sent = pair.server.transport->ReadStatistics().bytesOut - before;
  EXPECT_GE(sent, protocol::kMaxPacketBytes + 14);
  EXPECT_LE(sent, protocol::kMaxPacketBytes + 64);  // and perhaps an acknowledgement
  Bytes datagram;
  std::uint16_t from = 0;
  ASSERT_TRUE(pair.forwarder.toServer.Receive(datagram, from));
  EXPECT_GE(datagram.size(), protocol::kMaxPacketBytes);
  EXPECT_LE(datagram.size(), 1232u);  // IPv6's smallest MTU less its headers
  EXPECT_FALSE(pair.forwarder.toServer.Receive(datagram, from));
}

TEST(EnetTransportTest, PortInUseIsNamed) {
  const Endpoint first = MakeServer();
  std::string error;
  EXPECT_EQ(EnetTransport::Listen({.port = first.transport->ReadPort()}, error), nullptr);
  EXPECT_EQ(error, "port " + std::to_string(first.transport->ReadPort()) + " (UDP) is in use");
}

TEST(EnetTransportTest, UnknownHostIsNamed) {
  std::string error;
  EXPECT_EQ(EnetTransport::Connect("nobody.invalid", 7777, error), nullptr);
  EXPECT_EQ(error, "no IPv4 address is known for \"nobody.invalid\"");
}

TEST(EnetTransportTest, NoServerEndsAfterTheTimeoutOfOurOwnClock) {
  const Socket silent;  // holds a port where nobody answers
  Endpoint client = MakeClient(silent.Port());
  EXPECT_EQ(client.SendTo(1, Channel::kControl, {1}), SendResult::kFailed);
  for (double now = 1000; now < 1004.95; now += 0.1) client.PollAt(now);
  EXPECT_TRUE(client.log.empty());
  client.PollAt(1005.05);
  ASSERT_EQ(client.log.size(), 1u);
  EXPECT_TRUE(client.HasEnded());
  EXPECT_EQ(client.log[0].connection, EnetTransport::kClientConnection);
  EXPECT_EQ(client.SendTo(1, Channel::kControl, {1}), SendResult::kUnknownConnection);
  client.PollAt(2000);
  EXPECT_EQ(client.log.size(), 1u);
}

TEST(EnetTransportTest, DisconnectDeliversWhatWasSentBefore) {
  Pair pair;
  for (std::uint8_t i = 0; i < 50; ++i) {
    EXPECT_EQ(pair.server.SendTo(pair.Id(), Channel::kControl, Bytes(3000, i)), SendResult::kQueued);
  }
  pair.server.transport->Disconnect(pair.Id());
  EXPECT_EQ(pair.server.SendTo(pair.Id(), Channel::kControl, {1}), SendResult::kFailed);
  ASSERT_TRUE(pair.Run([&] { return pair.client.HasEnded() && pair.server.HasEnded(); }));
  EXPECT_EQ(pair.client.Count(Event::Kind::kMessage), 50u);
  EXPECT_EQ(pair.client.log.back().kind, Event::Kind::kDisconnected);
}

TEST(EnetTransportTest, DisconnectFromASilentPeerEndsAfterAWhile) {
  Pair pair;
  const double now = Now();
  pair.server.transport->Disconnect(pair.Id());
  pair.server.PollAt(now + 1);
  EXPECT_FALSE(pair.server.HasEnded());
  pair.server.PollAt(now + 5);  // the client has not been polled since
  EXPECT_TRUE(pair.server.HasEnded());
}

TEST(EnetTransportTest, ClientThatIsDestroyedIsHeardOfAndIdsAreNotUsedAgain) {
  Endpoint server = MakeServer({.maxConnections = 1});
  std::set<ConnectionId> ids;
  for (int round = 0; round < 3; ++round) {
    server.log.clear();
    Endpoint client = MakeClient(server.transport->ReadPort());
    const auto step = [&] {
      if (client.transport) client.Poll();
      server.Poll();
    };
    ASSERT_TRUE(RunUntil(step, [&] { return server.IsConnected(); }));
    ids.insert(server.log.at(0).connection);
    client.transport.reset();
    ASSERT_TRUE(RunUntil(step, [&] { return server.HasEnded(); }));
  }
  EXPECT_EQ(ids.size(), 3u);
}

TEST(EnetTransportTest, SinkMaySendAndDisconnect) {
  Pair pair;
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, {42}), SendResult::kQueued);
  int disconnected = 0;
  const auto step = [&] {
    pair.client.Poll();
    pair.server.transport->Poll(Now(), [&](const Event& event) {
      if (event.kind == Event::Kind::kDisconnected) ++disconnected;
      if (event.kind != Event::Kind::kMessage) return;
      EXPECT_EQ(pair.server.transport->Send(event.connection, Channel::kControl, event.bytes), SendResult::kQueued);
      pair.server.transport->Disconnect(event.connection);
    });
  };
  ASSERT_TRUE(RunUntil(step, [&] { return pair.client.HasEnded() && disconnected == 1; }));
  EXPECT_EQ(pair.client.log.at(1).bytes, Bytes{42});
}

TEST(EnetTransportTest, FullServerTurnsAwayAtOnceAndItsUserNeverKnows) {
  Endpoint server = MakeServer({.maxConnections = 2});
  std::vector<Endpoint> clients;
  for (int i = 0; i < 4; ++i) clients.push_back(MakeClient(server.transport->ReadPort(), 60));
  const auto step = [&] {
    server.Poll();
    for (Endpoint& client : clients) client.Poll();
  };
  const auto countEnded = [&] {
    return std::count_if(clients.begin(), clients.end(), [](const Endpoint& client) { return client.HasEnded(); });
  };
  EXPECT_TRUE(RunUntil(step, [&] { return countEnded() == 2; }));
  RunFor(0.2, step);
  EXPECT_EQ(countEnded(), 2);
  EXPECT_EQ(server.Count(Event::Kind::kConnected), 2u);
  EXPECT_EQ(server.Count(Event::Kind::kDisconnected), 0u);
}

TEST(EnetTransportTest, AddressMayHaveNoMoreThanItsShare) {
  Endpoint server = MakeServer({.maxConnections = 16, .maxPerAddress = 3});
  std::vector<Endpoint> clients;
  for (int i = 0; i < 5; ++i) clients.push_back(MakeClient(server.transport->ReadPort(), 60));
  const auto step = [&] {
    server.Poll();
    for (Endpoint& client : clients) client.Poll();
  };
  const auto countEnded = [&] {
    return std::count_if(clients.begin(), clients.end(), [](const Endpoint& client) { return client.HasEnded(); });
  };
  EXPECT_TRUE(RunUntil(step, [&] { return countEnded() == 2; }));
  EXPECT_EQ(server.Count(Event::Kind::kConnected), 3u);
}

TEST(EnetTransportTest, TwoServersInOneProcessKeepTheirOwnCounts) {
  Endpoint first = MakeServer();
  Endpoint second = MakeServer();
  Socket attacker;
  attacker.SendTo(second.transport->ReadPort(), Bytes(40, 1));
  EXPECT_TRUE(RunUntil(
      [&] {
        first.Poll();
        second.Poll();
      },
      [&] { return second.transport->ReadStatistics().datagramsRejected == 1; }));
  EXPECT_EQ(first.transport->ReadStatistics().datagramsRejected, 0u);
}

// From a stranger's port, every length from 0 to 1,500 and some beyond ENet's buffer. One random CRC in 2^32 is right.
TEST(EnetTransportTest, RandomDatagramsAreCountedAndNobodyNotices) {
  Pair pair;
  Socket stranger;
  std::mt19937 random(20240501);
  std::uint64_t count = 0;
  const auto send = [&](std::size_t size) {
    Bytes bytes(size);
    for (std::uint8_t& byte : bytes) byte = std::uint8_t(random());
    if (size >= 2 && count % 3 == 0) bytes[0] = std::uint8_t(bytes[0] & 0xB0), bytes[1] = 0;     // for slot 0
    if (size >= 2 && count % 3 == 1) bytes[0] = std::uint8_t(bytes[0] | 0x0F), bytes[1] = 0xFF;  // for no slot yet
    stranger.SendTo(pair.server.transport->ReadPort(), bytes);
    ++count;
    if (count % 64 == 0) pair.Step();
  };
  for (std::size_t size = 0; size <= 1500; ++size) send(size);
  for (int i = 0; i < 4000; ++i) send(random() % 64);
  for (int i = 0; i < 20; ++i) send(i % 2 == 0 ? 0 : 5000);
  EXPECT_TRUE(pair.Run([&] { return pair.server.transport->ReadStatistics().datagramsRejected >= count; }));
  EXPECT_EQ(pair.server.transport->ReadStatistics().datagramsRejected, count);

  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, {9}), SendResult::kQueued);
  EXPECT_TRUE(pair.Run([&] { return pair.server.Count(Event::Kind::kMessage) == 1; }));
  EXPECT_EQ(pair.server.log.size(), 2u);  // connected, and that message
  EXPECT_EQ(pair.client.log.size(), 1u);
}

TEST(EnetTransportTest, GenuineDatagramsDamagedOnTheWayAreRejected) {
  ForwardedPair pair;
  const std::size_t handshake = pair.forwarder.seen.size();
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, Bytes(60, 5)), SendResult::kQueued);
  EXPECT_EQ(pair.client.SendTo(1, Channel::kInput, Bytes(60, 6)), SendResult::kQueued);
  ASSERT_TRUE(pair.Run([&] { return pair.server.Count(Event::Kind::kMessage) == 2; }));
  RunFor(0.05, [&] { pair.Step(); });
  ASSERT_GT(pair.forwarder.seen.size(), handshake);
  pair.rejectedBefore = pair.server.transport->ReadStatistics().datagramsRejected;

  const std::vector<Bytes> genuine = pair.forwarder.seen;
  std::size_t count = 0;
  for (const Bytes& datagram : genuine) {
    for (std::size_t at = 0; at < datagram.size(); ++at) {
      for (const unsigned mask : {0x01u, 0x10u, 0x80u, 0xFFu}) {
        Bytes damaged = datagram;
        damaged[at] = std::uint8_t(damaged[at] ^ mask);
        pair.forwarder.Inject(damaged);
        if (++count % 64 == 0) pair.Step();
      }
      pair.forwarder.Inject(Bytes(datagram.begin(), datagram.begin() + std::ptrdiff_t(at)));
      ++count;
    }
  }
  ASSERT_GT(count, 1000u);
  EXPECT_EQ(pair.RejectedOf(count), count);
  EXPECT_EQ(pair.server.Count(Event::Kind::kMessage), 2u);
  pair.ExpectEcho(77);
}

// From the client's own address, well-formed but for the connection's random id. That it is well-formed shows at the
// end: with the id, which only who reads the CONNECT knows, the same datagram does end the connection.
TEST(EnetTransportTest, ForgedDisconnectDropsNobody) {
  ForwardedPair pair;
  std::mt19937 random(7);
  std::size_t count = 0;
  for (int i = 0; i < 1024; ++i, ++count) {
    const std::uint32_t guess = i < 8 ? 0 : static_cast<std::uint32_t>(random());
    std::array<std::uint8_t, 4> key;
    std::memcpy(key.data(), &guess, sizeof guess);
    pair.forwarder.Inject(ForgeDisconnect(unsigned(i) % 4, key));
    if (count % 64 == 0) pair.Step();
  }
  EXPECT_EQ(pair.RejectedOf(count), count);
  pair.ExpectEcho(77);

  const Bytes& connect = pair.forwarder.seen.at(0);
  ASSERT_EQ(connect.size(), 4u + 4u + 48u);  // head and time, CRC, CONNECT, whose last 8 bytes are the id and our data
  std::array<std::uint8_t, 4> key;
  std::copy_n(connect.end() - 8, 4, key.begin());
  for (unsigned session = 0; session < 4; ++session) pair.forwarder.Inject(ForgeDisconnect(session, key));
  EXPECT_TRUE(pair.Run([&] { return pair.server.HasEnded(); }));
}

// ENet's throttle would take the longer round trip for congestion and discard snapshots before they are sent.
TEST(EnetTransportTest, LongerRoundTripCostsNoSnapshots) {
  ForwardedPair pair(0.03);  // so that ENet does not take the change for the spread of what it has seen
  pair.forwarder.holdBack = 0.2;
  constexpr std::size_t kCount = 300;
  for (std::size_t i = 0; i < kCount; ++i) {
    EXPECT_EQ(pair.server.SendTo(1, Channel::kControl, {1}), SendResult::kQueued);  // what ENet measures
    EXPECT_EQ(pair.server.SendTo(1, Channel::kSnapshot, {2}), SendResult::kQueued);
    pair.Step();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const auto countSnapshots = [&] {
    return static_cast<std::size_t>(std::count_if(pair.client.log.begin(), pair.client.log.end(),
                                                  [](const Seen& seen) { return seen.channel == Channel::kSnapshot; }));
  };
  EXPECT_TRUE(pair.Run([&] { return countSnapshots() == kCount; })) << countSnapshots() << " of " << kCount;
}

// By a server from the handshake on: it grants time by it. A client guesses half a second until its hello is answered.
TEST(EnetTransportTest, RoundTripIsMeasured) {
  ForwardedPair near;
  EXPECT_GT(near.server.transport->ReadRoundTrip(1), 0);
  EXPECT_LT(near.server.transport->ReadRoundTrip(1), 0.1);
  EXPECT_EQ(near.server.transport->ReadRoundTrip(7), 0);
  ForwardedPair far(0.2);
  EXPECT_NEAR(far.server.transport->ReadRoundTrip(1), 0.2, 0.05);
  EXPECT_EQ(far.client.transport->ReadRoundTrip(1), 0.5);
  far.ExpectEcho(1);
  RunFor(0.3, [&] { far.Step(); });
  EXPECT_NEAR(far.client.transport->ReadRoundTrip(1), 0.2, 0.05);
}

TEST(EnetTransportTest, ClientTakesNothingFromStrangers) {
  ForwardedPair pair;
  const Bytes connect = pair.forwarder.seen.at(0);  // a genuine CONNECT, which a client must not accept
  for (int i = 0; i < 10; ++i) pair.forwarder.toClient.SendTo(pair.forwarder.clientPort, connect);
  EXPECT_TRUE(pair.Run([&] { return pair.client.transport->ReadStatistics().datagramsRejected == 10; }));
  pair.ExpectEcho(5);
}

TEST(EnetTransportTest, BytesAreCountedBothWays) {
  Pair pair;
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, Bytes(4000, 1)), SendResult::kQueued);
  ASSERT_TRUE(pair.Run([&] { return pair.server.Count(Event::Kind::kMessage) == 1; }));
  const auto in = pair.server.transport->ReadStatistics().bytesIn;
  const auto out = pair.client.transport->ReadStatistics().bytesOut;
  EXPECT_GE(in, 4000u);
  EXPECT_LT(in, 4600u);
  EXPECT_GE(out, in);
  EXPECT_LT(out, in + 600);
}

}  // namespace
}  // namespace wobble::transport
