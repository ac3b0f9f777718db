// `wobble link`: the relay by itself. One loop; between its turns the status line and the end are handled.
#include "client/link/command.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "client/command/address.h"
#include "client/command/clock.h"
#include "client/command/sockets.h"
#include "client/link/relay_loop.h"
#include "protocol/usage/command_line.h"

namespace wobble::link {
namespace {

// Options as text, before they are checked.
struct Words {
  int port = -1;
  std::string host;
  std::string server;
  std::string conditions;
  std::uint64_t seed = 1;
  double duration = 0;
  double statusEvery = -1;
};

CLI::App* AddWords(CLI::App& app, Words& words) {
  CLI::App* subcommand = app.add_subcommand("link", "Relays UDP to a server through a simulated bad network");
  subcommand->add_option("conditions", words.conditions, "Conditions of the network; without them a perfect one")
      ->type_name("CONDITIONS");
  // CLI11's required() is not used: it would be reported even when an unknown option is the fault.
  subcommand->add_option("--listen", words.port, "UDP port that players connect to; 0: a free one")
      ->check(command::Within(0, 65535))
      ->type_name("PORT REQUIRED");
  subcommand->add_option("--bind", words.host, "IPv4 address of this machine to listen at; all of them if not given")
      ->type_name("ADDRESS");
  subcommand->add_option("--to", words.server, "The server")->type_name("HOST:PORT REQUIRED");
  subcommand->add_option("--seed", words.seed, "Seed of all random choices")->capture_default_str();
  usage::AddDuration(*subcommand, "--for", words.duration, "How long to run; 0: until Ctrl-C");
  usage::AddDuration(*subcommand, "--status", words.statusEvery, "Time between status lines, 0: none")
      ->default_str("1 on a terminal, else 0");
  subcommand->footer(
      "CONDITIONS apply to each direction, are separated by commas and are all optional:\n"
      "  loss=5%             share of datagrams that never arrive\n"
      "  delay=50ms          one way, at most 10s\n"
      "  jitter=20ms         random addition to the delay, from 0 to this\n"
      "  duplicate=1%        share that arrives twice\n"
      "  reorder=2%          share held back by 50 ms, in addition to what jitter reorders\n"
      "  rate=512kbit        of each player, with headers; the queue holds 250 ms, the rest is dropped\n"
      "  blackout=250ms/15s  nothing passes for 250 ms of every 15 s, and nothing is stored\n"
      "up.loss=5% applies only to what players send, down.rate=1mbit only to what the server sends.\n"
      "Which datagrams are affected follows from the seed, the player's number and the datagram's.\n"
      "Exit code: 0 it ran, 2 bad usage, port in use or unknown host.\n"
      "Examples:\n"
      "  wobble link --listen 7800 --to 127.0.0.1:7777 \"loss=5%,delay=50ms,jitter=20ms\"\n"
      "  wobble link --listen 7800 --to example.org:7777 \"delay=80ms,up.loss=2%,down.rate=512kbit\" --for 60\n"
      "  wobble bots 127.0.0.1:7800 --script wander.lua --count 8 --for 20      players for it");
  return subcommand;
}

// False with one line in `error`.
bool Understand(const Words& words, transport::RelayOptions& options, std::string& error) {
  if (words.port < 0 || words.server.empty()) {
    error = std::string(words.port < 0 ? "--listen PORT" : "--to HOST:PORT") + " is required (see wobble link --help)";
    return false;
  }
  const auto address = command::ParseAddress(words.server, error);
  if (!address) {
    error = "--to: " + error;
    return false;
  }
  const auto link = transport::ParseLinkSpec(words.conditions, error);
  if (!link) return false;
  options.port = static_cast<std::uint16_t>(words.port);
  if (!words.host.empty()) options.host = words.host;
  options.serverHost = address->host;
  options.serverPort = address->port;
  options.link = *link;
  options.seed = words.seed;
  return true;
}

// The status line: rewritten in place on a terminal, a line each time elsewhere.
class Status {
 public:
  Status(double every, double duration)
      : m_terminal(isatty(STDOUT_FILENO) != 0),
        m_every(every < 0 ? (m_terminal ? 1 : 0) : every),
        m_duration(duration),
        m_next(m_every) {}

  void Show(const transport::RelayCounts& counts, double now) {
    if (m_every <= 0 || now < m_next) return;
    const double seconds = now - m_shown;
    char left[32] = "";
    if (m_duration > 0) std::snprintf(left, sizeof left, ", %.0f s left", std::ceil(std::max(0.0, m_duration - now)));
    std::printf("%splayers %zu%s, up %.0f kbit/s in %.0f out, down %.0f kbit/s in %.0f out, p99 %.1f ms late%s",
                m_terminal ? "\r" : "", counts.clients, left, KbitSince(m_last.up.bytesIn, counts.up.bytesIn, seconds),
                KbitSince(m_last.up.bytesOut, counts.up.bytesOut, seconds),
                KbitSince(m_last.down.bytesIn, counts.down.bytesIn, seconds),
                KbitSince(m_last.down.bytesOut, counts.down.bytesOut, seconds), counts.lateness.FindPercentileMs(0.99),
                m_terminal ? "\033[K" : "\n");
    std::fflush(stdout);
    m_last = counts;
    m_shown = now;
    while (m_next <= now) m_next += m_every;
    m_open = m_terminal;
  }

  // Ends a line begun on the terminal; to be called before anything else is written.
  void Close() const {
    if (m_open) std::printf("\n");
  }

 private:
  static double KbitSince(std::uint64_t before, std::uint64_t after, double seconds) {
    return static_cast<double>(after - before) * 8 / 1000 / seconds;
  }

  bool m_terminal;
  double m_every;
  double m_duration;
  double m_next;
  double m_shown = 0;
  bool m_open = false;
  transport::RelayCounts m_last;
};

int Complain(const std::string& error) {
  std::fprintf(stderr, "wobble link: %s\n", error.c_str());
  return command::kExitBadUse;
}

int RunLink(const Words& words, const command::IsStopAsked& isStopAsked) {
  transport::RelayOptions options;
  std::string error;
  if (!Understand(words, options, error)) return Complain(error);
  command::AllowManySockets();
  const auto relay = transport::Relay::Open(options, error);
  if (relay == nullptr) return Complain(error);
  std::printf("relaying UDP port %d%s%s to %s%s%s\n", relay->ReadPort(), words.host.empty() ? "" : " of ",
              words.host.c_str(), words.server.c_str(), words.conditions.empty() ? "" : ", ", words.conditions.c_str());
  std::fflush(stdout);

  Status status(words.statusEvery, words.duration);
  RunRelay(*relay, [&](double now) {
    status.Show(relay->ReadCounts(), now);
    return isStopAsked() || (words.duration > 0 && now >= words.duration);
  });
  status.Close();
  std::printf("%s", DescribeCounts(relay->ReadCounts(), "").c_str());
  return command::kExitGood;
}

}  // namespace

command::Command DescribeLink(CLI::App& app) {
  const auto words = std::make_shared<Words>();
  CLI::App* subcommand = AddWords(app, *words);
  return {subcommand, [words](const command::IsStopAsked& isStopAsked) { return RunLink(*words, isStopAsked); }};
}

}  // namespace wobble::link
