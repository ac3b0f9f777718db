// RCON by bytes: a connection's packets, the guesses of an address, and the listener against slow and many.
#include "server/admin/rcon.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <thread>

#include "server/admin/rcon_listener.h"
#include "tests/support/game.h"

namespace wobble::admin {
namespace {

using Step = RconSession::Step;

void Append(std::string& out, std::int64_t number) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(number >> 8 * i));
}
std::string MakePacket(std::int32_t id, std::int32_t type, const std::string& text) {
  std::string out;
  Append(out, static_cast<std::int64_t>(text.size()) + 10);
  Append(out, id);
  Append(out, type);
  return out + text + std::string(2, '\0');
}
constexpr std::int32_t kValue = 0, kExecute = 2, kAuthResponse = 2, kAuth = 3;

struct RconTest : testing::Test {
  RconSession session{[this](std::string_view password) { return password == "tulip" ? RconGuess::kRight : wrong; },
                      [this](const std::string& order) {
                        orders.push_back(order);
                        return lines;
                      }};
  Step Take(const std::string& bytes) {
    session.Add(bytes);
    return session.TakeNext(answer);
  }
  void ComeIn() { EXPECT_EQ(Take(MakePacket(1, kAuth, "tulip")), Step::kAnswered); }

  RconGuess wrong = RconGuess::kWrong;
  std::vector<std::string> lines{"done", "twice"};
  std::vector<std::string> orders;
  std::string answer;
};

TEST_F(RconTest, WhoShowsThePasswordGivesOrders) {
  EXPECT_EQ(Take(MakePacket(7, kAuth, "tulip")), Step::kAnswered);
  EXPECT_EQ(answer, MakePacket(7, kValue, "") + MakePacket(7, kAuthResponse, ""));
  EXPECT_TRUE(session.IsIn());
  EXPECT_EQ(Take(MakePacket(8, kExecute, "scene sumo")), Step::kAnswered);
  EXPECT_EQ(answer, MakePacket(8, kValue, "done\ntwice\n"));
  EXPECT_EQ(orders, std::vector<std::string>{"scene sumo"});
  lines.clear();
  EXPECT_EQ(Take(MakePacket(9, kExecute, "vote")), Step::kAnswered);
  EXPECT_EQ(answer, MakePacket(9, kValue, "")) << "an answer comes even if there is nothing to say";
  EXPECT_EQ(session.TakeNext(answer), Step::kWaits);
}

TEST_F(RconTest, AWrongPasswordIsRefusedByTheIdAlone) {
  EXPECT_EQ(Take(MakePacket(7, kAuth, "rose")), Step::kAnswered);
  EXPECT_EQ(answer, MakePacket(-1, kAuthResponse, ""));
  EXPECT_FALSE(session.IsIn());
  wrong = RconGuess::kShutOut;
  EXPECT_EQ(Take(MakePacket(7, kAuth, "rose")), Step::kEnds);
  EXPECT_EQ(answer, MakePacket(-1, kAuthResponse, ""));
}

TEST_F(RconTest, WithoutThePasswordNothingIsDone) {
  for (const std::int32_t type : {kExecute, kValue, 99}) {
    EXPECT_EQ(Take(MakePacket(3, type, "lock")), Step::kEnds);
    EXPECT_EQ(answer, MakePacket(-1, kAuthResponse, ""));
  }
  ComeIn();
  EXPECT_EQ(Take(MakePacket(2, kAuth, "rose")), Step::kAnswered);
  EXPECT_EQ(Take(MakePacket(3, kExecute, "lock")), Step::kEnds) << "who shows a wrong one later is out again";
  EXPECT_TRUE(orders.empty());
}

// An empty value behind an order ends its answer, however many packets that has.
TEST_F(RconTest, LongAnswersComeInPacketsOfWholeLines) {
  ComeIn();
  lines.clear();
  std::string all;
  for (int i = 0; i < 200; ++i) {
    lines.push_back(std::to_string(i) + " Zoë " + std::string(static_cast<std::size_t>(i % 90), 'x'));
    all += lines.back() + "\n";
  }
  ASSERT_GT(all.size(), 8192U);
  session.Add(MakePacket(4, kExecute, "players") + MakePacket(5, kValue, ""));
  EXPECT_EQ(session.TakeNext(answer), Step::kAnswered);
  std::string told;
  int packets = 0;
  for (std::string rest = answer; !rest.empty(); ++packets) {
    const auto byte = [&](std::size_t at) { return static_cast<std::size_t>(static_cast<std::uint8_t>(rest[at])); };
    const std::size_t size = byte(0) | byte(1) << 8;
    ASSERT_LE(size, kMaxRconBytes);
    ASSERT_LE(size + 4, rest.size());
    const std::string text = rest.substr(12, size - 10);
    EXPECT_EQ(rest.substr(0, size + 4), MakePacket(4, kValue, text));
    EXPECT_EQ(text.back(), '\n');
    told += text;
    rest.erase(0, size + 4);
  }
  EXPECT_EQ(packets, 3);
  EXPECT_EQ(told, all);
  EXPECT_EQ(session.TakeNext(answer), Step::kAnswered);
  EXPECT_EQ(answer, MakePacket(5, kValue, ""));
}

