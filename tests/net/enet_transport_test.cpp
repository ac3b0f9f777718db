// ENet over the loopback interface, with real sockets: delivery, order, limits, disconnection and statistics.
#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "protocol/transport/enet_transport.h"
#include "tests/net/enet_pairs.h"
#include "tests/support/udp_socket.h"

namespace wobble::transport {
namespace {

using test::Bytes;
using test::ConnectedPair;
using test::Endpoint;
using test::ForwardedPair;
using test::MakeClient;
using test::MakeServer;
using test::Now;
using test::ReportedEvent;
using test::RunFor;
using test::RunUntil;
using test::UdpSocket;

TEST(EnetTransportTest, MessagesArriveBothWaysInOrderOnControl) {
  ConnectedPair pair;
  EXPECT_EQ(pair.client.log[0].connection, EnetTransport::kClientConnection);
  constexpr std::size_t kCount = 300;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Bytes message(1 + i * 13, std::uint8_t(i));  // up to 3.9 kB: most are fragmented
    EXPECT_EQ(pair.server.SendTo(pair.Id(), Channel::kControl, message), SendResult::kQueued);
    EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, Bytes(1 + i * 3, std::uint8_t(i))), SendResult::kQueued);
    if (i % 50 == 49) RunFor(0.02, [&] { pair.Step(); });  // a client has a window
  }
  const auto hasAll = [](const Endpoint& end) { return end.Count(Event::Kind::kMessage) == kCount; };
  ASSERT_TRUE(pair.Run([&] { return hasAll(pair.server) && hasAll(pair.client); }));
  for (const Endpoint* end : {&pair.server, &pair.client}) {
    const std::size_t step = end == &pair.server ? 3 : 13;
    for (std::size_t i = 0; i < kCount; ++i) {
      ASSERT_EQ(end->log[1 + i].bytes, Bytes(1 + i * step, std::uint8_t(i)));
      ASSERT_EQ(end->log[1 + i].channel, Channel::kControl);
    }
  }
}

TEST(EnetTransportTest, LargestMessagesPassAndLargerAreRefused) {
  ConnectedPair pair;
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

TEST(EnetTransportTest, SnapshotsLeaveWithFlushOneDatagramEach) {
  ForwardedPair pair;
  const std::uint64_t before = pair.server.transport->ReadStatistics().bytesOut;
  EXPECT_EQ(pair.server.SendTo(1, Channel::kSnapshot, Bytes(protocol::kMaxPacketBytes, 3)), SendResult::kQueued);
  pair.server.transport->Flush();
  const std::uint64_t sent = pair.server.transport->ReadStatistics().bytesOut - before;
  EXPECT_GE(sent, protocol::kMaxPacketBytes + 14);
  EXPECT_LE(sent, protocol::kMaxPacketBytes + 64);  // and possibly an acknowledgement
  Bytes datagram;
  std::uint16_t from = 0;
  ASSERT_TRUE(pair.forwarder.toServer.Receive(datagram, from));
  EXPECT_GE(datagram.size(), protocol::kMaxPacketBytes);
  EXPECT_LE(datagram.size(), 1232u);  // IPv6's smallest MTU minus its headers
  EXPECT_FALSE(pair.forwarder.toServer.Receive(datagram, from));
}

TEST(EnetTransportTest, AMessageArrivesWhoseSenderClosesAndEndsAtOnce) {
  ConnectedPair pair;
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, {5}), SendResult::kQueued);
  pair.client.transport->Disconnect(1);
  pair.client.transport.reset();
  EXPECT_TRUE(RunUntil([&] { pair.server.Poll(); }, [&] { return pair.server.Count(Event::Kind::kMessage) == 1; }));
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
  EXPECT_EQ(error, "no address is known for \"nobody.invalid\"");
}

TEST(EnetTransportTest, NoServerEndsAfterTheTimeoutOfOurOwnClock) {
  const UdpSocket silent;  // holds a port without a server
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
  ConnectedPair pair;
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
  ConnectedPair pair;
  const double now = Now();
  pair.server.transport->Disconnect(pair.Id());
  pair.server.PollAt(now + 1);
  EXPECT_FALSE(pair.server.HasEnded());
  pair.server.PollAt(now + 5);  // the client is not polled meanwhile
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
  ConnectedPair pair;
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

// ENet's throttle would mistake the longer round trip for congestion and discard snapshots before they are sent.
TEST(EnetTransportTest, LongerRoundTripCostsNoSnapshots) {
  ForwardedPair pair(0.03);  // a delay above 0, so that ENet does not take the change for normal variation
  pair.forwarder.holdBack = 0.2;
  constexpr std::size_t kCount = 300;
  for (std::size_t i = 0; i < kCount; ++i) {
    EXPECT_EQ(pair.server.SendTo(1, Channel::kControl, {1}), SendResult::kQueued);  // what ENet measures
    EXPECT_EQ(pair.server.SendTo(1, Channel::kSnapshot, {2}), SendResult::kQueued);
    pair.Step();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const auto countSnapshots = [&] {
    return static_cast<std::size_t>(
        std::count_if(pair.client.log.begin(), pair.client.log.end(),
                      [](const ReportedEvent& seen) { return seen.channel == Channel::kSnapshot; }));
  };
  EXPECT_TRUE(pair.Run([&] { return countSnapshots() == kCount; })) << countSnapshots() << " of " << kCount;
}

// The server measures it from the handshake on, because it uses it to grant time. A client assumes half a second until
// its hello is answered.
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

TEST(EnetTransportTest, BytesAreCountedBothWays) {
  ConnectedPair pair;
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, Bytes(1000, 1)), SendResult::kQueued);
  ASSERT_TRUE(pair.Run([&] { return pair.server.Count(Event::Kind::kMessage) == 1; }));
  const auto in = pair.server.transport->ReadStatistics().bytesIn;
  const auto out = pair.client.transport->ReadStatistics().bytesOut;
  EXPECT_GE(in, 1000u);
  EXPECT_LT(in, 1600u);
  EXPECT_GE(out, in);
  EXPECT_LT(out, in + 600);
}

}  // namespace
}  // namespace wobble::transport
