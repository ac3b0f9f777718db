// What the vestibule costs an honest crowd, against plain ENet with checksums on the same load: 64 clients, each of
// which sends 60 datagrams of 100 bytes a second and gets 90 of 1,150 bytes; and how long a datagram is under way.
//
// Processor time is the threads' own (/proc/self/task), so the clients' does not count. By make nightly: the figures
// are a quiet machine's.
#include <enet/enet.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "tests/attack/victim.h"

namespace wobble::attack {
namespace {

using transport::Channel;
using transport::ConnectionId;
using transport::EnetTransport;
using transport::Event;

constexpr std::size_t kClients = 64;
constexpr double kTick = 1.0 / 60;
constexpr double kSpan = 4;  // s, of one measurement
constexpr int kRepeats = 6;  // the machine's other work only adds
const Bytes kInput(100, 1), kSnapshot(1150, 2);

bool IsNightly() {
  const char* words = std::getenv("WOBBLE_ATTACK_SECONDS");
  return words != nullptr && std::atof(words) >= 15;
}

// Threads of this process.
std::set<std::string> ListThreads() {
  std::set<std::string> threads;
  for (const auto& each : std::filesystem::directory_iterator("/proc/self/task"))
    threads.insert(each.path().filename().string());
  return threads;
}

// Seconds of processor time of a thread so far.
double ReadThread(const std::string& thread) {
  double nanoseconds = 0;
  std::ifstream("/proc/self/task/" + thread + "/schedstat") >> nanoseconds;
  return 1e-9 * nanoseconds;
}

// An end of the load: takes in what has come, and sends as often as is due.
struct End {
  std::function<void()> poll;
  std::function<void(std::size_t count)> send;  // so many messages to each of the far ends
};

// One call of it a tick until told to stop.
void Play(const End& end, double messagesPerTick, const std::stop_token& stop) {
  double due = 0;
  for (double next = Now(); !stop.stop_requested(); next += kTick) {
    end.poll();
    due += messagesPerTick;
    end.send(static_cast<std::size_t>(due));
    due -= std::floor(due);
    Sleep(std::max(0.0, next + kTick - Now()));
  }
}

struct Load {
  double door = 0;    // share of a core, of the threads that the server's end has begun
  double server = 0;  // of the thread that plays it
  std::size_t received = 0;
};

// The server's end on a thread of its own beside the clients'.
Load Measure(const End& server, const End& clients, const std::set<std::string>& doors, const std::size_t& received) {
  std::jthread clientThread([&](const std::stop_token& stop) { Play(clients, 1, stop); });
  const std::set<std::string> before = ListThreads();
  std::jthread serverThread([&](const std::stop_token& stop) { Play(server, 1.5, stop); });
  Sleep(1);
  std::string own;
  for (const std::string& thread : ListThreads()) {
    if (!before.contains(thread)) own = thread;
  }
  const auto readDoors = [&] {
    double sum = 0;
    for (const std::string& door : doors) sum += ReadThread(door);
    return sum;
  };
  const double begin = Now(), doorsBefore = readDoors(), ownBefore = ReadThread(own);
  Sleep(kSpan);
  const double span = Now() - begin;
  const Load load{.door = (readDoors() - doorsBefore) / span, .server = (ReadThread(own) - ownBefore) / span};
  serverThread.request_stop();
  clientThread.request_stop();
  serverThread.join();
  clientThread.join();
  return {.door = load.door, .server = load.server, .received = received};
}

Load MeasureSealed() {
  std::string error;
  const std::set<std::string> before = ListThreads();
  const auto server = EnetTransport::Listen({.maxConnections = kClients}, error);
  std::set<std::string> doors = ListThreads();
  for (const std::string& thread : before) doors.erase(thread);
  std::vector<std::unique_ptr<EnetTransport>> clients;
  for (std::size_t i = 0; i < kClients; ++i)
    clients.push_back(EnetTransport::Connect("127.0.0.1", server->ReadPort(), error));
  std::vector<ConnectionId> known;
  std::size_t received = 0, connected = 0;
  const auto pollServer = [&] {
    server->Poll(Now(), [&](const Event& event) {
      if (event.kind == Event::Kind::kConnected) known.push_back(event.connection);
      if (event.kind == Event::Kind::kMessage) ++received;
    });
  };
  const auto pollClients = [&] {
    for (auto& client : clients) {
      client->Poll(Now(), [&](const Event& event) { connected += event.kind == Event::Kind::kConnected ? 1U : 0U; });
    }
  };
  for (const double end = Now() + 10; Now() < end && (connected < kClients || known.size() < kClients); Sleep(0.002)) {
    pollServer();
    pollClients();
  }
  EXPECT_EQ(known.size(), kClients);
  const auto sendDown = [&](std::size_t count) {
    for (const ConnectionId id : known) {
      for (std::size_t i = 0; i < count; ++i) static_cast<void>(server->Send(id, Channel::kSnapshot, kSnapshot));
    }
    server->Flush();
  };
  const auto sendUp = [&](std::size_t) {
    for (auto& client : clients) {
      static_cast<void>(client->Send(EnetTransport::kClientConnection, Channel::kInput, kInput));
      client->Flush();
    }
  };
  return Measure({pollServer, sendDown}, {pollClients, sendUp}, doors, received);
}

struct HostDeleter {
  void operator()(ENetHost* host) const { enet_host_destroy(host); }
};
using Host = std::unique_ptr<ENetHost, HostDeleter>;

void SendPlain(ENetPeer* peer, Channel channel, const Bytes& bytes) {
  ENetPacket* packet = enet_packet_create(bytes.data(), bytes.size(), ENET_PACKET_FLAG_UNSEQUENCED);
  if (enet_peer_send(peer, static_cast<enet_uint8>(channel), packet) < 0) enet_packet_destroy(packet);
}

Load MeasurePlain() {
  const ENetAddress any{.host = ENET_HOST_ANY, .port = 0};
  const Host server(enet_host_create(&any, kClients, transport::kChannelCount, 0, 0));
  server->checksum = enet_crc32;
  server->maximumPacketSize = 1 << 16;
  enet_socket_set_option(server->socket, ENET_SOCKOPT_RCVBUF, 4 * 1024 * 1024);
  enet_socket_set_option(server->socket, ENET_SOCKOPT_SNDBUF, 4 * 1024 * 1024);
  ENetAddress address;
  enet_socket_get_address(server->socket, &address);
  enet_address_set_host_ip(&address, "127.0.0.1");
  std::vector<Host> clients;
  std::size_t received = 0, connected = 0;
  for (std::size_t i = 0; i < kClients; ++i) {
    clients.emplace_back(enet_host_create(nullptr, 1, transport::kChannelCount, 0, 0));
    clients.back()->checksum = enet_crc32;
    enet_host_connect(clients.back().get(), &address, transport::kChannelCount, 0);
  }
  const auto poll = [](ENetHost* host, std::size_t& messages, std::size_t& connects) {
    ENetEvent event;
    while (enet_host_service(host, &event, 0) > 0) {
      if (event.type == ENET_EVENT_TYPE_CONNECT) {
        ++connects;
        // Else ENet drops a part of the load when round trips vary.
        enet_peer_throttle_configure(event.peer, ENET_PEER_PACKET_THROTTLE_INTERVAL, ENET_PEER_PACKET_THROTTLE_SCALE,
                                     0);
      }
      if (event.type != ENET_EVENT_TYPE_RECEIVE) continue;
      ++messages;
      enet_packet_destroy(event.packet);
    }
  };
  std::size_t ignored = 0;
  const auto pollServer = [&] { poll(server.get(), received, connected); };
  const auto pollClients = [&] {
    for (const Host& client : clients) poll(client.get(), ignored, ignored);
  };
  for (const double end = Now() + 10; Now() < end && connected < kClients; Sleep(0.002)) {
    pollServer();
    pollClients();
  }
  EXPECT_EQ(connected, kClients);
  const auto sendDown = [&](std::size_t count) {
    for (ENetPeer* peer = server->peers; peer < server->peers + server->peerCount; ++peer) {
      for (std::size_t i = 0; i < count; ++i) SendPlain(peer, Channel::kSnapshot, kSnapshot);
    }
    enet_host_flush(server.get());
  };
  const auto sendUp = [&](std::size_t) {
    for (const Host& client : clients) {
      SendPlain(client->peers, Channel::kInput, kInput);
      enet_host_flush(client.get());
    }
  };
  return Measure({pollServer, sendDown}, {pollClients, sendUp}, {}, received);
}

// Turn by turn, the least of each.
TEST(DoorCostTest, OfSixtyFourClientsAgainstPlainEnet) {
  if (!IsNightly()) GTEST_SKIP() << "takes a minute of a quiet machine: by make nightly";
  ASSERT_EQ(enet_initialize(), 0);
  double plain = 1, sealed = 1, door = 1;
  for (int i = 0; i < kRepeats; ++i) {
    const Load ofPlain = MeasurePlain();
    const Load ofSealed = MeasureSealed();
    for (const Load& load : {ofPlain, ofSealed}) EXPECT_GT(load.received, 0.95 * kSpan * 60 * kClients);
    plain = std::min(plain, ofPlain.server);
    if (ofSealed.door + ofSealed.server < sealed) {
      sealed = ofSealed.door + ofSealed.server;
      door = ofSealed.door;
    }
    std::printf("  plain %.2f %% of a core; sealed %.2f %% and %.2f %% of the door's thread\n", 100 * ofPlain.server,
                100 * ofSealed.server, 100 * ofSealed.door);
  }
  std::printf("  plain %.2f %%, sealed %.2f %% in all, of which the door's thread %.2f %%\n", 100 * plain, 100 * sealed,
              100 * door);
  // The limits, 5 % of a core and 2.5 points over plain ENet, are of a machine on which plain ENet costs 2.1 %.
  const double unit = plain / 0.021;
  EXPECT_LE(sealed, 0.05 * unit);
  EXPECT_LE(sealed, plain + 0.025 * unit);
}

struct Delay {
  double p50 = 0, p99 = 0;  // s
};

// Of 3,000 datagrams, one at a time, from the call that sends to the one that has it.
Delay MeasureDelay(const std::function<void()>& send, const std::function<bool()>& hasCome) {
  std::vector<double> times;
  for (int i = 0; i < 3000; ++i) {
    const double begin = Now();
    send();
    // Sleeps of 10 us: a thread that never sleeps would keep the door's thread waiting where both are on one core.
    for (; !hasCome() && Now() < begin + 1; Sleep(1e-5)) {
    }
    times.push_back(Now() - begin);
    Sleep(0.003);
  }
  std::sort(times.begin(), times.end());
  const auto find = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  return {.p50 = find(0.5), .p99 = find(0.99)};
}

// The same way with nothing done on it: a thread that takes a datagram and writes it to a pair of sockets.
Delay MeasureBareDelay() {
  const test::UdpSocket from;
  const int to = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  EXPECT_EQ(bind(to, reinterpret_cast<const sockaddr*>(&address), length), 0);
  EXPECT_EQ(getsockname(to, reinterpret_cast<sockaddr*>(&address), &length), 0);
  const std::uint16_t port = ntohs(address.sin_port);
  std::array<int, 2> pair{};
  EXPECT_EQ(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair.data()), 0);
  std::jthread thread([&] {
    Bytes bytes(2048);
    for (ssize_t size = 1; size > 0;) {
      size = recv(to, bytes.data(), bytes.size(), 0);
      if (write(pair[0], bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))) < 0) return;
    }
  });
  Bytes bytes(2048);
  const Delay delay = MeasureDelay([&] { from.SendTo(port, kInput); },
                                   [&] { return recv(pair[1], bytes.data(), bytes.size(), MSG_DONTWAIT) > 0; });
  from.SendTo(port, {});
  thread.join();
  close(to);
  close(pair[0]);
  close(pair[1]);
  return delay;
}

