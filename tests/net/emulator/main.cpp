// Runs a server and a client with a bad line between them, for real: each in a network namespace of its own, UDP and
// TCP of this system, every IP packet through the conditions of a link.
//
//   emulator 'loss=2%,delay=30ms' --server 'wobbled --port 4000' --client 'wobble watch 10.77.0.1:4000'
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "tests/net/emulator/download.h"
#include "tests/net/emulator/line.h"
#include "tests/net/emulator/side.h"

namespace wobble::emulator {
namespace {

constexpr const char* kServerAddress = "10.77.0.1";
constexpr const char* kClientAddress = "10.77.0.2";
constexpr int kNotPermitted = 77;  // what automake's and meson's tests call skipped

std::atomic<bool> g_isInterrupted = false;

struct Call {
  std::string line;
  std::string server, client;
  std::string congestion;
  std::uint64_t seed = 1;
  double limit = 120;  // s
  bool downloads = false;
};

void End(pid_t group) {
  kill(-group, SIGTERM);
  for (int i = 0; i < 40; ++i) {
    if (waitpid(group, nullptr, WNOHANG) == group) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  kill(-group, SIGKILL);
  waitpid(group, nullptr, 0);
}

// The client's exit code; 124: it took longer than the limit, 130: interrupted.
int AwaitClient(pid_t client, double limit) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
  for (int status = 0;;) {
    if (waitpid(client, &status, WNOHANG) == client)
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    const bool isLate = std::chrono::steady_clock::now() > end;
    if (isLate || g_isInterrupted) return End(client), isLate ? 124 : 130;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

int Run(const Call& call) {
  std::string error;
  const auto spec = transport::ParseLinkSpec(call.line, error);
  if (!spec) return std::fprintf(stderr, "LINE: %s\n", error.c_str()), 2;
  const auto server = Side::Open({.address = kServerAddress, .congestion = call.congestion}, error);
  const auto client =
      server == nullptr ? nullptr : Side::Open({.address = kClientAddress, .congestion = call.congestion}, error);
  if (client == nullptr) return std::fprintf(stderr, "not permitted here: %s\n", error.c_str()), kNotPermitted;

  std::atomic<bool> isOver = false;
  Line line(*spec, call.seed, server->Device(), client->Device());
  std::thread carrier([&] { line.Run(isOver); });
  const auto download = call.downloads ? std::make_unique<Download>(*server, *client, kServerAddress) : nullptr;
  // Standard output is the client's.
  const pid_t serverProcess = server->Start("exec >&2; " + call.server);
  const pid_t clientProcess = client->Start(call.client);
  const int code = AwaitClient(clientProcess, call.limit);
  End(serverProcess);
  if (download != nullptr) {
    std::fprintf(stderr, "download: %.0f kbit/s\n", 1e-3 * download->End());
  }
  isOver = true;
  carrier.join();
  for (const auto& [name, counts] : {std::pair{"up", line.CountUp()}, std::pair{"down", line.CountDown()}}) {
    std::fprintf(stderr, "%s: %llu packets, %llu bytes, %llu lost\n", name,
                 static_cast<unsigned long long>(counts.passed), static_cast<unsigned long long>(counts.bytes),
                 static_cast<unsigned long long>(counts.lost));
  }
  return code;
}

}  // namespace
}  // namespace wobble::emulator

int main(int argc, char** argv) {
  wobble::emulator::Call call;
  CLI::App app(
      "Runs a server and a client with a bad line between them. Exits as the client does; 77 where the system "
      "does not permit network namespaces or TUN devices.");
  app.add_option("LINE", call.line, "conditions, as of wobble link")->required();
  app.add_option("--server", call.server, "command of the server's end, at 10.77.0.1")->required();
  app.add_option("--client", call.client, "command of the client's end, at 10.77.0.2")->required();
  app.add_option("--congestion", call.congestion, "TCP's congestion control: cubic, bbr, ...");
  app.add_option("--seed", call.seed, "of the line's draws");
  app.add_option("--limit", call.limit, "seconds after which the client is ended")->check(CLI::Range(1.0, 3600.0));
  app.add_flag("--download", call.downloads, "a TCP download of the client's end beside it, as fast as it goes");
  CLI11_PARSE(app, argc, argv);
  struct sigaction action {};
  action.sa_handler = [](int) { wobble::emulator::g_isInterrupted = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return wobble::emulator::Run(call);
}