TEST_F(RconTest, ALineLongerThanAPacketIsCutBetweenCharacters) {
  ComeIn();
  lines = {"a"};
  for (int i = 0; i < 3000; ++i) lines.front() += "é";
  EXPECT_EQ(Take(MakePacket(4, kExecute, "players")), Step::kAnswered);
  const std::size_t first = 4085;  // of 4,086 the last would be half a character
  EXPECT_EQ(answer, MakePacket(4, kValue, lines.front().substr(0, first)) +
                        MakePacket(4, kValue, lines.front().substr(first) + "\n"));
}

TEST_F(RconTest, PacketsMayComeInAnyPieces) {
  const std::string all = MakePacket(1, kAuth, "tulip") + MakePacket(2, kExecute, "a") + MakePacket(3, kExecute, "b");
  for (const char byte : all) {
    session.Add({&byte, 1});
    while (session.TakeNext(answer) == Step::kAnswered) {
    }
  }
  EXPECT_EQ(orders, (std::vector<std::string>{"a", "b"}));
  EXPECT_FALSE(session.IsInPacket());
}

TEST_F(RconTest, SizesThatNoPacketHasEndTheConnection) {
  for (const std::int64_t size : {-1, 0, 9, 4097, 0x7FFFFFFF}) {
    RconSession fresh([](std::string_view) { return RconGuess::kRight; },
                      [](const std::string&) { return std::vector<std::string>{}; });
    std::string bytes;
    Append(bytes, size);
    fresh.Add(bytes);
    EXPECT_EQ(fresh.TakeNext(answer), Step::kEnds) << size;
    EXPECT_TRUE(answer.empty());
  }
}

TEST_F(RconTest, BytesOfAnyKindHarmNothing) {
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) {
    RconSession fresh([](std::string_view) { return RconGuess::kRight; },
                      [](const std::string& text) {
                        EXPECT_EQ(text.find('\0'), std::string::npos);
                        return std::vector<std::string>{text};
                      });
    std::string bytes =
        MakePacket(1, kAuth, "") + MakePacket(2, static_cast<std::int32_t>(random() % 5), std::string("x\0y", 3));
    bytes[random() % bytes.size()] = static_cast<char>(random());
    fresh.Add(bytes);
    while (fresh.TakeNext(answer) == Step::kAnswered) EXPECT_LE(answer.size(), 100U);
  }
}

TEST(RconGuard, ShutsAnAddressOutAfterThreeTriesAndListensOnceAMinute) {
  ASSERT_TRUE(transport::vestibule::InitialiseSodium());
  RconGuard guard("tulip", transport::vestibule::Key{1});
  const auto mallory = *transport::ParseIp("203.0.113.5"), neighbour = *transport::ParseIp("203.0.113.9"),
             ada = *transport::ParseIp("2001:db8::1");
  double now = 1000;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(guard.Judge(mallory, "rose", now), RconGuess::kWrong);
  EXPECT_EQ(guard.Judge(mallory, "tulip", now), RconGuess::kShutOut);
  EXPECT_EQ(guard.Judge(neighbour, "tulip", now), RconGuess::kShutOut) << "a subnet has all of its addresses";
  EXPECT_EQ(guard.Judge(ada, "tulip", now), RconGuess::kRight);
  now += 61;
  EXPECT_EQ(guard.Judge(mallory, "tulip2", now), RconGuess::kWrong);
  EXPECT_EQ(guard.Judge(mallory, "tulip", now), RconGuess::kShutOut);
  now += 61;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(guard.Judge(mallory, "tulip", now), RconGuess::kRight) << "costs none";
}

const std::string kStatus = MakePacket(2, kValue, "scene yard, 0 in, open, tick 0\n");

