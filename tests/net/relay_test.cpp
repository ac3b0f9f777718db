// The relay with real sockets on the loopback interface: what it passes, which clients it forgets, and what it
// survives.
#include "protocol/transport/relay.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "protocol/transport/enet_transport.h"
#include "tests/support/udp_socket.h"

namespace wobble::transport {
namespace {

using test::Bytes;
using test::Now;
using Socket = test::UdpSocket;

std::unique_ptr<Relay> OpenRelay(std::uint16_t server, RelayOptions options = {}) {
  options.host = "127.0.0.1";
  options.serverHost = "127.0.0.1";
  options.serverPort = server;
  std::string error;
  auto relay = Relay::Open(options, error);
  EXPECT_NE(relay, nullptr) << error;
  return relay;
}

// Runs the relay at the time `now` until it has nothing to do.
void Settle(Relay& relay, double now) {
  for (int turn = 0; turn < 1000 && !relay.Run(now); ++turn) {
  }
}

// A server that returns every datagram and stores the sender's port.
struct Echo {
  void Poll() {
    Bytes bytes;
    std::uint16_t from = 0;
    while (socket.Receive(bytes, from)) {
      sources.insert(from);
      ++received;
      socket.SendTo(from, bytes);
    }
  }
  Socket socket;
  std::set<std::uint16_t> sources;
  int received = 0;
};

TEST(Relay, PassesDatagramsOfAnySizeBothWaysEachClientFromAnAddressOfItsOwn) {
  Echo echo;
  const auto relay = OpenRelay(echo.socket.Port());
  const Socket first, second;
  for (const std::size_t size : {1u, 1200u, 60000u, 0u}) {
    for (const Socket* client : {&first, &second}) {
      const Bytes sent(size, static_cast<std::uint8_t>(client->Port()));
      client->SendTo(relay->ReadPort(), sent);
      Settle(*relay, 1);
      echo.Poll();
      Settle(*relay, 1);
      Bytes received;
      std::uint16_t from = 0;
      ASSERT_TRUE(client->Receive(received, from)) << size;
      EXPECT_EQ(received, sent);
      EXPECT_EQ(from, relay->ReadPort());
      EXPECT_FALSE(client->Receive(received, from));
    }
  }
  EXPECT_EQ(echo.sources.size(), 2u);
  EXPECT_EQ(relay->ReadCounts().up.received, 8u);
  EXPECT_EQ(relay->ReadCounts().down.passed, 8u);
  EXPECT_EQ(relay->ReadCounts().up.bytesOut, 2 * 61201u);
}

TEST(Relay, EachDirectionHasItsOwnConditionsOnTheTimeItIsGiven) {
  Echo echo;
  RelayOptions options;
  options.link.up.delay = 0.25;
  options.link.down.delay = 1;
  const auto relay = OpenRelay(echo.socket.Port(), options);
  const Socket client;
  client.SendTo(relay->ReadPort(), {1, 2, 3});
  Settle(*relay, 100);
  EXPECT_NEAR(relay->NextDue(), 100.25, 1e-9);
  Settle(*relay, 100.2);
  echo.Poll();
  EXPECT_EQ(echo.received, 0);
  Settle(*relay, 100.26);
  echo.Poll();
  EXPECT_EQ(echo.received, 1);
  Settle(*relay, 100.3);
  Bytes bytes;
  std::uint16_t from = 0;
  EXPECT_NEAR(relay->NextDue(), 101.3, 1e-9);
  EXPECT_FALSE(client.Receive(bytes, from));
  Settle(*relay, 101.31);
  EXPECT_TRUE(client.Receive(bytes, from));
  // 10 ms late each time, as the test calls it
  EXPECT_NEAR(relay->ReadCounts().lateness.FindPercentileMs(0.99), 10, 0.2);
}

// Which of 1,000 datagrams pass, for this seed.
std::vector<bool> SendThrough(std::uint64_t seed, bool withNoise, RelayCounts* counts = nullptr) {
  Echo echo;
  RelayOptions options;
  options.seed = seed;
  options.link.up = {.loss = 0.2, .duplicate = 0.1, .reorder = 0.05, .reorderDelay = 0.001};
  const auto relay = OpenRelay(echo.socket.Port(), options);
  const Socket client, noise;
  std::vector<bool> arrived(1000);
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    client.SendTo(relay->ReadPort(), {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)});
    Settle(*relay, static_cast<double>(i));
    if (withNoise) noise.SendTo(relay->ReadPort(), Bytes(1 + i % 100));
    Settle(*relay, static_cast<double>(i) + 0.5);
    Bytes bytes;
    std::uint16_t from = 0;
    while (echo.socket.Receive(bytes, from)) arrived[i] = arrived[i] || bytes.size() == 2;
  }
  if (counts != nullptr) *counts = relay->ReadCounts();
  return arrived;
}

