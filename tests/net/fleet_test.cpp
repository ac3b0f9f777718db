// A server under a manager, Agones or systemd: wobbled, bots and gateway as processes, with a sidecar that behaves as
// Agones; and what the files of docker/agones must say.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <sstream>

#include "tests/support/notice_socket.h"
#include "tests/support/places.h"
#include "tests/support/sidecar.h"

extern char** environ;  // NOLINT: POSIX names it so

namespace wobble::test {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience{60};

class Process {
 public:
  explicit Process(std::vector<std::string> words) {
    if (words[0] != "sh") words[0] = FindProgram(words[0]);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    int output[2];
    EXPECT_EQ(pipe2(output, O_CLOEXEC), 0);
    m_output = output[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, output[1], STDOUT_FILENO);
    EXPECT_EQ(posix_spawnp(&m_pid, words[0].c_str(), &actions, nullptr, pointers.data(), environ), 0);
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
  sidecar.WaitUntil([](const AgonesModel& record) { return record.state == "Ready"; });
  Process bots({"wobble", "bots", address, "--script", FindProgram("scripts/idle.lua"), "--count", "2"});
  sidecar.WaitUntil([](const AgonesModel& record) {
    return record.state == "Allocated" && record.count == 2 && record.values.size() == 2;
  });
  bots.Signal(SIGINT);
  EXPECT_EQ(bots.Wait(), 0);
  sidecar.WaitUntil([](const AgonesModel& record) { return record.count == 0 && record.values.empty(); });
  const auto asked = Clock::now();
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
  EXPECT_LT(Clock::now() - asked, std::chrono::seconds(5));
  unsetenv("AGONES_SDK_HTTP_PORT");

  const AgonesModel record = sidecar.WaitUntil([](const AgonesModel& each) { return each.state == "Shutdown"; });
  EXPECT_EQ(std::ranges::count(record.requests, "POST /allocate {}"), 1);
  EXPECT_GE(std::ranges::count(record.requests, "POST /health {}"), 1);
}

// The sidecar crashes while three players are there, and has lost that they were.
TEST(Fleet, ARestartedSidecarHearsOfThePlayersAgain) {
  auto sidecar = std::make_unique<Sidecar>();
  const std::uint16_t port = sidecar->Port();
  setenv("AGONES_SDK_HTTP_PORT", std::to_string(port).c_str(), 1);
  Process server = StartServer();
  Process bots({"wobble", "bots", AwaitAddress(server), "--script", FindProgram("scripts/idle.lua"), "--count", "3"});
  const auto hasThree = [](const AgonesModel& record) {
    return record.state == "Allocated" && record.count == 3 && record.values.size() == 3;
  };
  AgonesModel record = sidecar->WaitUntil(hasThree);
  sidecar.reset();
  record.state = "Ready";
  record.count = 1;
  record.values = {"player-77"};
  record.Crash();
  Sidecar next(port, record);
  next.WaitUntil(hasThree);
  unsetenv("AGONES_SDK_HTTP_PORT");
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

// As under systemd with Type=notify and WatchdogSec=.
TEST(Service, IsReadyWhenItListensAndAliveAsLongAsItsLoopTurns) {
  const NoticeSocket manager(std::filesystem::temp_directory_path() / ("manager" + std::to_string(getpid())));
  setenv("NOTIFY_SOCKET", manager.Name().c_str(), 1);
  setenv("WATCHDOG_USEC", "200000", 1);
  Process server = StartServer();
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
  const int patienceMs = 60000;
  EXPECT_EQ(manager.Receive(patienceMs), "READY=1");
  AwaitAddress(server);
  for (int sign = 0; sign < 3; ++sign) EXPECT_EQ(manager.Receive(patienceMs), "WATCHDOG=1");
  server.Signal(SIGTERM);
  std::string last = manager.Receive(patienceMs);
  while (last == "WATCHDOG=1") last = manager.Receive(patienceMs);
  EXPECT_EQ(last, "STOPPING=1");
  EXPECT_EQ(server.Wait(), 0);
}

TEST(Service, LogsAsJsonWhereTheEnvironmentSaysSo) {
  Process server({"sh", "-c",
                  "WOBBLE_LOG_FORMAT=json exec " + FindProgram("wobbled") +
                      " --untrained --port 0 --status 0 --for 0.1 --key " + FindBases() +
                      "/server.key 2>&1 >/dev/null"});
  int lines = 0;
  for (std::string line = server.ReadLine(); !line.empty(); line = server.ReadLine(), ++lines) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(json.is_object()) << line;
    EXPECT_TRUE(json.contains("time") && json.contains("level") && json.contains("message")) << line;
  }
  EXPECT_GE(lines, 1) << "its key at least";
  EXPECT_EQ(server.Wait(), 0);
}

// In a pod the sidecar has port 8080. Where another program of this machine has it, the gateway says the same.
TEST(Fleet, AGatewayOnTheSidecarsPortSaysWhoMayHaveIt) {
  httplib::Server sidecar;
  sidecar.bind_to_port("127.0.0.1", 8080);
  const std::filesystem::path page = std::filesystem::temp_directory_path() / ("fleet" + std::to_string(getpid()));
  std::filesystem::create_directory(page);
  std::ofstream(page / "index.html") << "a page";
  Process gateway(
      {"sh", "-c",
       FindProgram("wobble") + " gateway --server 127.0.0.1:1 --http 8080 --page " + page.string() + " 2>&1"});
  EXPECT_EQ(
      gateway.ReadLine(),
      "wobble gateway: port 8080 (TCP) is in use; --http has another (Agones' sidecar has this port in every pod)");
  EXPECT_EQ(gateway.Wait(), 2);
  std::filesystem::remove_all(page);
}

std::string ReadSource(const std::string& path) {
  std::ifstream file(FindSource(path));
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str(), "") << path;
  return text.str();
}

TEST(Fleet, ItsPodsPortsAreNotTheSidecars) {
  const std::string fleet = ReadSource("docker/agones/fleet.yaml");
  std::smatch gateway;
  ASSERT_TRUE(std::regex_search(fleet, gateway, std::regex("\"--http\", \"([0-9]+)\"|--http, \"([0-9]+)\"")));
  const std::string port = gateway[1].matched ? gateway[1] : gateway[2];
  EXPECT_THAT(fleet, HasSubstr("container: gateway, portPolicy: Dynamic, containerPort: " + port + ","));
  for (const char* taken : {"8080", "9357", "9358"}) {  // health, gRPC, HTTP
    EXPECT_FALSE(std::regex_search(fleet, std::regex(std::string("[pP]ort: ") + taken))) << taken;
    EXPECT_NE(port, taken);
  }
}

// The local sidecar reads the counters of the status alone.
TEST(Fleet, TheLocalGameServerHasItsCountersUnderStatus) {
  const std::string file = ReadSource("docker/agones/gameserver.yaml");
  const std::string status = file.substr(std::min(file.size(), file.find("\nstatus:\n")));
  EXPECT_THAT(status, HasSubstr("\n  counters:\n    players: {"));
  EXPECT_THAT(status, HasSubstr("\n  lists:\n    players: {"));
  EXPECT_EQ(file.find("counters:"), file.rfind("counters:"));
}

}  // namespace
}  // namespace wobble::test