// A connection to a listener whose orders a thread carries out.
class RconListenerTest : public testing::Test {
 protected:
  RconListenerTest() {
    EXPECT_TRUE(transport::vestibule::InitialiseSodium());
    m_listener = RconListener::Listen({"127.0.0.1", 0}, "tulip", m_queue, m_error);
    EXPECT_NE(m_listener, nullptr) << m_error;
    m_thread = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        m_queue.CarryOutAll({m_game.server, m_gate}, 0);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }
  static admission::GateSettings MakeSettings() {
    admission::GateSettings settings;
    settings.readUnixTime = [] { return std::uint64_t{1'800'000'000}; };
    return settings;
  }
  // -1: refused. from: the last byte of the own address.
  int Connect(std::uint8_t from = 1) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(0x7F000000U | from);
    const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(m_listener->ReadPort());
    EXPECT_EQ(connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return connection;
  }
  static void Send(int connection, const std::string& bytes) {
    static_cast<void>(send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL));
  }
  // What comes until so many bytes are there, the connection ends, or the time is over.
  static std::string Receive(int connection, std::size_t bytes, int patienceMs = 3000) {
    std::string text;
    pollfd wait{connection, POLLIN, 0};
    while (text.size() < bytes && poll(&wait, 1, patienceMs) > 0) {
      char some[4096];
      const ssize_t count = recv(connection, some, sizeof some, 0);
      if (count <= 0) break;
      text.append(some, static_cast<std::size_t>(count));
    }
    return text;
  }
  static bool HasEnded(int connection, int patienceMs) {
    pollfd wait{connection, POLLIN, 0};
    char byte;
    return poll(&wait, 1, patienceMs) > 0 && recv(connection, &byte, 1, MSG_PEEK) <= 0;
  }
  std::string AskStatus(int connection) {
    Send(connection, MakePacket(1, kAuth, "tulip") + MakePacket(2, kExecute, "status"));
    return Receive(connection, 28 + kStatus.size()).substr(28);
  }

  test::Game m_game{test::MakeYard()};
  admission::Gate m_gate{MakeSettings(), {}, {}};
  OrderQueue m_queue;
  std::string m_error;
  std::jthread m_thread;
  std::unique_ptr<RconListener> m_listener;  // ends first: an order that is under way is waited for
};

TEST_F(RconListenerTest, CarriesOutOrders) {
  const int connection = Connect();
  EXPECT_EQ(AskStatus(connection), kStatus);
  Send(connection, MakePacket(3, kExecute, "lock"));
  EXPECT_NE(Receive(connection, 20).find("locked"), std::string::npos);
  close(connection);
}

// Silent ones, and one that shows its packet byte by byte, are closed after five seconds; meanwhile others are served,
// and make room where there is none.
TEST_F(RconListenerTest, SlowAndManyKeepNobodyOut) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<int> silent;
  for (std::uint8_t i = 0; i < 16; ++i) silent.push_back(Connect(static_cast<std::uint8_t>(10 + i / 8)));
  EXPECT_FALSE(HasEnded(silent.front(), 100));
  const int ninth = Connect(10);
  EXPECT_TRUE(HasEnded(ninth, 1000)) << "an address has eight";
  const int honest = Connect(30);
  EXPECT_EQ(AskStatus(honest), kStatus);
  EXPECT_TRUE(HasEnded(silent.front(), 1000)) << "the oldest makes room";
  const std::string packet = MakePacket(1, kAuth, "tulip");
  for (std::size_t i = 0; i + 1 < packet.size() && !HasEnded(silent.back(), 400); ++i) {
    Send(silent.back(), packet.substr(i, 1));
  }
  EXPECT_TRUE(HasEnded(silent.back(), 0));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GT(seconds, 4.9);
  EXPECT_LT(seconds, 10);
  Send(honest, MakePacket(2, kExecute, "status"));
  EXPECT_EQ(Receive(honest, kStatus.size()), kStatus) << "who is in stays";
  for (const int each : silent) close(each);
  close(ninth);
  close(honest);
}

TEST_F(RconListenerTest, FloodsOfOrdersAreTakenInTurns) {
  const int flooder = Connect(40);
  std::string flood = MakePacket(1, kAuth, "tulip");
  for (int i = 0; i < 5000; ++i) flood += MakePacket(2, kExecute, "status");
  std::jthread writer([&] { Send(flooder, flood); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const int honest = Connect(41);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(AskStatus(honest), kStatus);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  close(honest);
  shutdown(flooder, SHUT_RDWR);
  close(flooder);
}

TEST_F(RconListenerTest, ThreeWrongPasswordsShutTheAddressOut) {
  const int connection = Connect();
  for (int i = 0; i < 3; ++i) Send(connection, MakePacket(1, kAuth, "rose"));
  EXPECT_EQ(Receive(connection, 42).size(), 42U);
  Send(connection, MakePacket(1, kAuth, "tulip"));
  EXPECT_EQ(Receive(connection, 14), MakePacket(-1, kAuthResponse, ""));
  EXPECT_TRUE(HasEnded(connection, 1000));
  close(connection);
}

}  // namespace
}  // namespace wobble::admin