TEST(Relay, LossesFollowFromSeedAndNumberIndependentlyOfOtherTraffic) {
  RelayCounts counts;
  const auto first = SendThrough(7, false, &counts);
  EXPECT_EQ(first, SendThrough(7, false));
  EXPECT_NE(first, SendThrough(8, false));
  EXPECT_EQ(counts.up.received, 1000u);
  EXPECT_NEAR(static_cast<double>(counts.up.lost), 200, 64);       // five standard deviations
  EXPECT_NEAR(static_cast<double>(counts.up.duplicated), 80, 43);  // five standard deviations, of the 800 that pass
  EXPECT_NEAR(static_cast<double>(counts.up.reordered), 40, 31);
  EXPECT_EQ(counts.up.passed, counts.up.received - counts.up.lost + counts.up.duplicated);

  // Noise datagrams have odd sizes, unless they are two bytes long.
  const auto disturbed = SendThrough(7, true);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_TRUE(disturbed[i] == first[i] || 1 + i % 100 == 2) << i;
  }
}

TEST(Relay, ForgetsSilentClientsAndAcceptsThemAgain) {
  Echo echo;
  RelayOptions options;
  options.idleTimeout = 60;
  options.link.down.delay = 5;
  const auto relay = OpenRelay(echo.socket.Port(), options);
  const Socket quiet, busy;
  quiet.SendTo(relay->ReadPort(), {1});
  Settle(*relay, 0);
  echo.Poll();
  for (double now = 1; now <= 58; ++now) {
    busy.SendTo(relay->ReadPort(), {2});
    Settle(*relay, now);
  }
  EXPECT_EQ(relay->ReadCounts().clients, 2u);
  echo.Poll();  // with a datagram on its way in both directions
  Settle(*relay, 59);
  for (double now = 60; now <= 70; ++now) Settle(*relay, now);
  EXPECT_EQ(relay->ReadCounts().clients, 1u);
  quiet.SendTo(relay->ReadPort(), {3});
  Settle(*relay, 71);
  EXPECT_EQ(relay->ReadCounts().clients, 2u);
  EXPECT_EQ(relay->ReadCounts().clientsEver, 3u);
  echo.Poll();
  Settle(*relay, 71);
  Settle(*relay, 77);
  Bytes bytes;
  std::uint16_t from = 0;
  bool found = false;
  while (quiet.Receive(bytes, from)) found |= bytes == Bytes{3};
  EXPECT_TRUE(found);
}

TEST(Relay, TakesNoMoreClientsThanItMay) {
  Echo echo;
  RelayOptions options;
  options.maxClients = 2;
  const auto relay = OpenRelay(echo.socket.Port(), options);
  const Socket first, second, third;
  for (const Socket* client : {&first, &second, &third, &first}) client->SendTo(relay->ReadPort(), {1});
  Settle(*relay, 0);
  echo.Poll();
  EXPECT_EQ(echo.received, 3);
  EXPECT_EQ(echo.sources.size(), 2u);
  EXPECT_EQ(relay->ReadCounts().clientsRefused, 1u);
}

TEST(Relay, SurvivesAServerThatIsNotThereAndServesOneThatComes) {
  std::uint16_t port = 0;
  {
    const Socket gone;
    port = gone.Port();
  }
  const auto relay = OpenRelay(port);
  const Socket client;
  for (int i = 0; i < 50; ++i) {
    client.SendTo(relay->ReadPort(), {1});
    Settle(*relay, i);
  }
  EXPECT_EQ(relay->ReadCounts().up.received, 50u);
  EXPECT_EQ(relay->ReadCounts().down.received, 0u);
}

