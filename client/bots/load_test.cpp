// The only loop with a clock. It runs sixty rounds a second for each bot on an absolute schedule, so that the bots'
// pace does not drift with the cost of a round. A late round counts as late in full, and the rounds missed meanwhile
// are skipped: catching up would send bursts of inputs that no player sends.
//
// The bots are spread in parts over each sixtieth of a second, as players are. If all were served at once, the age of
// snapshots would depend on where in the server's tick that moment happens to fall, and differ by 16 ms between runs.
#include "client/bots/load_test.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <thread>

#include "client/bots/runner.h"
#include "client/bots/script.h"
#include "client/bots/status.h"
#include "client/command/access.h"
#include "client/command/clock.h"
#include "client/command/exit_codes.h"
#include "client/command/sockets.h"
#include "client/files/kept_folder.h"
#include "client/link/relay_loop.h"
#include "protocol/transport/enet_transport.h"

namespace wobble::bots {
namespace {

constexpr double kBotHz = 60;
// A prime, so that the decoding bots, often every 32nd, do not all fall into one part.
constexpr unsigned kParts = 5;
constexpr double kRoundHz = kBotHz * kParts;
// Longer than a client waits for the answer to its goodbye, seconds.
constexpr double kGoodbyePatience = client::kLongestLeave + 0.5;

void SleepUntil(double time) {
  const double seconds = time - command::ReadClock();
  if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void Complain(std::string_view line) {
  std::fprintf(stderr, "wobble bots: %.*s\n", static_cast<int>(line.size()), line.data());
}

// Starts a relay in front of the server, in its own thread, when the options ask for one. Returns false, with one line
// printed, when it cannot be started.
bool StartLink(const LoadTestOptions& options, std::unique_ptr<link::RelayThread>& relay) {
  if (!options.link) return true;
  transport::RelayOptions relayOptions;
  relayOptions.host = "127.0.0.1";
  relayOptions.serverHost = options.server.host;
  relayOptions.serverPort = options.server.port;
  relayOptions.link = *options.link;
  relayOptions.seed = options.seed;
  relayOptions.maxClients = kMaxBots;
  std::string error;
  auto opened = transport::Relay::Open(relayOptions, error);
  if (opened == nullptr) {
    Complain("--link: " + error);
    return false;
  }
  relay = std::make_unique<link::RelayThread>(std::move(opened));
  return true;
}

// Returns true when it was stopped from outside.
bool RunRounds(Runner& runner, const LoadTestOptions& options, Status& status, const std::function<bool()>& stopAsked) {
  const double begin = command::ReadClock();
  double due = 0;
  double now = 0;
  bool stopped = false;
  const double duration = FindDuration(options);
  while (duration <= 0 || now < duration) {
    const double late = now - due;
    runner.RunRound(now, late, kParts);
    status.Show(runner, now);
    stopped = stopAsked();
    if (stopped || runner.HaveAllEnded() || runner.IsHopeless(now) || runner.HaveAllScriptsFailed()) break;
    due += (1 + std::floor(late * kRoundHz)) / kRoundHz;
    SleepUntil(begin + due);
    now = command::ReadClock() - begin;
  }
  runner.Leave(now);
  for (const double end = now + kGoodbyePatience; now < end && !runner.HaveAllEnded();) {
    runner.RunRound(now, 0);
    SleepUntil(begin + now + 1 / kBotHz);
    now = command::ReadClock() - begin;
  }
  return stopped;
}

void Report(const Figures& figures, const std::vector<Verdict>& verdicts) {
  const auto count = [](std::uint64_t value) { return std::to_string(value); };
  const std::string joins = figures.joins > figures.connected ? " (" + count(figures.joins) + " joins)" : "";
  const std::string rejoins = figures.rejoins > 0 ? ", " + count(figures.rejoins) + " rejoins" : "";
  const std::string sentAway = figures.sentAway > 0 ? ", " + count(figures.sentAway) + " sent away" : "";
  std::printf(
      "%s of %s bots connected%s, %s disconnects%s%s, %s script errors, %s each, snapshots %s old (p50), %s (p99)\n",
      count(figures.connected).c_str(), count(figures.bots).c_str(), joins.c_str(), count(figures.disconnects).c_str(),
      rejoins.c_str(), sentAway.c_str(), count(figures.scriptErrors).c_str(),
      FormatFigure(figures.kbitPerSecondPerBot, "kbit/s").c_str(), FormatFigure(figures.snapshotAgeMsP50, "ms").c_str(),
      FormatFigure(figures.snapshotAgeMsP99, "ms").c_str());
  for (const Verdict& verdict : verdicts) {
    std::printf("threshold %s: %s, ", verdict.rule.c_str(), verdict.ok ? "holds" : "FAILED");
    if (verdict.value) {
      std::printf("it is %.10g\n", *verdict.value);
    } else {
      std::printf("it was not measured\n");
    }
  }
  std::fflush(stdout);
  if (IsValid(figures)) return;
  char line[160];
  std::snprintf(
      line, sizeof line,
      "times are not valid: this machine is too busy, the bots began 1 in 100 rounds %.1f ms late (%.0f ms is allowed)",
      *figures.lateMsP99, kMaxLateMs);
  Complain(line);
}

// Called before anything starts, so that an hour's run is not lost to a misspelt folder.
bool OpenSummary(const std::string& path, std::ofstream& file) {
  if (path.empty()) return true;
  errno = 0;
  file.open(path, std::ios::binary | std::ios::trunc);
  if (file) return true;
  Complain("--summary: '" + path + "' cannot be written: " + std::strerror(errno));
  return false;
}

int Conclude(const Runner& runner, const LoadTestOptions& options, const Figures& figures,
             const std::vector<Verdict>& verdicts, bool stopped) {
  if (figures.connected == 0 && (!stopped || runner.HasAnyFailed())) {
    const std::string address = command::Describe(options.server);
    Complain(runner.Refusal().empty() ? "no server answers at " + address
                                      : "no bot could join " + address + ": " + runner.Refusal() +
                                            command::AdviseOn(runner.Refusal(), options.server));
    return command::kExitBadUse;
  }
  if (runner.HaveAllScriptsFailed()) {
    Complain("the script failed in every bot: " + options.scriptFile);
    return command::kExitBadUse;
  }
  const bool allHold = std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) { return verdict.ok; });
  if (!allHold) return command::kExitThresholdFailed;
  if (!runner.Loss()) return command::kExitGood;
  Complain("the server at " + command::Describe(options.server) +
           " was lost, and no bot is back: " + (runner.Loss()->empty() ? "no answer" : *runner.Loss()));
  return command::kExitFailed;
}

}  // namespace

