// One player who destroys what all have: what the administration can do about it, with the real programs.
//
// Measured before there were roles: all 196 springs of `sandbox` were gone in 9 s, and nobody could stop it.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "tests/attack/victim.h"
#include "tests/support/places.h"

namespace wobble::attack {
namespace {

class VandalAttackTest : public testing::Test {
 protected:
  // Gives an order with the shipped program; its exit code, and its output in `output`.
  int Order(const std::string& words) {
    output.clear();
    FILE* program =
        popen((test::FindProgram("wobble admin --socket ") + m_socket + " " + words + " 2>&1").c_str(), "r");
    std::array<char, 512> line{};
    while (fgets(line.data(), line.size(), program) != nullptr) output += line.data();
    return WEXITSTATUS(pclose(program));
  }
  std::unique_ptr<client::Client> Connect() {
    std::string error;
    auto transport = transport::EnetTransport::Connect("127.0.0.1", victim.port, error);
    EXPECT_NE(transport, nullptr) << error;
    return std::make_unique<client::Client>(std::move(transport), client::Options{.name = "vandal"}, Now());
  }
  // Updates the client for so many seconds. isCutting: strokes across everything, as fast as the server hears them.
  void Play(client::Client& client, double seconds, bool isCutting) {
    double next = 0;
    for (const double end = Now() + seconds; Now() < end; Sleep(0.005)) {
      client.Update(Now());
      const bool isDue = isCutting && client.ReadState() == client::State::kPlaying && Now() >= next;
      if (!isDue) continue;
      next = Now() + 0.05;
      m_stroke = m_stroke >= 3.5F ? -4.5F : m_stroke + 0.1F;
      client.Cut(client.Welcome().workshop, {m_stroke, -5, 1}, {m_stroke, 0, 0}, {m_stroke, 0, 3.5F});
    }
  }
  std::size_t CountSprings(client::Client& client) {
    std::vector<client::BodySample> samples;
    client.Sample(Now(), client::Detail::kVertices, samples);
    for (const auto& sample : samples) {
      if (sample.body == client.Welcome().workshop) return sample.blueprint->springs.size();
    }
    return 0;
  }

  void TearDown() override { std::filesystem::remove(m_socket); }  // a server that is killed leaves it

  std::string m_socket = testing::TempDir() + "wobble-vandal-" + std::to_string(getpid());
  Victim victim{{"--admin-socket", m_socket}, "sandbox"};
  std::string output;
  float m_stroke = -4.5F;
};

TEST_F(VandalAttackTest, ModeratorsProtectRestoreAndPutOut) {
  auto vandal = Connect();
  auto friendly = Connect();
  Play(*vandal, 0.3, false);  // it is client 1
  Play(*friendly, 0.5, false);
  const std::size_t all = CountSprings(*friendly);
  Play(*vandal, 2, true);
  Play(*friendly, 0.5, false);
  const std::size_t left = CountSprings(*friendly);
  ASSERT_EQ(Order("protect on"), 0) << output;
  ASSERT_EQ(Order("reset"), 0) << output;
  Play(*vandal, 1.5, true);
  Play(*friendly, 0.5, false);
  const std::size_t whole = CountSprings(*friendly);
  EXPECT_LT(left + 20, all) << "the vandal cuts, or this test shows nothing";
  EXPECT_EQ(whole, all);

  ASSERT_EQ(Order("lock"), 0) << output;
  ASSERT_EQ(Order("kick 1 not so rough"), 0) << output;
  Play(*vandal, 0.3, false);
  EXPECT_NE(vandal->EndReason().find("not so rough"), std::string::npos) << vandal->EndReason();
  auto again = Connect();
  Play(*again, 0.5, false);
  EXPECT_NE(again->EndReason().find("lets nobody in"), std::string::npos) << again->EndReason();
  ASSERT_EQ(Order("ban 127.0.0.1 for 1m"), 0) << output;
  auto banned = Connect();
  Play(*banned, 0.5, false);
  EXPECT_NE(banned->EndReason().find("banned"), std::string::npos) << banned->EndReason();
  EXPECT_EQ(Order("kick 1"), 1) << "a refusal is an exit code";
  EXPECT_TRUE(victim.IsAlive());
}

}  // namespace
}  // namespace wobble::attack
