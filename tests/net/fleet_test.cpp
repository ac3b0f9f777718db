// A server of a fleet in operation: wobbled and bots as processes, with a sidecar that stores its calls.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>

#include "tests/support/places.h"
#include "tests/support/sidecar.h"

extern char** environ;  // NOLINT: POSIX names it so

namespace wobble::test {
namespace {

using testing::ElementsAre;
using testing::IsSupersetOf;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{60};

class Process {
 public:
  explicit Process(std::vector<std::string> words) {
    words[0] = FindProgram(words[0]);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    int output[2];
    EXPECT_EQ(pipe2(output, O_CLOEXEC), 0);
    m_output = output[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, output[1], STDOUT_FILENO);
    EXPECT_EQ(posix_spawn(&m_pid, words[0].c_str(), &actions, nullptr, pointers.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(output[1]);
  }
  ~Process() {
    close(m_output);
    if (m_pid == 0) return;
    kill(m_pid, SIGKILL);
    waitpid(m_pid, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // Waits for the next line of standard output. Empty when the output has ended.
  [[nodiscard]] std::string ReadLine() const {
    std::string line;
    for (char byte = 0; read(m_output, &byte, 1) == 1 && byte != '\n';) line += byte;
    return line;
  }
  void Signal(int signal) const { kill(m_pid, signal); }
  // Waits for the exit code; -1 when the process did not end in time, or not by itself.
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
  int m_output = -1;  // read end of its standard output
};

// Leaves out health calls, which come at any time.
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

Process StartServer() {
  return Process({"wobbled", "--untrained", "--admit-when-busy", "--port", "0", "--log-level", "warn", "--status", "0",
                  "--key", FindBases() + "/server.key"});
}

// Waits until the server listens, and returns its address.
std::string AwaitAddress(const Process& server) {
  const std::string line = server.ReadLine();
  int port = 0;
  EXPECT_EQ(std::sscanf(line.c_str(), "listening on UDP port %d", &port), 1) << line;
  return "127.0.0.1:" + std::to_string(port);
}

TEST(Fleet, AServersLifeAsAgonesHearsOfIt) {
  Sidecar sidecar;
  setenv("AGONES_SDK_HTTP_PORT", std::to_string(sidecar.Port()).c_str(), 1);
  Process server = StartServer();
  const std::string address = AwaitAddress(server);
  EXPECT_THAT(WaitForCall(sidecar, "POST /ready {}"), ElementsAre("POST /ready {}"));
  Process bots({"wobble", "bots", address, "--script", FindProgram("scripts/idle.lua"), "--count", "2"});
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

// With a player present: the player gets a goodbye, and nothing takes longer than without a sidecar.
TEST(Fleet, ADeadSidecarStopsNothing) {
  setenv("AGONES_SDK_HTTP_PORT", "1", 1);  // no process listens there
  Process server = StartServer();
  const std::string address = AwaitAddress(server);
  Process bots({"wobble", "bots", address, "--script", FindProgram("scripts/wander.lua"), "--count", "4", "--for", "5",
                "--threshold", "disconnects==0"});
  EXPECT_EQ(bots.Wait(), 0);
  const auto asked = Clock::now();
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
  EXPECT_LT(Clock::now() - asked, std::chrono::seconds(5));
  unsetenv("AGONES_SDK_HTTP_PORT");
}

}  // namespace
}  // namespace wobble::test