Delay MeasureSealedDelay() {
  std::string error;
  const auto server = EnetTransport::Listen({}, error);
  const auto client = EnetTransport::Connect("127.0.0.1", server->ReadPort(), error);
  bool isIn = false;
  std::size_t received = 0, sent = 0;
  const auto pollServer = [&] {
    server->Poll(Now(), [&](const Event& event) { received += event.kind == Event::Kind::kMessage ? 1U : 0U; });
  };
  for (const double end = Now() + 5; Now() < end && !isIn; Sleep(0.002)) {
    pollServer();
    client->Poll(Now(), [&](const Event& event) { isIn = isIn || event.kind == Event::Kind::kConnected; });
  }
  EXPECT_TRUE(isIn);
  return MeasureDelay(
      [&] {
        client->Poll(Now(), [](const Event&) {});
        static_cast<void>(client->Send(EnetTransport::kClientConnection, Channel::kInput, kInput));
        client->Flush();
        ++sent;
      },
      [&] { return pollServer(), received >= sent; });
}

// From a client's call that sends to the server's sink, the system's own way over loopback included.
TEST(DoorCostTest, ADatagramIsHandedOnAtOnce) {
  if (!IsNightly()) GTEST_SKIP() << "wants a quiet machine: by make nightly";
  prctl(PR_SET_TIMERSLACK, 1);
  double best = 1;
  for (int i = 0; i < 3; ++i) {
    const Delay bare = MeasureBareDelay(), sealed = MeasureSealedDelay();
    std::printf("  bare p50 %.0f us, p99 %.0f us; sealed and filtered p50 %.0f us, p99 %.0f us\n", 1e6 * bare.p50,
                1e6 * bare.p99, 1e6 * sealed.p50, 1e6 * sealed.p99);
    best = std::min(best, sealed.p99);
  }
  EXPECT_LE(best, 3e-4);
}

}  // namespace
}  // namespace wobble::attack
