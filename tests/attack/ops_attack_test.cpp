// Slow and many connections to the endpoint of --ops, which other addresses must not notice.
//
// Measured on the endpoint before: a kilobyte a second on two sockets, and /healthz did not answer for 18 s.
#include <gtest/gtest.h>

#include <poll.h>

#include <atomic>
#include <cmath>

#include "tests/attack/victim.h"

namespace wobble::attack {
namespace {

// A TCP connection from an address of this machine's loopback.
class Line {
 public:
  Line(const std::string& from, std::uint16_t port) : m_descriptor(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in own{}, server{};
    own.sin_family = server.sin_family = AF_INET;
    inet_pton(AF_INET, from.c_str(), &own.sin_addr);
    server.sin_port = htons(port);
    inet_pton(AF_INET, "127.0.0.1", &server.sin_addr);
    EXPECT_EQ(bind(m_descriptor, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    EXPECT_EQ(connect(m_descriptor, reinterpret_cast<const sockaddr*>(&server), sizeof server), 0);
  }
  ~Line() { close(m_descriptor); }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  void Send(const std::string& text) {
    static_cast<void>(send(m_descriptor, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT));
  }
  // All that comes until the far end closes, or for so many seconds.
  std::string ReadAll(double seconds) {
    std::string text;
    char bytes[4096];
    for (const double end = Now() + seconds; Now() < end;) {
      pollfd wait{m_descriptor, POLLIN, 0};
      if (poll(&wait, 1, static_cast<int>(1000 * (end - Now())) + 1) <= 0) break;
      const ssize_t count = recv(m_descriptor, bytes, sizeof bytes, 0);
      if (count <= 0) break;
      text.append(bytes, static_cast<std::size_t>(count));
    }
    return text;
  }
  // Whether the far end has closed it, and sent nothing before.
  bool IsClosed() {
    char byte;
    const ssize_t count = recv(m_descriptor, &byte, 1, MSG_DONTWAIT | MSG_PEEK);
    return count == 0 || (count < 0 && errno != EAGAIN);
  }

 private:
  int m_descriptor;
};

// Seconds of each of `count` checks of health, ascending.
std::vector<double> MeasureHealth(std::uint16_t port, int count) {
  std::vector<double> seconds;
  for (int i = 0; i < count; ++i) {
    const double begin = Now();
    Line line("127.0.0.1", port);
    line.Send("GET /healthz HTTP/1.1\r\nHost: here\r\n\r\n");
    EXPECT_NE(line.ReadAll(5).find("200 OK"), std::string::npos);
    seconds.push_back(Now() - begin);
    Sleep(0.01);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds;
}

TEST(OpsAttackTest, SlowAndManyConnectionsHoldUpNobodyElse) {
  Victim victim({"--ops", "0"});
  ASSERT_NE(victim.opsPort, 0);
  const std::size_t before = victim.CountDescriptors();
  std::atomic<std::size_t> opened = 0, putOut = 0;
  std::jthread attack([&](const std::stop_token& stop) {
    // 20 addresses, each with as many sockets as it is allowed and more; a few bytes a second on each.
    std::vector<std::unique_ptr<Line>> lines;
    const std::string request = "GET /metrics HTTP/1.1\r\nX-Slow: " + std::string(2000, 'a');
    for (std::size_t turn = 0; !stop.stop_requested(); ++turn) {
      if (lines.size() < 200) {
        lines.push_back(std::make_unique<Line>("127.0.0." + std::to_string(2 + turn % 20), victim.opsPort));
        ++opened;
      }
      for (auto& each : lines) each->Send(request.substr(turn % request.size(), 1));
      putOut += std::erase_if(lines, [](const auto& each) { return each->IsClosed(); });
      Sleep(0.005);
    }
  });
  Sleep(1);
  const std::vector<double> seconds = MeasureHealth(victim.opsPort, 120);
  const double p99 = seconds[static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(seconds.size()))) - 1];
  attack.request_stop();
  attack.join();
  std::printf("  %zu slow connections, %zu of them put out; /healthz p50 %.1f ms, p99 %.1f ms\n", opened.load(),
              putOut.load(), 1000 * seconds[seconds.size() / 2], 1000 * p99);
  EXPECT_GT(opened, 150U);
  EXPECT_LT(p99, 0.1);
  EXPECT_LE(victim.CountDescriptors(), before + 64);
  for (const double end = Now() + 3; victim.CountDescriptors() > before && Now() < end;) Sleep(0.05);
  EXPECT_EQ(victim.CountDescriptors(), before) << "nothing is left of it";
}

TEST(OpsAttackTest, ARequestHasTwoSecondsHoweverSlowlyItComes) {
  Victim victim({"--ops", "0"});
  Line silent("127.0.0.2", victim.opsPort), slow("127.0.0.3", victim.opsPort);
  const double begin = Now();
  slow.Send("GET /healthz HTTP/1.1\r\nX: ");
  while (!(silent.IsClosed() && slow.IsClosed()) && Now() < begin + 6) {
    slow.Send("a");
    Sleep(0.05);
  }
  EXPECT_GT(Now() - begin, 1.5);
  EXPECT_LT(Now() - begin, 3);
  for (const char* nonsense :
       {"\r\n\r\n\r\n", "GET", "\x16\x03\x01\x02", "POST / HTTP/1.1\r\nContent-Length: 99999999\r\n\r\n"}) {
    Line line("127.0.0.1", victim.opsPort);
    line.Send(nonsense);
    line.Send("\r\n\r\n");
    EXPECT_EQ(line.ReadAll(3).find("200 OK"), std::string::npos) << nonsense;
  }
  Line large("127.0.0.1", victim.opsPort);
  large.Send("GET / HTTP/1.1\r\nX: " + std::string(10000, 'a') + "\r\n\r\n");
  EXPECT_NE(large.ReadAll(3).find("431"), std::string::npos);
  EXPECT_EQ(MeasureHealth(victim.opsPort, 1).size(), 1U);
}

}  // namespace
}  // namespace wobble::attack
