// The server of --ops against those who are slow or many, over real sockets, by a clock that the test sets.
#include "server/ops/http_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>

namespace wobble::ops {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr int kPatienceMs = 5000;

// A connection from an address of this machine's loopback.
class Caller {
 public:
  Caller(std::uint16_t port, const std::string& from) : m_socket(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    inet_pton(AF_INET, from.c_str(), &address.sin_addr);
    EXPECT_EQ(bind(m_socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
    address.sin_port = htons(port);
    EXPECT_EQ(connect(m_socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  Caller(Caller&& other) noexcept : m_socket(std::exchange(other.m_socket, -1)) {}
  ~Caller() {
    if (m_socket >= 0) close(m_socket);
  }
  // False when the other end has closed.
  bool Say(const std::string& words) const {
    return send(m_socket, words.data(), words.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(words.size());
  }
  // What comes until the other end closes; "open" when it does not within the time.
  [[nodiscard]] std::string Hear(int patienceMs = kPatienceMs) const {
    std::string heard;
    char bytes[4096];
    for (pollfd waiting{m_socket, POLLIN, 0}; poll(&waiting, 1, patienceMs) > 0;) {
      const ssize_t size = recv(m_socket, bytes, sizeof bytes, 0);
      if (size <= 0) return heard;
      heard.append(bytes, static_cast<std::size_t>(size));
    }
    return "open";
  }
  [[nodiscard]] bool IsOpen() const { return Hear(100) == "open"; }

 private:
  int m_socket;
};

class HttpServerTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    server = HttpServer::Listen(
        "127.0.0.1", 0,
        [](std::string_view path) {
          return Answer{200, "you ask for " + std::string(path)};
        },
        [this] { return now.load(); }, error);
    ASSERT_NE(server, nullptr) << error;
  }
  [[nodiscard]] Caller Call(const std::string& from = "127.0.0.1") const { return {server->ReadPort(), from}; }
  [[nodiscard]] std::string Ask(const std::string& words) const {
    const Caller caller = Call();
    caller.Say(words);
    return caller.Hear();
  }

  std::atomic<double> now = 100;
  std::unique_ptr<HttpServer> server;
};

TEST_F(HttpServerTest, AnswersAndCloses) {
  const std::string answer = Ask("GET /a?b HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("\r\nContent-Length: 14\r\n"));
  EXPECT_THAT(answer, testing::EndsWith("\r\nConnection: close\r\n\r\nyou ask for /a"));
  const std::string head = Ask("HEAD /a HTTP/1.0\r\n\r\n");
  EXPECT_THAT(head, HasSubstr("\r\nContent-Length: 14\r\n"));
  EXPECT_THAT(head, testing::EndsWith("\r\n\r\n"));
}

TEST_F(HttpServerTest, RefusesWhatIsNoRequest) {
  for (const char* bad : {"\r\n\r\n", "hello\r\n\r\n", "GET /\r\n\r\n", "GET  HTTP/1.1\r\n\r\n",
                          "GET x HTTP/1.1\r\n\r\n", "GET / FTP/1.1\r\n\r\n", " / HTTP/9.9\r\n\r\n"}) {
    EXPECT_THAT(Ask(bad), StartsWith("HTTP/1.1 400 ")) << bad;
  }
  const std::string posted = Ask("POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\nhello");
  EXPECT_THAT(posted, StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(posted, HasSubstr("\r\nAllow: GET, HEAD\r\n"));
  const std::string most(kMostRequestBytes, 'x');
  EXPECT_THAT(Ask("GET /" + most), StartsWith("HTTP/1.1 431 "));
  EXPECT_THAT(Ask("GET /" + most + " HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 431 "));
}

TEST_F(HttpServerTest, TakesARequestInPieces) {
  const Caller caller = Call();
  for (const char letter : std::string("GET /x HTTP/1.1\r\nA: b\r\n\r\n")) caller.Say(std::string(1, letter));
  EXPECT_THAT(caller.Hear(), testing::EndsWith("you ask for /x"));
}

TEST_F(HttpServerTest, ARequestHasOneDeadlineHoweverItDrips) {
  const Caller caller = Call();
  for (; now < 100 + kRequestTime - 0.3; now = now + 0.25) {
    caller.Say("x");
    EXPECT_TRUE(caller.IsOpen()) << now;
  }
  caller.Say("x");
  now = 100 + kRequestTime;
  EXPECT_EQ(caller.Hear(), "");
}

TEST_F(HttpServerTest, WhoDoesNotCloseIsClosed) {
  const Caller caller = Call();
  caller.Say("GET / HTTP/1.1\r\n\r\n");
  EXPECT_THAT(caller.Hear(), HasSubstr("you ask for /"));
  // Until then what it says is dropped, and after that answered with a reset.
  EXPECT_TRUE(caller.Say("x"));
  now = 100 + kLingerTime;
  bool isOpen = true;
  for (int i = 0; i < 100 && isOpen; ++i) {
    isOpen = caller.Say("x");
    usleep(20'000);
  }
  EXPECT_FALSE(isOpen);
}

TEST_F(HttpServerTest, AnAddressWithItsShareMakesRoomItself) {
  const Caller other = Call("127.0.0.3");
  std::vector<Caller> callers;
  for (std::size_t i = 0; i < kMostOfAnAddress + 3; ++i) callers.push_back(Call("127.0.0.2"));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(callers[i].Hear(), "") << i;
  EXPECT_TRUE(callers[3].IsOpen());
  EXPECT_TRUE(callers.back().IsOpen());
  other.Say("GET / HTTP/1.1\r\n\r\n");
  EXPECT_THAT(other.Hear(), HasSubstr("you ask for /"));
}

TEST_F(HttpServerTest, WhoHasBeenThereLongestMakesRoom) {
  std::vector<Caller> callers;
  for (std::size_t i = 0; i < kMostConnections + 2; ++i) callers.push_back(Call("127.0.1." + std::to_string(i + 1)));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(callers[i].Hear(), "") << i;
  EXPECT_TRUE(callers[2].IsOpen());
  EXPECT_TRUE(callers.back().IsOpen());
  EXPECT_THAT(Ask("GET / HTTP/1.1\r\n\r\n"), HasSubstr("you ask for /"));
}

}  // namespace
}  // namespace wobble::ops
