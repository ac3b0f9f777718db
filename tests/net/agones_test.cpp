// The client of Agones against sidecars in this process: one that behaves as Agones, and faulty ones.
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

#include "tests/support/log_catcher.h"
#include "tests/support/sidecar.h"

namespace wobble::ops {
namespace {

using Strings = std::vector<std::string>;
using test::AgonesModel;
using test::Sidecar;
using testing::HasSubstr;

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

std::uint64_t CountTries(const Agones& agones) {
  const Agones::Counts counts = agones.ReadCounts();
  return counts.succeeded + counts.failed;
}

// Waits until the client has counted so many attempts of any outcome.
void WaitForTries(const Agones& agones, std::uint64_t count) {
  const double deadline = ReadClock() + 20;
  while (CountTries(agones) < count && ReadClock() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_GE(CountTries(agones), count);
}

// A port of a server that has just ended, on which nothing listens.
std::uint16_t FindDeadPort() { return Sidecar().Port(); }

// Two players, and the record says so.
const FleetWish kTwo{.state = FleetWish::State::kAllocated, .players = {1, 2}, .heartbeats = 1};
bool HasTwo(const AgonesModel& record) {
  return record.state == "Allocated" && record.count == 2 && record.values == Strings{"player-1", "player-2"};
}
bool IsReady(const AgonesModel& record) { return record.state == "Ready"; }

TEST(Agones, MakesTheCallsOfAWholeLife) {
  Sidecar sidecar;
  {
    Agones agones(sidecar.Port());
    FleetDuty duty;
    const std::vector<std::uint32_t> players{2, 1};
    agones.Want(duty.Follow({.now = 0}));
    agones.Want(duty.Follow({.now = 0.5, .acceptsJoins = true}));
    sidecar.WaitUntil(IsReady);
    agones.Want(duty.Follow({.now = 3, .acceptsJoins = true, .players = players}));
    sidecar.WaitUntil(HasTwo);
    agones.Want(duty.Follow({.now = 4, .isClosing = true}));
    EXPECT_EQ(agones.ReadCounts().failed, 0U);
  }
  const AgonesModel record = sidecar.WaitUntil([](const AgonesModel& each) { return each.state == "Shutdown"; });
  EXPECT_EQ(record.requests.front(), "POST /health {}");
  EXPECT_EQ(std::ranges::count(record.requests, "POST /shutdown {}"), 1);
  EXPECT_EQ(std::ranges::count(record.requests, "POST /ready {}"), 1);
  EXPECT_EQ(std::ranges::count(record.requests, "POST /allocate {}"), 1);
}

TEST(Agones, SendsWhatIsDueBeforeItEnds) {
  Sidecar sidecar;
  Agones(sidecar.Port()).Want({.state = FleetWish::State::kShutdown});
  EXPECT_EQ(sidecar.Read().requests, Strings{"POST /shutdown {}"});
}

TEST(Agones, AFrozenSidecarIsPutRightWhenItThaws) {
  Sidecar sidecar;
  test::LogCatcher log;
  {
    Agones agones(sidecar.Port());
    agones.Want({.state = FleetWish::State::kReady});
    sidecar.WaitUntil(IsReady);
    sidecar.Freeze(true);
    const std::uint64_t before = CountTries(agones);
    agones.Want({.state = FleetWish::State::kAllocated, .players = {1, 2, 3, 4, 5}});
    WaitForTries(agones, before + 1);
    agones.Want(kTwo);
    WaitForTries(agones, before + 2);
    sidecar.Freeze(false);
    sidecar.WaitUntil(HasTwo);
  }
  EXPECT_THAT(log.Text(), HasSubstr("no answer"));
}

TEST(Agones, ARestartedSidecarThatForgotAllocateIsToldAgain) {
  auto sidecar = std::make_unique<Sidecar>();
  const std::uint16_t port = sidecar->Port();
  Agones agones(port);
  agones.Want({.state = FleetWish::State::kReady});
  sidecar->WaitUntil(IsReady);
  agones.Want(kTwo);
  AgonesModel record = sidecar->WaitUntil(
      [](const AgonesModel& each) { return std::ranges::count(each.requests, "POST /allocate {}") == 1; });
  sidecar.reset();
  record.Crash();
  record.state = "Ready";
  Sidecar next(port, record);
  next.WaitUntil(HasTwo);
}

TEST(Agones, ASidecarThatAlwaysAnswersTooLateIsPutRight) {
  Sidecar sidecar;
  sidecar.Delay(std::chrono::milliseconds(1200));
  Agones agones(sidecar.Port());
  agones.Want(kTwo);
  WaitForTries(agones, 2);
  sidecar.Delay(std::chrono::milliseconds(300));
  sidecar.WaitUntil(HasTwo);
}

TEST(Agones, ASidecarThatComesLateHearsEverything) {
  const std::uint16_t port = FindDeadPort();
  Agones agones(port);
  agones.Want(kTwo);
  WaitForTries(agones, 1);
  Sidecar sidecar(port);
  sidecar.WaitUntil(HasTwo);
}

TEST(Agones, SaysEachTroubleOnceWithTheSidecarsWords) {
  Sidecar sidecar;
  sidecar.Touch([](AgonesModel& model) {
    model.refusals["/ready"] = {500, R"({"code":2,"message":"etcd is full"})"};
    model.refusals["/gameserver"] = {200, "nonsense"};
  });
  test::LogCatcher log;
  {
    Agones agones(sidecar.Port());
    agones.Want({.state = FleetWish::State::kReady});
    WaitForTries(agones, 3);  // it has been refused twice
    sidecar.Touch([](AgonesModel& model) { model.refusals.clear(); });
    sidecar.WaitUntil(IsReady);
  }
  EXPECT_EQ(log.Text(),
            "Agones: POST /ready: status 500: etcd is full\n"
            "Agones: GET /gameserver: the answer cannot be read: nonsense\n"
            "Agones: GET /gameserver: works again\n"
            "Agones: POST /ready: works again\n");
}

TEST(Agones, ADeadPortDelaysNobody) {
  const double begin = ReadClock();
  {
    Agones agones(FindDeadPort());
    for (std::uint64_t i = 0; i < 100; ++i) agones.Want({.state = FleetWish::State::kReady, .heartbeats = i});
    WaitForTries(agones, 1);
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
    agones->Want({.state = FleetWish::State::kAllocated, .players = {i}, .heartbeats = i});
    longest = std::max(longest, ReadClock() - begin);
  }
  EXPECT_LT(longest, 0.5) << "a call would have waited for 1 s";
  WaitForTries(*agones, 1);
  EXPECT_LT(ReadClock() - start, 3) << "a call is given up after 1 s";
  const double begin = ReadClock();
  agones.reset();
  EXPECT_LT(ReadClock() - begin, 1.9);
}

TEST(Agones, ASidecarThatDripsIsHungUpOn) {
  BadSidecar sidecar(BadSidecar::Habit::kDrips);
  auto agones = std::make_unique<Agones>(sidecar.Port());
  agones->Want({.state = FleetWish::State::kShutdown});
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
    agones.Want({.heartbeats = i});
    WaitForTries(agones, i);
  }
  EXPECT_EQ(agones.ReadCounts().succeeded, 0U);
}

volatile std::sig_atomic_t g_signals = 0;
void CountSignal(int) { g_signals = g_signals + 1; }

// On most systems the test above needs this too: writing to a closed connection raises SIGPIPE.
TEST(Agones, ItsThreadTakesNoSignals) {
  Agones agones(FindDeadPort());
  agones.Want({.heartbeats = 1});
  WaitForTries(agones, 1);
  // There is no other thread, and this one blocks the signal.
  ASSERT_NE(signal(SIGTERM, CountSignal), SIG_ERR);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  ASSERT_EQ(pthread_sigmask(SIG_BLOCK, &set, nullptr), 0);
  ASSERT_EQ(kill(getpid(), SIGTERM), 0);
  agones.Want({.heartbeats = 2});
  WaitForTries(agones, 2);
  EXPECT_EQ(g_signals, 0);
  const timespec noTime{};
  EXPECT_EQ(sigtimedwait(&set, nullptr, &noTime), SIGTERM) << "it still waits for a thread that takes it";
  EXPECT_EQ(pthread_sigmask(SIG_UNBLOCK, &set, nullptr), 0);
  signal(SIGTERM, SIG_DFL);
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