int RunLoadTest(const LoadTestOptions& options, const std::function<bool()>& stopAsked) {
  Status status(options);
  Script script(options.seed, [&status](unsigned bot, std::string_view text) {
    status.Close();
    std::fprintf(stderr, "bot %u: %.*s\n", bot, static_cast<int>(text.size()), text.data());
  });
  std::string error;
  if (!script.LoadFile(options.scriptFile, error)) {
    Complain(error);
    return command::kExitBadUse;
  }
  std::ofstream summary;
  if (!OpenSummary(options.summaryFile, summary)) return command::kExitBadUse;

  command::AllowManySockets();
  std::unique_ptr<link::RelayThread> relay;
  if (!StartLink(options, relay)) return command::kExitBadUse;
  const auto connect = [&options, &relay](std::span<const std::uint8_t> ticket,
                                          std::string& reason) -> std::unique_ptr<transport::Transport> {
    transport::ConnectOptions access = options.access;
    if (!ticket.empty()) {
      access.credential = {transport::vestibule::Credential::Kind::kToken, {ticket.begin(), ticket.end()}};
    }
    if (relay != nullptr) return transport::EnetTransport::Connect("127.0.0.1", relay->ReadPort(), reason, access);
    return transport::EnetTransport::Connect(options.server.host, options.server.port, reason, access);
  };
  Runner runner(options, script, connect, &command::ReadClock, [&status](std::string_view line) {
    status.Close();
    Complain(line);
  });
  if (options.keepsBases) {
    client::Options kept;
    files::UseKeptFolder(files::FindBasesFolder(), command::Describe(options.server), kept);
    runner.SetKept(kept);
  }
  const bool stopped = RunRounds(runner, options, status, stopAsked);
  status.Close();

  const Figures figures = runner.ReadFigures();
  const std::vector<Verdict> verdicts = JudgeThresholds(options.thresholds, figures);
  if (figures.connected > 0 || stopped) Report(figures, verdicts);
  if (relay != nullptr) std::printf("%s", link::DescribeCounts(relay->Stop(), "link ").c_str());
  const int code = Conclude(runner, options, figures, verdicts, stopped);
  if (options.summaryFile.empty()) return code;
  summary << MakeSummary(figures, verdicts);
  summary.close();
  if (summary) return code;
  Complain("--summary: '" + options.summaryFile + "' could not be written in full");
  return command::kExitBadUse;
}

}  // namespace wobble::bots