TEST(Relay, AThousandAddressesAndGarbageBothWays) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const rlimit before = limit;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
  ASSERT_GT(limit.rlim_cur, 2100u) << "two sockets an address are needed";

  Echo echo;
  const auto relay = OpenRelay(echo.socket.Port());
  std::vector<std::unique_ptr<Socket>> clients;
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) clients.push_back(std::make_unique<Socket>());
  for (int round = 0; round < 3; ++round) {
    for (const auto& client : clients) {
      Bytes garbage(1 + random() % 1400);
      for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random());
      client->SendTo(relay->ReadPort(), garbage);
      Settle(*relay, round);
      echo.Poll();
      Settle(*relay, round);
      Bytes back;
      std::uint16_t from = 0;
      ASSERT_TRUE(client->Receive(back, from));
      ASSERT_EQ(back, garbage);
    }
  }
  EXPECT_EQ(echo.sources.size(), 1000u);
  EXPECT_EQ(relay->ReadCounts().clients, 1000u);
  // A stranger's datagrams to an upstream socket are dropped: the socket is connected to the server.
  const Socket stranger;
  stranger.SendTo(*echo.sources.begin(), {1, 2, 3});
  Settle(*relay, 9);
  EXPECT_EQ(relay->ReadCounts().down.received, 3000u);
  setrlimit(RLIMIT_NOFILE, &before);
}

TEST(Relay, HoldsNoMoreThanItsMemory) {
  Echo echo;
  RelayOptions options;
  options.link.up.delay = 10;
  const auto relay = OpenRelay(echo.socket.Port(), options);
  const Socket client;
  const Bytes large(60000);
  for (int i = 0; i < 2000; ++i) {  // 120 MB
    client.SendTo(relay->ReadPort(), large);
    Settle(*relay, 1);
  }
  const RelayDirectionCounts counts = relay->ReadCounts().up;
  EXPECT_EQ(counts.received, 2000u);
  EXPECT_GT(counts.unsent, 0u);
  EXPECT_LT((counts.received - counts.unsent) * large.size(), 100u << 20);
}

TEST(Relay, SaysWhyItCannotBeOpened) {
  const Socket taken;
  std::string error;
  RelayOptions options;
  options.port = taken.Port();
  options.host = "127.0.0.1";
  options.serverHost = "127.0.0.1";
  options.serverPort = 1;
  EXPECT_EQ(Relay::Open(options, error), nullptr);
  EXPECT_EQ(error, "port " + std::to_string(taken.Port()) + " (UDP) is in use");
  options.port = 0;
  options.serverHost = "no.such.host.invalid";
  EXPECT_EQ(Relay::Open(options, error), nullptr);
  EXPECT_EQ(error, "no IPv4 address is known for \"no.such.host.invalid\"");
}

TEST(Relay, WaitsToAFractionOfAMillisecondAndWakesForADatagram) {
  Echo echo;
  const auto relay = OpenRelay(echo.socket.Port());
  double shortest = 1;
  for (int i = 0; i < 20; ++i) {
    const double begin = Now();
    relay->Wait(0.0002);
    shortest = std::min(shortest, Now() - begin);
  }
  EXPECT_GE(shortest, 0.0002);
  EXPECT_LT(shortest, 0.001);
  const Socket client;
  client.SendTo(relay->ReadPort(), {1});
  const double begin = Now();
  relay->Wait(30);
  EXPECT_LT(Now() - begin, 5);
}

// Two ENet endpoints with the relay between them, on the real clock.
struct EnetPair {
  EnetPair(const LinkSpec& link, std::uint64_t seed) {
    std::string error;
    server = EnetTransport::Listen({}, error);
    EXPECT_NE(server, nullptr) << error;
    RelayOptions options;
    options.link = link;
    options.seed = seed;
    relay = OpenRelay(server->ReadPort(), options);
    client = EnetTransport::Connect("127.0.0.1", relay->ReadPort(), error);
    EXPECT_NE(client, nullptr) << error;
  }

  void Step() {
    relay->Run(Now());
    server->Poll(Now(), [this](const Event& event) { Note(event, connection, isServerUp, atServer); });
    client->Poll(Now(), [this](const Event& event) {
      ConnectionId ignored = 0;
      Note(event, ignored, isClientUp, atClient);
    });
    server->Flush();
    client->Flush();
    relay->Run(Now());
    relay->Wait(0.001);
  }
  bool RunUntil(double seconds, const std::function<bool()>& isDone) {
    for (const double end = Now() + seconds; Now() < end;) {
      Step();
      if (isDone()) return true;
    }
    return false;
  }

  static void Note(const Event& event, ConnectionId& id, bool& isUp, std::vector<Bytes>& messages) {
    if (event.kind == Event::Kind::kConnected) id = event.connection;
    if (event.kind != Event::Kind::kMessage) isUp = event.kind == Event::Kind::kConnected;
    if (event.kind == Event::Kind::kMessage && event.channel == Channel::kControl) {
      messages.emplace_back(event.bytes.begin(), event.bytes.end());
    }
  }

