// A whole match as somebody sees it who listens between the players and the server: every datagram both ways. None of
// them shows a part of any message, so neither a name nor an input.
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <set>
#include <unordered_set>

#include "tests/attack/victim.h"

namespace wobble::attack {
namespace {

using transport::Channel;
using transport::ConnectionId;
using transport::Event;
using transport::SendResult;
using transport::Statistics;
using transport::Transport;

// All that is looked for: each eight bytes in a row of what was said. Shorter parts occur in random bytes, too, and
// parts of few different bytes, like 02 00 00 00 00 00 00 00, in the open heads of datagrams and in the padding of
// requests.
class Said {
 public:
  static constexpr std::size_t kSize = 8;

  void Note(std::span<const std::uint8_t> message) {
    for (std::size_t i = 0; i + kSize <= message.size(); ++i) {
      const auto part = message.subspan(i, kSize);
      if (std::set<std::uint8_t>(part.begin(), part.end()).size() >= 5) m_parts.insert(Pack(part));
    }
  }
  // How many of the parts are in the datagrams.
  [[nodiscard]] std::size_t CountIn(const std::vector<Bytes>& datagrams) const {
    std::size_t count = 0;
    for (const Bytes& datagram : datagrams) {
      const std::span<const std::uint8_t> bytes = datagram;
      for (std::size_t i = 0; i + kSize <= bytes.size(); ++i) count += m_parts.count(Pack(bytes.subspan(i, kSize)));
    }
    return count;
  }
  [[nodiscard]] std::size_t CountParts() const { return m_parts.size(); }

 private:
  static std::uint64_t Pack(std::span<const std::uint8_t> part) {
    std::uint64_t number = 0;
    for (const std::uint8_t byte : part) number = number << 8U | byte;
    return number;
  }
  std::unordered_set<std::uint64_t> m_parts;
};

// A client's transport that notes all messages both ways.
class NotingTransport final : public Transport {
 public:
  NotingTransport(std::unique_ptr<Transport> below, Said& said) : m_below(std::move(below)), m_said(said) {}
  void Poll(double now, const Sink& sink) override {
    m_below->Poll(now, [&](const Event& event) {
      if (event.kind == Event::Kind::kMessage) m_said.Note(event.bytes);
      sink(event);
    });
  }
  SendResult Send(ConnectionId connection, Channel channel, std::span<const std::uint8_t> message) override {
    m_said.Note(message);
    return m_below->Send(connection, channel, message);
  }
  void Disconnect(ConnectionId connection) override { m_below->Disconnect(connection); }
  void Flush() override { m_below->Flush(); }
  [[nodiscard]] Statistics ReadStatistics() const override { return m_below->ReadStatistics(); }

 private:
  std::unique_ptr<Transport> m_below;
  Said& m_said;
};

// The place on the way where one listens: passes everything on and keeps a copy.
class Tap {
 public:
  explicit Tap(std::uint16_t server) : m_server(server) {}
  [[nodiscard]] std::uint16_t Port() const { return m_near.Port(); }
  void PassOn(std::vector<Bytes>& capture) {
    Bytes bytes;
    std::uint16_t from = 0;
    while (m_near.Receive(bytes, from)) {
      m_client = from;
      m_far.SendTo(m_server, bytes);
      capture.push_back(bytes);
    }
    while (m_far.Receive(bytes, from)) {
      m_near.SendTo(m_client, bytes);
      capture.push_back(bytes);
    }
  }

 private:
  test::UdpSocket m_near, m_far;
  std::uint16_t m_server;
  std::uint16_t m_client = 0;
};

TEST(CaptureTest, AWholeMatchShowsNoNameAndNoInput) {
  constexpr std::size_t kPlayers = 4;
  constexpr double kSpan = 3;  // s
  Victim victim({}, "arena");
  Said said;
  std::deque<Tap> taps;
  std::vector<std::unique_ptr<client::Client>> clients;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kPlayers; ++i) {
    taps.emplace_back(victim.port);
    names.push_back("Hildegard the " + std::to_string(i));
    std::string error;
    auto transport = transport::EnetTransport::Connect("127.0.0.1", taps.back().Port(), error);
    ASSERT_NE(transport, nullptr) << error;
    clients.push_back(std::make_unique<client::Client>(std::make_unique<NotingTransport>(std::move(transport), said),
                                                       client::Options{.name = names.back()}, Now()));
  }
  std::vector<Bytes> capture;
  const double begin = Now();
  for (double time = 0; time < kSpan; time = Now() - begin) {
    for (std::size_t i = 0; i < kPlayers; ++i) {
      const double turn = 2 * time + static_cast<double>(i);
      clients[i]->SetInput({.moveX = static_cast<float>(std::cos(turn)),
                            .moveY = static_cast<float>(std::sin(turn)),
                            .jump = static_cast<int>(turn) % 2 == 0});
      clients[i]->Update(Now());
      taps[i].PassOn(capture);
    }
    Sleep(0.002);
  }
  std::size_t bytes = 0;
  for (const Bytes& datagram : capture) bytes += datagram.size();
  for (const auto& client : clients) EXPECT_EQ(client->ReadState(), client::State::kPlaying) << client->EndReason();
  std::printf("  %zu datagrams, %zu bytes; %zu parts looked for\n", capture.size(), bytes, said.CountParts());
  EXPECT_GT(capture.size(), 500U);
  EXPECT_GT(said.CountParts(), 10'000U);

  EXPECT_EQ(said.CountIn(capture), 0U);
  for (const std::string& name : names) {
    const auto shows = [&](const Bytes& datagram) {
      return std::search(datagram.begin(), datagram.end(), name.begin(), name.end()) != datagram.end();
    };
    EXPECT_TRUE(std::none_of(capture.begin(), capture.end(), shows)) << name;
    // What is looked for would be found: each client has sent its name in its hello.
    EXPECT_GT(said.CountIn({Bytes(name.begin(), name.end())}), 0U) << name;
  }
}

}  // namespace
}  // namespace wobble::attack
