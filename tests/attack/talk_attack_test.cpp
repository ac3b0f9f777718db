// Two players who say all that the server hears, for two seconds, on loopback: what the others are told of it, and
// what it takes of the server.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/attack/victim.h"

namespace wobble::attack {
namespace {

constexpr double kSeconds = 2;

struct Talker {
  explicit Talker(std::uint16_t port) {
    std::string error;
    auto transport = transport::EnetTransport::Connect("127.0.0.1", port, error);
    EXPECT_NE(transport, nullptr) << error;
    client = std::make_unique<client::Client>(std::move(transport), client::Options{}, Now());
    client->OnEvent(
        [this](const client::Client::Event& event) { heard += event.kind == protocol::wire::EventKind::Said ? 1 : 0; });
    client->OnNotice([this](const std::string&) { ++notices; });
    client->OnSnapshot([this](const client::SnapshotArrival&) {
      longestGap = std::max(longestGap, snapshotAt == 0 ? 0 : Now() - snapshotAt);
      snapshotAt = Now();
    });
  }
  std::unique_ptr<client::Client> client;
  int heard = 0, notices = 0;
  double snapshotAt = 0, longestGap = 0;  // s
};

TEST(TalkAttack, WhoFloodsIsMeasuredAndOthersPlayOn) {
  Victim victim;
  std::vector<std::unique_ptr<Talker>> all;
  for (int i = 0; i < 4; ++i) all.push_back(std::make_unique<Talker>(victim.port));
  const auto play = [&](double seconds, bool isFlooding) {
    double next = 0;
    for (const double end = Now() + seconds; Now() < end; Sleep(0.004)) {
      for (auto& each : all) each->client->Update(Now());
      if (!isFlooding || Now() < next) continue;
      next = Now() + 0.018;  // 55 a second: of 60 on nothing would be heard, and who goes on is sent away
      for (int i = 0; i < 2; ++i) all[static_cast<std::size_t>(i)]->client->Say(std::string(190, 'x'));
    }
  };
  play(1, false);
  for (auto& each : all) {
    ASSERT_EQ(each->client->ReadState(), client::State::kPlaying) << each->client->EndReason();
    each->longestGap = 0;
  }
  const double quiet = victim.ReadProcessor();
  play(kSeconds, false);
  const double calm = victim.ReadProcessor() - quiet;
  const double before = victim.ReadProcessor();
  play(kSeconds, true);
  const double flood = victim.ReadProcessor() - before;

  const Talker& honest = *all.back();
  std::printf(
      "[ figures  ] of about %.0f lines %d are told; processor %.2f s in %.0f s, without them %.2f s; "
      "longest time between snapshots %.0f ms\n",
      2 * kSeconds / 0.018, honest.heard, flood, kSeconds, calm, 1000 * honest.longestGap);
  EXPECT_GE(honest.heard, 8);
  EXPECT_LE(honest.heard, 2 * (4 + kSeconds + 1));
  EXPECT_LE(all[0]->notices, 4 + kSeconds) << "told when it changes";
  EXPECT_LT(flood, calm + 0.3 * kSeconds);
  EXPECT_LT(honest.longestGap, 0.3);
  EXPECT_EQ(honest.client->ReadState(), client::State::kPlaying);
  honest.client->Leave(Now());
  EXPECT_TRUE(victim.IsAlive());
}

}  // namespace
}  // namespace wobble::attack
