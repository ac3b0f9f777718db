// ENet over the loopback interface, against full servers, strangers and forged datagrams.
//
// Where an attacker must sit at a client's address, the client talks through a forwarder that the test controls: the
// forwarder sees genuine datagrams, and what it injects comes from the address at which the server sees the client.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
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

// CRC-32 (IEEE 802.3), bit by bit: computed independently of the library.
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
  EXPECT_TRUE(RunUntil(step, [&] { return countEnded() == 2; }));
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

// From a stranger's port: every length from 0 to 1,500 and some beyond ENet's buffer. One random CRC in 2^32 is right.
TEST(EnetTransportAttackTest, RandomDatagramsAreCountedAndNobodyNotices) {
  ConnectedPair pair;
  UdpSocket stranger;
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
  EXPECT_EQ(pair.server.log.size(), 2u);  // the connection and that message
  EXPECT_EQ(pair.client.log.size(), 1u);
}

TEST(EnetTransportAttackTest, GenuineDatagramsDamagedOnTheWayAreRejected) {
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

// From the client's own address, well-formed except for the connection's random id. The end of the test shows that it
// is well-formed: with the id, which is known only from the CONNECT, the same datagram does end the connection.
TEST(EnetTransportAttackTest, ForgedDisconnectDropsNobody) {
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

TEST(EnetTransportAttackTest, ClientTakesNothingFromStrangers) {
  ForwardedPair pair;
  const Bytes connect = pair.forwarder.seen.at(0);  // a genuine CONNECT, which a client must not accept
  for (int i = 0; i < 10; ++i) pair.forwarder.toClient.SendTo(pair.forwarder.clientPort, connect);
  EXPECT_TRUE(pair.Run([&] { return pair.client.transport->ReadStatistics().datagramsRejected == 10; }));
  pair.ExpectEcho(5);
}

}  // namespace
}  // namespace wobble::transport
