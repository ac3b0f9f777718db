// A real server as a child process, what it uses, and honest players who tell what an attack does to them.
//
// All traffic is on the loopback interface. Addresses 127.x.y.z stand for different machines.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "client/client.h"
#include "client/command/child.h"
#include "protocol/transport/client_bridge.h"
#include "protocol/transport/enet_transport.h"
#include "tests/support/places.h"
#include "tests/support/udp_socket.h"

namespace wobble::attack {

using test::Bytes;
using test::Now;

inline void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

// Of the victim's memory, bytes: AddressSanitizer keeps what is freed, to find later uses of it.
#ifdef WOBBLE_SANITIZED
inline constexpr double kHeldBySanitizer = 16e6;
#else
inline constexpr double kHeldBySanitizer = 0;
#endif

class Victim {
 public:
  explicit Victim(const std::vector<std::string>& options = {}, const std::string& scene = "pair") {
    // Nothing of a test stays in the home of who runs it.
    setenv("XDG_STATE_HOME", testing::TempDir().c_str(), 1);
    std::vector<std::string> words{test::FindProgram("wobbled"),
                                   "--port",
                                   "0",
                                   "--scene",
                                   scene,
                                   "--untrained",
                                   "--threads",
                                   "1",
                                   "--log-level",
                                   "warn",
                                   "--admit-when-busy",
                                   "--for",
                                   "60"};
    words.insert(words.end(), options.begin(), options.end());
    std::string error;
    EXPECT_TRUE(m_child.Start(words, error)) << error;
    const auto hasPort = [&] {
      for (const std::string& line : m_child.TakeOutput()) {
        std::sscanf(line.c_str(), "metrics and health on TCP port %hu", &opsPort);
        if (std::sscanf(line.c_str(), "listening on UDP port %hu", &port) == 1) return true;
      }
      return false;
    };
    for (const double end = Now() + 20; Now() < end && !hasPort(); Sleep(0.01)) m_child.Update();
    EXPECT_NE(port, 0) << "the server does not start";
    // The child's number is not shown: it is the parent's newest.
    std::ifstream children("/proc/self/task/" + std::to_string(getpid()) + "/children");
    while (children >> m_pid) {
    }
  }

  [[nodiscard]] bool IsAlive() {
    m_child.Update();
    return m_child.IsRunning();
  }
  // Seconds of processor time so far.
  [[nodiscard]] double ReadProcessor() const {
    std::ifstream file("/proc/" + m_pid + "/stat");
    std::string words;
    std::getline(file, words);
    unsigned long user = 0, system = 0;
    std::sscanf(words.c_str() + words.rfind(')'), ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user,
                &system);
    return static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  }
  // Resident memory, bytes.
  [[nodiscard]] double ReadMemory() const {
    std::ifstream file("/proc/" + m_pid + "/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
  }

  [[nodiscard]] std::size_t CountDescriptors() const {
    const std::filesystem::directory_iterator all("/proc/" + m_pid + "/fd");
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

  std::uint16_t port = 0;
  std::uint16_t opsPort = 0;  // of --ops 0

 private:
  command::Child m_child;
  std::string m_pid;
};

// Honest players on a thread of their own, who join at once and stay.
class Honest {
 public:
  Honest(std::uint16_t port, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      std::string error;
      auto transport = transport::EnetTransport::Connect("127.0.0.1", port, error);
      EXPECT_NE(transport, nullptr) << error;
      m_clients.push_back(std::make_unique<client::Client>(std::move(transport), client::Options{}, Now()));
    }
    m_thread = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        for (auto& each : m_clients) each->Update(Now());
        Sleep(1.0 / 120);
      }
    });
  }
  // Stops them; call it before the counts.
  void Stop() {
    m_thread.request_stop();
    if (m_thread.joinable()) m_thread.join();
  }
  [[nodiscard]] std::size_t CountPlaying() const {
    return static_cast<std::size_t>(std::count_if(m_clients.begin(), m_clients.end(), [](const auto& each) {
      return each->ReadState() == client::State::kPlaying;
    }));
  }
  // The slowest join, s.
  [[nodiscard]] double FindSlowestJoin() const {
    double slowest = 0;
    for (const auto& each : m_clients) slowest = std::max(slowest, each->ReadStatistics().joinSeconds);
    return slowest;
  }
  [[nodiscard]] std::string FirstReason() const {
    for (const auto& each : m_clients) {
      if (!each->EndReason().empty()) return each->EndReason();
    }
    return "none ended";
  }

 private:
  std::vector<std::unique_ptr<client::Client>> m_clients;
  std::jthread m_thread;
};

