// The client of Agones against sidecars in this process: one that answers and records the requests, and faulty ones.
#include "server/ops/agones.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/sidecar.h"

namespace wobble::ops {
namespace {

using Kind = FleetCall::Kind;
using Calls = std::vector<FleetCall>;
using Strings = std::vector<std::string>;
using test::Sidecar;
using testing::ElementsAre;
using testing::ElementsAreArray;

double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A sidecar that never gives a complete answer.
class BadSidecar {
 public:
  enum class Habit {
    kSilent,   // accepts connections and never answers
    kDrips,    // sends a byte every 50 ms, for ever
    kHangsUp,  // closes every connection at once
  };
  explicit BadSidecar(Habit habit) : m_habit(habit), m_socket(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(m_socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(listen(m_socket, 64), 0);
    socklen_t size = sizeof address;
    EXPECT_EQ(getsockname(m_socket, reinterpret_cast<sockaddr*>(&address), &size), 0);
    m_port = ntohs(address.sin_port);
    m_thread = std::thread([this] { Work(); });
  }
  ~BadSidecar() {
    m_isEnding = true;
    m_thread.join();
    for (const int connection : m_connections) close(connection);
    close(m_socket);
  }

  [[nodiscard]] std::uint16_t Port() const { return m_port; }
  [[nodiscard]] int CountConnections() const { return m_count; }

 private:
  void Work() {
    while (!m_isEnding) {
      pollfd listening{m_socket, POLLIN, 0};
      if (poll(&listening, 1, 50) > 0) Take(accept(m_socket, nullptr, nullptr));
      if (m_habit != Habit::kDrips) continue;
      for (const int connection : m_connections) send(connection, "H", 1, MSG_NOSIGNAL);
    }
  }
  void Take(int connection) {
    if (m_habit == Habit::kHangsUp) {
      close(connection);
    } else {
      m_connections.push_back(connection);
    }
    ++m_count;
  }

  Habit m_habit;
  int m_socket;
  std::uint16_t m_port = 0;
  std::atomic<bool> m_isEnding = false;
  std::atomic<int> m_count = 0;
  std::vector<int> m_connections;
  std::thread m_thread;
};

// Waits until the client has counted so many attempts of any outcome.
void WaitForTries(const Agones& agones, std::uint64_t count) {
  const double deadline = ReadClock() + 20;
  const auto countTries = [&] { return agones.ReadCounts().succeeded + agones.ReadCounts().failed; };
  while (countTries() < count && ReadClock() < deadline) std::this_thread::yield();
  EXPECT_GE(countTries(), count);
}

// A port of a server that has just ended, on which nothing listens.
std::uint16_t FindDeadPort() { return Sidecar().Port(); }

TEST(Agones, MakesTheCallsOfAWholeLifeInOrder) {
  Sidecar sidecar;
  FleetDuty duty;
  Strings expected;
  {
    Agones agones(sidecar.Port());
    // One turn of the loop, and the requests that it should cause.
    const auto turn = [&](double now, const std::vector<std::uint32_t>& players, bool acceptsJoins,
                          const Strings& requests) {
      agones.Perform(duty.Follow({.now = now, .acceptsJoins = acceptsJoins, .players = players}));
      expected.insert(expected.end(), requests.begin(), requests.end());
      EXPECT_THAT(sidecar.WaitFor(expected.size()), ElementsAreArray(expected)) << "at " << now;
    };
    turn(0, {}, false, {"POST /health {}"});
    turn(0.5, {}, true, {"POST /ready {}"});
    turn(1.9, {}, true, {});
    turn(2, {7}, true,
         {"POST /health {}", "POST /allocate {}", R"(PATCH /v1beta1/counters/players {"countDiff":"1"})",
          R"(POST /v1beta1/lists/players:addValue {"value":"player-7"})"});
    turn(3, {7, 4000000000}, true,
         {R"(PATCH /v1beta1/counters/players {"countDiff":"1"})",
          R"(POST /v1beta1/lists/players:addValue {"value":"player-4000000000"})"});
    turn(3.5, {4000000000}, true,
         {R"(PATCH /v1beta1/counters/players {"countDiff":"-1"})",
          R"(POST /v1beta1/lists/players:removeValue {"value":"player-7"})"});
    turn(4, {}, true,
         {"POST /health {}", R"(PATCH /v1beta1/counters/players {"countDiff":"-1"})",
          R"(POST /v1beta1/lists/players:removeValue {"value":"player-4000000000"})"});
    turn(13.4, {}, true, {"POST /health {}"});
    turn(13.5, {}, true, {"POST /shutdown {}"});
    turn(15, {8}, true, {});
    turn(15.5, {8}, true, {"POST /health {}"});
    WaitForTries(agones, expected.size());
    EXPECT_EQ(agones.ReadCounts().failed, 0U);
  }
  EXPECT_THAT(sidecar.WaitFor(0), ElementsAreArray(expected)) << "nothing comes late, nothing twice";
}

TEST(Agones, NumbersAreStrings) {
  Sidecar sidecar;
  Agones agones(sidecar.Port());
  agones.Perform(Calls{{Kind::kAddPlayer, 1}, {Kind::kRemovePlayer, 1}});
  const Strings requests = sidecar.WaitFor(4);
  const auto parse = [](const std::string& request) {
    return nlohmann::json::parse(request.substr(request.find('{')));
  };
  EXPECT_EQ(parse(requests[0]), nlohmann::json({{"countDiff", "1"}}));
  EXPECT_EQ(parse(requests[2]), nlohmann::json({{"countDiff", "-1"}}));
}

TEST(Agones, SendsWhatWaitsBeforeItEnds) {
  Sidecar sidecar;
  Agones(sidecar.Port()).Perform(Calls{{Kind::kAddPlayer, 1}, {Kind::kShutdown}});
  const Strings requests = sidecar.WaitFor(0);
  ASSERT_EQ(requests.size(), 3U);
  EXPECT_EQ(requests.back(), "POST /shutdown {}");
}

TEST(Agones, ADeadPortDelaysNobody) {
  const double begin = ReadClock();
  {
    Agones agones(FindDeadPort());
    for (int i = 0; i < 100; ++i) agones.Perform(Calls{{Kind::kHealth}, {Kind::kReady}});
    WaitForTries(agones, 2);
    EXPECT_EQ(agones.ReadCounts().succeeded, 0U);
  }
  EXPECT_LT(ReadClock() - begin, 1) << "there is nothing to wait for where nobody listens";
}

TEST(Agones, ASidecarThatNeverAnswersDelaysNobody) {
  BadSidecar sidecar(BadSidecar::Habit::kSilent);
  const double start = ReadClock();
  auto agones = std::make_unique<Agones>(sidecar.Port());
  double longest = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const double begin = ReadClock();
    agones->Perform(Calls{{Kind::kHealth}, {Kind::kAddPlayer, i}});
    longest = std::max(longest, ReadClock() - begin);
  }
  EXPECT_LT(longest, 0.5) << "a call would have waited for 1 s";
  const Agones::Counts counts = agones->ReadCounts();
  EXPECT_GE(counts.dropped, 4000U - 1024U - 1U) << "two for each player; a thousand wait, one may be under way";
  EXPECT_LE(counts.dropped, 4000U - 1024U);
  WaitForTries(*agones, 1);
  EXPECT_LT(ReadClock() - start, 3) << "a call is given up after 1 s";
  const double begin = ReadClock();
  agones.reset();
  EXPECT_LT(ReadClock() - begin, 1.9);
}

TEST(Agones, ASidecarThatDripsIsHungUpOn) {
  BadSidecar sidecar(BadSidecar::Habit::kDrips);
  auto agones = std::make_unique<Agones>(sidecar.Port());
  agones->Perform(Calls{{Kind::kShutdown}});
  while (sidecar.CountConnections() == 0) std::this_thread::yield();
  const double begin = ReadClock();
  agones.reset();
  EXPECT_LT(ReadClock() - begin, 1.9);
}

TEST(Agones, ASidecarThatHangsUpDoesNotEndTheServer) {
  BadSidecar sidecar(BadSidecar::Habit::kHangsUp);
  ASSERT_NE(signal(SIGPIPE, SIG_DFL), SIG_ERR);
  Agones agones(sidecar.Port());
  for (std::uint64_t i = 1; i <= 200; ++i) {
    agones.Perform(Calls{{Kind::kHealth}});
    WaitForTries(agones, i);
  }
  EXPECT_EQ(agones.ReadCounts().succeeded, 0U);
}

volatile std::sig_atomic_t g_signals = 0;
void CountSignal(int) { g_signals = g_signals + 1; }

// On most systems the test above needs this too: writing to a closed connection raises SIGPIPE.
TEST(Agones, ItsThreadTakesNoSignals) {
  Agones agones(FindDeadPort());
  agones.Perform(Calls{{Kind::kHealth}});
  WaitForTries(agones, 1);
  // There is no other thread, and this one blocks the signal.
  ASSERT_NE(signal(SIGTERM, CountSignal), SIG_ERR);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  ASSERT_EQ(pthread_sigmask(SIG_BLOCK, &set, nullptr), 0);
  ASSERT_EQ(kill(getpid(), SIGTERM), 0);
  agones.Perform(Calls{{Kind::kHealth}});
  WaitForTries(agones, 2);
  EXPECT_EQ(g_signals, 0);
  const timespec noTime{};
  EXPECT_EQ(sigtimedwait(&set, nullptr, &noTime), SIGTERM) << "it still waits for a thread that takes it";
  EXPECT_EQ(pthread_sigmask(SIG_UNBLOCK, &set, nullptr), 0);
  signal(SIGTERM, SIG_DFL);
}

TEST(Agones, ASidecarThatComesLateHearsEverythingInOrder) {
  const std::uint16_t port = FindDeadPort();
  Agones agones(port);
  agones.Perform(Calls{{Kind::kHealth}, {Kind::kReady}});
  WaitForTries(agones, 2);
  agones.Perform(Calls{{Kind::kAllocate}, {Kind::kAddPlayer, 1}});
  WaitForTries(agones, 3);
  Sidecar sidecar(port);
  agones.Perform(Calls{{Kind::kHealth}});
  EXPECT_THAT(sidecar.WaitFor(5), ElementsAre("POST /health {}", "POST /ready {}", "POST /allocate {}",
                                              R"(PATCH /v1beta1/counters/players {"countDiff":"1"})",
                                              R"(POST /v1beta1/lists/players:addValue {"value":"player-1"})"));
}

TEST(Agones, OnlyWhatSetsAStateIsTriedAgainAndOnlyIfItWasNotRefused) {
  Sidecar sidecar;
  Agones agones(sidecar.Port());
  sidecar.Refuse("/ready", 503);
  agones.Perform(Calls{{Kind::kReady}, {Kind::kAllocate}, {Kind::kAddPlayer, 1}});
  WaitForTries(agones, 1);
  sidecar.Refuse("/ready", 0);
  sidecar.Refuse("/allocate", 404);
  sidecar.Refuse("/v1beta1/counters/players", 503);
  agones.Perform(Calls{{Kind::kHealth}});
  WaitForTries(agones, 6);
  agones.Perform(Calls{{Kind::kHealth}});
  EXPECT_THAT(sidecar.WaitFor(7),
              ElementsAre("POST /ready {}", "POST /health {}", "POST /ready {}", "POST /allocate {}",
                          R"(PATCH /v1beta1/counters/players {"countDiff":"1"})",
                          R"(POST /v1beta1/lists/players:addValue {"value":"player-1"})", "POST /health {}"));
  WaitForTries(agones, 7);
  EXPECT_EQ(agones.ReadCounts().failed, 3U);
}

TEST(Agones, PortsThatAreNone) {
  std::string error;
  EXPECT_EQ(ParseSidecarPort("9358", error), 9358);
  EXPECT_EQ(ParseSidecarPort("1", error), 1);
  EXPECT_EQ(ParseSidecarPort("65535", error), 65535);
  EXPECT_EQ(error, "");
  for (const std::string text : {"", "0", "65536", "-1", "+80", " 80", "80 ", "http", "99999999999999999999"}) {
    error.clear();
    EXPECT_EQ(ParseSidecarPort(text, error), std::nullopt) << text;
    EXPECT_EQ(error, "AGONES_SDK_HTTP_PORT " + text + ": must be 1 to 65535");
  }
}

}  // namespace
}  // namespace wobble::ops
