// ENet over the loopback interface, against full servers, strangers and forged datagrams.
//
// Where an attacker must sit at a client's address, the client talks through a forwarder that the test controls: the
// forwarder sees genuine datagrams, and what it injects comes from the address at which the server sees the client.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
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
using test::RunFor;
using test::RunUntil;
using test::UdpSocket;

TEST(EnetTransportAttackTest, FullServerTurnsAwayAtOnceAndItsUserNeverKnows) {
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

TEST(EnetTransportAttackTest, AddressMayHaveNoMoreThanItsShare) {
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
  EXPECT_TRUE(RunUntil(step, [&] { return countEnded() == 2 && server.Count(Event::Kind::kConnected) == 3; }));
  RunFor(0.1, step);
  EXPECT_EQ(server.Count(Event::Kind::kConnected), 3u);
}

TEST(EnetTransportAttackTest, TwoServersInOneProcessKeepTheirOwnCounts) {
  Endpoint first = MakeServer();
  Endpoint second = MakeServer();
  UdpSocket attacker;
  attacker.SendTo(second.transport->ReadPort(), Bytes(40, 1));
  EXPECT_TRUE(RunUntil(
      [&] {
        first.Poll();
        second.Poll();
      },
      [&] { return second.transport->ReadStatistics().datagramsRejected == 1; }));
  EXPECT_EQ(first.transport->ReadStatistics().datagramsRejected, 0u);
}

// From a stranger's port: every length from 0 to 1,500 and some beyond the buffer. None begins like a request, which
// would be answered.
TEST(EnetTransportAttackTest, RandomDatagramsAreCountedAndNobodyNotices) {
  ConnectedPair pair;
  UdpSocket stranger;
  std::mt19937 random(20240501);
  std::uint64_t count = 0;
  const auto send = [&](std::size_t size) {
    Bytes bytes(size);
    for (std::uint8_t& byte : bytes) byte = std::uint8_t(random());
    if (size >= 2) bytes[0] = count % 3 == 0 ? 0x10 : count % 3 == 1 ? 0x03 : std::uint8_t(bytes[0] | 0x20);
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
  EXPECT_EQ(pair.server.log.size(), 2u);  // the connection and that message
  EXPECT_EQ(pair.client.log.size(), 1u);
}

TEST(EnetTransportAttackTest, GenuineDatagramsDamagedOrSentAgainAreRejected) {
  ForwardedPair pair;
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, Bytes(60, 5)), SendResult::kQueued);
  EXPECT_EQ(pair.client.SendTo(1, Channel::kInput, Bytes(60, 6)), SendResult::kQueued);
  ASSERT_TRUE(pair.Run([&] { return pair.server.Count(Event::Kind::kMessage) == 2; }));
  RunFor(0.05, [&] { pair.Step(); });
  pair.rejectedBefore = pair.server.transport->ReadStatistics().datagramsRejected;

  const std::vector<Bytes> seen = pair.forwarder.seen;
  std::size_t count = 0;
  for (const Bytes& datagram : seen) {
    if (datagram[0] != static_cast<std::uint8_t>(vestibule::SealedKind::kData)) continue;
    pair.forwarder.Inject(datagram);
    ++count;
    for (std::size_t at = 0; at < datagram.size(); ++at) {
      for (const unsigned mask : {0x04u, 0x10u, 0x80u, 0xFFu}) {
        Bytes damaged = datagram;
        damaged[at] = std::uint8_t(damaged[at] ^ mask);
        pair.forwarder.Inject(damaged);
        if (++count % 64 == 0) pair.Step();
      }
      pair.forwarder.Inject(Bytes(datagram.begin(), datagram.begin() + std::ptrdiff_t(at)));
      ++count;
    }
  }
  ASSERT_GT(count, 500u);
  EXPECT_EQ(pair.RejectedOf(count), count);
  EXPECT_EQ(pair.server.Count(Event::Kind::kMessage), 2u);
  pair.ExpectEcho(77);
}

// ENet's own datagrams, from the client's own address: on the wire there are none.
TEST(EnetTransportAttackTest, BareDatagramsOfEnetAreRejected) {
  ForwardedPair pair;
  const Bytes disconnect{0, 0, 0, 0, 0, 0, 0x44, 0xFF, 0, 0, 0, 0, 0, 0};
  Bytes connect{0x8F, 0xFF, 0, 1, 0, 0, 0, 0, 0x82, 0xFF, 0, 1};
  connect.resize(56);
  for (int i = 0; i < 64; ++i) pair.forwarder.Inject(i % 2 == 0 ? disconnect : connect);
  EXPECT_EQ(pair.RejectedOf(64), 64u);
  pair.ExpectEcho(77);
}

TEST(EnetTransportAttackTest, NothingOnTheWireShowsWhatIsSaid) {
  ForwardedPair pair;
  const Bytes secret(40, 'S');
  EXPECT_EQ(pair.client.SendTo(1, Channel::kControl, secret), SendResult::kQueued);
  EXPECT_EQ(pair.client.SendTo(1, Channel::kInput, secret), SendResult::kQueued);
  ASSERT_TRUE(pair.Run([&] { return pair.server.Count(Event::Kind::kMessage) == 2; }));
  for (const Bytes& datagram : pair.forwarder.seen) {
    EXPECT_EQ(std::search(datagram.begin(), datagram.end(), secret.begin(), secret.begin() + 4), datagram.end());
  }
}

TEST(EnetTransportAttackTest, ClientTakesNothingFromStrangers) {
  ForwardedPair pair;
  const Bytes request = pair.forwarder.seen.at(0);
  for (int i = 0; i < 10; ++i) pair.forwarder.toClient.SendTo(pair.forwarder.clientPort, request);
  EXPECT_TRUE(pair.Run([&] { return pair.client.transport->ReadStatistics().datagramsRejected == 10; }));
  pair.ExpectEcho(5);
}

}  // namespace
}  // namespace wobble::transport