// A UDP socket at an address of this machine's loopback.
class Attacker {
 public:
  Attacker(const char* from, std::uint16_t port) : m_descriptor(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    inet_pton(AF_INET, from, &own.sin_addr);
    EXPECT_EQ(bind(m_descriptor, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(port);
    inet_pton(AF_INET, "127.0.0.1", &server.sin_addr);
    EXPECT_EQ(connect(m_descriptor, reinterpret_cast<const sockaddr*>(&server), sizeof server), 0);
  }
  ~Attacker() { close(m_descriptor); }
  Attacker(const Attacker&) = delete;
  Attacker& operator=(const Attacker&) = delete;

  void Send(const Bytes& bytes) {
    sent += bytes.size();
    static_cast<void>(send(m_descriptor, bytes.data(), bytes.size(), 0));
  }
  // The next datagram; empty: none.
  Bytes Receive() {
    Bytes bytes(2048);
    const ssize_t size = recv(m_descriptor, bytes.data(), bytes.size(), 0);
    bytes.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    received += bytes.size();
    return bytes;
  }

  std::size_t sent = 0;  // bytes
  std::size_t received = 0;

 private:
  int m_descriptor;
};

// A client that is let in and then says to ENet whatever it likes.
class Intruder {
 public:
  Intruder(const char* from, std::uint16_t port) : m_socket(from, port), m_caller({}) {
    for (const double end = Now() + 5;
         Now() < end && m_caller.ReadState() != transport::vestibule::Caller::State::kIn;) {
      Bytes datagram;
      m_caller.FindDue(Now(), datagram);
      if (!datagram.empty()) m_socket.Send(datagram);
      if (m_caller.CanSeal() && !m_hasCalled) {
        m_hasCalled = true;
        Say(MakeConnect());
      }
      Listen();
      Sleep(0.002);
    }
    for (const double end = Now() + 0.2; Now() < end; Sleep(0.01)) Listen();
    Command({0x01, 0xFF, 0, 1, 0, 1, m_sentTime[0], m_sentTime[1]});  // acknowledges the verification
    Sleep(0.1);
  }
  [[nodiscard]] bool IsReset() const { return m_caller.ReadState() == transport::vestibule::Caller::State::kReset; }
  [[nodiscard]] std::size_t CountReceived() const { return m_socket.received; }
  [[nodiscard]] bool IsIn() const { return m_caller.ReadState() == transport::vestibule::Caller::State::kIn; }

  // One datagram of ENet, without its checksum, which is filled in here.
  void Say(Bytes plain) {
    const std::size_t at = (plain[0] & 0x80) != 0 ? 4 : 2;
    if (m_isConnected)
      std::copy(m_connection.begin(), m_connection.end(), plain.begin() + static_cast<std::ptrdiff_t>(at));
    const std::span<const std::uint8_t> part = plain;
    Bytes datagram;
    m_caller.Seal({&part, 1}, Now(), datagram);
    m_socket.Send(datagram);
  }
  // A datagram with these commands, to the peer that the server has given to this connection.
  void Command(const Bytes& commands) {
    Bytes plain{static_cast<std::uint8_t>(m_peer >> 8U), static_cast<std::uint8_t>(m_peer), 0, 0, 0, 0};
    plain.insert(plain.end(), commands.begin(), commands.end());
    Say(plain);
  }
  // Takes in what has come. True when the server has sent it away: its goodbye is the first message to who has said
  // nothing, and is followed by ENet's disconnect only once it is acknowledged.
  bool Listen() {
    for (Bytes datagram = m_socket.Receive(); !datagram.empty(); datagram = m_socket.Receive()) {
      const auto plain = m_caller.TakeDatagram(datagram, Now());
      if (plain.size() < 12) continue;
      const std::size_t head = (plain[0] & 0x80) != 0 ? 8 : 6;
      if ((plain[head] & 0x0FU) == kVerify) {  // tells our peer number
        m_peer = plain[head + 4] << 8U | plain[head + 5];
        m_peer |= static_cast<unsigned>(plain[head + 7] & 3U) << 12U;
        m_isConnected = true;
        m_sentTime = {plain[2], plain[3]};
      }
      NoteEnd(plain.subspan(head));
    }
    return m_isEnded || m_caller.HasEnded();
  }

 private:
  static constexpr unsigned kAcknowledge = 1, kVerify = 3, kDisconnect = 4, kSendReliable = 6;
  void NoteEnd(std::span<const std::uint8_t> commands) {
    while (commands.size() >= 8 && (commands[0] & 0x0FU) == kAcknowledge) commands = commands.subspan(8);
    if (commands.empty()) return;
    const unsigned command = commands[0] & 0x0FU;
    m_isEnded = m_isEnded || command == kDisconnect || command == kSendReliable;
  }
  Bytes MakeConnect() {
    Bytes bytes{0x8F, 0xFF, 0, 1, 0, 0, 0, 0, 0x82, 0xFF, 0, 1, 0, 0, 0, 0};
    const auto add = [&](std::uint32_t number) {
      for (int i = 3; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(number >> 8 * i));
    };
    add(transport::kMtu);
    add(65536);
    add(transport::kChannelCount);
    add(0);
    add(0);
    add(5000);
    add(2);
    add(2);
    m_connection = {static_cast<std::uint8_t>(getpid()), static_cast<std::uint8_t>(bytes.size()), 7,
                    static_cast<std::uint8_t>(reinterpret_cast<std::uintptr_t>(this) >> 6U)};
    bytes.insert(bytes.end(), m_connection.begin(), m_connection.end());
    add(0);
    return bytes;
  }

  Attacker m_socket;
  transport::vestibule::Caller m_caller;
  bool m_hasCalled = false;
  bool m_isConnected = false;
  bool m_isEnded = false;
  unsigned m_peer = 0;
  std::array<std::uint8_t, 2> m_sentTime{};
  std::array<std::uint8_t, 4> m_connection{};
};

}  // namespace wobble::attack