  std::unique_ptr<EnetTransport> server;
  std::unique_ptr<Relay> relay;
  std::unique_ptr<EnetTransport> client;
  ConnectionId connection = 0;
  bool isServerUp = false;
  bool isClientUp = false;
  std::vector<Bytes> atServer;
  std::vector<Bytes> atClient;
};

// With half of all packets lost each way, a try is delivered and acknowledged one time in four. If the wait doubled
// from some milliseconds on, the tenth try would come after seconds; with a bounded wait there are four tries a second.
TEST(EnetOverRelay, ControlGetsThroughHeavyLossWithoutWaitsThatDouble) {
  EnetPair pair({{.loss = 0.5, .delay = 0.01}, {.loss = 0.5, .delay = 0.01}}, 3);
  ASSERT_TRUE(pair.RunUntil(8, [&] { return pair.isClientUp && pair.isServerUp; }));
  double longest = 0;
  for (std::size_t i = 1; i <= 12; ++i) {
    const double begin = Now();
    ASSERT_EQ(pair.client->Send(1, Channel::kControl, Bytes(50, static_cast<std::uint8_t>(i))), SendResult::kQueued);
    ASSERT_TRUE(pair.RunUntil(8, [&] { return pair.atServer.size() == i; })) << i;
    longest = std::max(longest, Now() - begin);
  }
  EXPECT_LT(longest, 3.5);  // that one of twelve takes more than 13 tries happens once in 700 seeds; this seed is fixed
  EXPECT_TRUE(pair.isClientUp && pair.isServerUp);
  EXPECT_GT(pair.client->ReadRoundTrip(1), 0.019);
  EXPECT_LT(pair.client->ReadRoundTrip(1), 0.5);
}

// Snapshots, inputs and some reliable messages, through a black-out of one second: afterwards no more bytes per second
// than before.
TEST(EnetOverRelay, ABlackoutIsFollowedByNoStorm) {
  const LinkConditions way{.delay = 0.02, .blackout = {1, 3}};
  EnetPair pair({way, way}, 1);
  const double begin = Now();
  ASSERT_TRUE(pair.RunUntil(1.5, [&] { return pair.isClientUp && pair.isServerUp; }));
  std::array<std::vector<double>, 2> quarters;  // bytes sent per 250 ms: up, down
  double nextSnapshot = Now(), nextEvent = Now(), nextQuarter = Now() + 0.25;
  std::array<std::uint64_t, 2> last{};
  double quartersFrom = Now() - begin;
  while (Now() < begin + 4.5) {
    if (Now() >= nextSnapshot) {
      nextSnapshot += 1.0 / 30;
      (void)pair.server->Send(pair.connection, Channel::kSnapshot, Bytes(1000));
      for (int i = 0; i < 2; ++i) (void)pair.client->Send(1, Channel::kInput, Bytes(80));
    }
    if (Now() >= nextEvent) {
      nextEvent += 0.1;
      (void)pair.server->Send(pair.connection, Channel::kControl, Bytes(60));
    }
    pair.Step();
    if (Now() < nextQuarter) continue;
    nextQuarter += 0.25;
    const RelayCounts& counts = pair.relay->ReadCounts();
    quarters[0].push_back(static_cast<double>(counts.up.bytesIn - std::exchange(last[0], counts.up.bytesIn)));
    quarters[1].push_back(static_cast<double>(counts.down.bytesIn - std::exchange(last[1], counts.down.bytesIn)));
  }
  EXPECT_TRUE(pair.isClientUp && pair.isServerUp);
  EXPECT_GT(pair.relay->ReadCounts().down.blackedOut, 20u);
  for (const std::vector<double>& way_ : quarters) {
    double steady = 0, most = 0;
    int count = 0;
    for (std::size_t i = 1; i < way_.size(); ++i) {  // the first quarter contains the handshake
      const double at = quartersFrom + 0.25 * static_cast<double>(i + 1);
      if (at < 2) {
        steady += way_[i];
        ++count;
      }
      if (at > 3) most = std::max(most, way_[i]);
    }
    ASSERT_GT(count, 3);
    EXPECT_LE(most, 1.5 * steady / count);
  }
}

}  // namespace
}  // namespace wobble::transport
