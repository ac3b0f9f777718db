// A server of a fleet as it runs: wobbled and bots as processes, with a sidecar that writes down what it is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>

#include "tests/support/sidecar.h"

extern char** environ;  // NOLINT: POSIX has it so

namespace wobble::test {
namespace {

using testing::ElementsAre;
using testing::IsSupersetOf;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{60};

class Process {
 public:
  explicit Process(std::vector<std::string> words) {
    words[0] = WOBBLE_BIN_DIR "/" + words[0];
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&m_pid, words[0].c_str(), nullptr, nullptr, pointers.data(), environ), 0);
  }
  ~Process() {
    if (m_pid == 0) return;
    kill(m_pid, SIGKILL);
    waitpid(m_pid, nullptr, 0);
  }
  void Signal(int signal) const { kill(m_pid, signal); }
  // Its exit code; -1 when it did not end in time, or not by itself.
  int Wait(std::chrono::milliseconds patience = kPatience) {
    int status = 0;
    for (const auto end = Clock::now() + patience; Clock::now() < end;) {
      if (waitpid(m_pid, &status, WNOHANG) == m_pid) {
        m_pid = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return -1;
  }

 private:
  pid_t m_pid = 0;
};

// Without health, which comes whenever it is time.
std::vector<std::string> WaitForCall(Sidecar& sidecar, const std::string& call) {
  std::vector<std::string> calls;
  for (const auto end = Clock::now() + kPatience; Clock::now() < end;) {
    calls = sidecar.WaitFor(0);
    std::erase(calls, "POST /health {}");
    if (std::ranges::count(calls, call) > 0) return calls;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ADD_FAILURE() << "no " << call;
  return calls;
}

Process StartServer(const std::string& port) {
  return Process(
      {"wobbled", "--untrained", "--admit-when-busy", "--port", port, "--log-level", "warn", "--status", "0"});
}

TEST(Fleet, AServersLifeAsAgonesHearsOfIt) {
  Sidecar sidecar;
  setenv("AGONES_SDK_HTTP_PORT", std::to_string(sidecar.Port()).c_str(), 1);
  Process server = StartServer("7841");
  EXPECT_THAT(WaitForCall(sidecar, "POST /ready {}"), ElementsAre("POST /ready {}"));
  Process bots({"wobble", "bots", "127.0.0.1:7841", "--script", WOBBLE_BIN_DIR "/scripts/idle.lua", "--count", "2"});
  WaitForCall(sidecar, R"(POST /v1beta1/lists/players:addValue {"value":"player-2"})");
  bots.Signal(SIGINT);
  EXPECT_EQ(bots.Wait(), 0);
  WaitForCall(sidecar, R"(POST /v1beta1/lists/players:removeValue {"value":"player-2"})");
  const auto asked = Clock::now();
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
  EXPECT_LT(Clock::now() - asked, std::chrono::seconds(5));
  unsetenv("AGONES_SDK_HTTP_PORT");

  const std::vector<std::string> calls = WaitForCall(sidecar, "POST /shutdown {}");
  ASSERT_GE(calls.size(), 4U);
  EXPECT_EQ(calls[1], "POST /allocate {}");
  EXPECT_EQ(calls.back(), "POST /shutdown {}");
  EXPECT_EQ(std::ranges::count(calls, R"(PATCH /v1beta1/counters/players {"countDiff":"1"})"), 2);
  EXPECT_EQ(std::ranges::count(calls, R"(PATCH /v1beta1/counters/players {"countDiff":"-1"})"), 2);
  EXPECT_GE(std::ranges::count(sidecar.WaitFor(0), "POST /health {}"), 1);
}

// With somebody playing: he is told, and nothing takes longer.
TEST(Fleet, ADeadSidecarStopsNothing) {
  setenv("AGONES_SDK_HTTP_PORT", "1", 1);  // where nobody listens
  Process server = StartServer("7842");
  // Nobody says when the server listens: bots whom none answers end with 2.
  int result = 2;
  for (const auto end = Clock::now() + kPatience; result == 2 && Clock::now() < end;) {
    Process bots({"wobble", "bots", "127.0.0.1:7842", "--script", WOBBLE_BIN_DIR "/scripts/wander.lua", "--count", "4",
                  "--for", "5", "--threshold", "disconnects==0"});
    result = bots.Wait();
  }
  EXPECT_EQ(result, 0);
  const auto asked = Clock::now();
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
  EXPECT_LT(Clock::now() - asked, std::chrono::seconds(5));
  unsetenv("AGONES_SDK_HTTP_PORT");
}

}  // namespace
}  // namespace wobble::test
