// The parts are real programs, started as children, rather than servers in this process: people see what they will run
// themselves, and the crash of one part is the crash of that part alone.
//
// The worlds are started at once: each trains for a while first. The gateway follows when every world is ready or has
// failed, so that a line that tells people to open something is true; bots follow their world. At the end bots and
// browsers say goodbye to a server that still runs. All parts get SIGINT, and are killed when they do not react; what
// they measured is read from their summary files.
#include "client/host/fleet.h"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>

#include "client/command/clock.h"
#include "client/command/exit_codes.h"
#include "client/command/sockets.h"
#include "client/host/part.h"
#include "client/host/summary.h"
#include "client/host/temporary_folder.h"
#include "protocol/transport/vestibule/key_file.h"

namespace wobble::host {
namespace {

// Seconds for a program that says goodbye and writes its summary, and for one that was not ready yet.
constexpr double kEndPatience = 5;
constexpr double kEndPatienceAtStart = 0.5;
// Seconds from when all is ready in which bots may still be on their way in.
constexpr double kJoinTime = 4;
// The children print a status line each second; so many seconds are allowed for it to arrive.
constexpr double kStatusLag = 0.1;

// The first number in a line such as "listening on UDP port 7777, scene arena".
std::uint16_t ReadPort(const std::string& line) {
  const std::size_t digits = line.find_first_of("0123456789");
  return digits == std::string::npos ? std::uint16_t{0}
                                     : static_cast<std::uint16_t>(std::strtoul(line.c_str() + digits, nullptr, 10));
}

class Fleet {
 public:
  Fleet(const Plan& plan, const std::function<bool()>& stopAsked)
      : m_plan(plan), m_stopAsked(stopAsked), m_terminal(isatty(STDOUT_FILENO) != 0) {}

  int Run();

 private:
  void MakeParts();
  void Watch();
  void StartDue();
  [[nodiscard]] bool CanStart(const Part& part) const;
  [[nodiscard]] std::vector<std::string> MakeCommand(const Part& part) const;
  void Update(double until);
  void Follow(Part& part);
  void Announce(const Part& part);
  void ShowOwnersLink();
  void ShowStatus(double left);
  void NoteFailures();
  void EndAll();
  void End(Part& part);
  int GiveUp();
  int Report();

  void Say(const std::string& line);
  void Complain(const std::string& line);
  void EndStatusLine();

  [[nodiscard]] std::string AddressOf(std::size_t world) const { return "127.0.0.1:" + std::to_string(m_ports[world]); }
  [[nodiscard]] std::filesystem::path SummaryOf(const Part& part) const {
    return m_folder.Path() / (part.name + ".json");
  }
  // The first part that could not be started at all; null: none.
  [[nodiscard]] const Part* FindFailedStart() const;
  [[nodiscard]] bool AreWorldsOver() const;
  [[nodiscard]] unsigned CountRestarts() const;

  const Plan& m_plan;
  const std::function<bool()>& m_stopAsked;
  bool m_terminal;
  bool m_statusOpen = false;
  bool m_isReady = false;  // every world and the gateway was ready, or has failed
  double m_readyAt = 0;
  std::vector<std::string> m_failures;
  TemporaryFolder m_folder;
  std::deque<Part> m_parts;            // worlds, in the order of the plan, gateway, bots
  std::vector<std::uint16_t> m_ports;  // UDP, of the worlds; 0: not known yet
  std::uint16_t m_http = 0;            // TCP, of the gateway
};

int Fleet::Run() {
  if (m_folder.Path().empty()) {
    std::fprintf(stderr, "%s: no temporary folder can be made\n", m_plan.command.c_str());
    return command::kExitFailed;
  }
  // Found before anything starts: the gateway itself is started when the worlds are ready.
  std::string error;
  if (m_plan.gateway && !command::IsFree(m_plan.gateway->bindAddress, m_plan.gateway->port, error)) {
    std::fprintf(stderr, "%s: the page's %s\n", m_plan.command.c_str(), error.c_str());
    return command::kExitBadUse;
  }
  MakeParts();
  Watch();
  EndStatusLine();
  if (FindFailedStart() != nullptr) return GiveUp();
  NoteFailures();
  EndAll();
  return Report();
}

void Fleet::MakeParts() {
  using Role = Part::Role;
  for (std::size_t world = 0; world < m_plan.worlds.size(); ++world) {
    m_ports.push_back(m_plan.worlds[world].port);
    m_parts.push_back({Role::kWorld, world, m_plan.worlds[world].title, "wobbled: ", "listening"});
  }
  if (m_plan.gateway) {
    m_http = m_plan.gateway->port;
    m_parts.push_back({Role::kGateway, 0, "gateway", "wobble gateway: ", "open http"});
  }
  for (std::size_t world = 0; world < m_plan.worlds.size(); ++world) {
    if (m_plan.worlds[world].bots == 0) continue;
    const std::string name = world == 0 ? "bots" : "bots in " + m_plan.worlds[world].name;
    m_parts.push_back({Role::kBots, world, name, "wobble bots: ", "bots "});
  }
}

void Fleet::Watch() {
  double end = INFINITY, nextStatus = INFINITY;
  const auto now = &command::ReadClock;
  while (!m_stopAsked() && now() < end && FindFailedStart() == nullptr && !AreWorldsOver()) {
    StartDue();
    Update(std::min(nextStatus, end));
    const auto isSettled = [](const Part& part) { return part.role == Part::Role::kBots || part.IsSettled(); };
    if (!m_isReady && FindFailedStart() == nullptr && std::ranges::all_of(m_parts, isSettled)) {
      m_isReady = true;
      if (!m_plan.notice.empty()) Say(m_plan.notice);
      m_readyAt = now();
      if (m_plan.duration > 0) end = m_readyAt + m_plan.duration;
      if (m_plan.statusEvery > 0) nextStatus = m_readyAt + m_plan.statusEvery + kStatusLag;
    }
    if (now() < nextStatus) continue;
    nextStatus += m_plan.statusEvery;
    ShowStatus(end - now());
  }
}

const Part* Fleet::FindFailedStart() const {
  const auto hasFailed = [this](const Part& part) {
    return part.keeper.ReadState() == Keeper::State::kGivenUp && !part.keeper.HasBeenReady() && !m_isReady;
  };
  const auto found = std::ranges::find_if(m_parts, hasFailed);
  return found == m_parts.end() ? nullptr : &*found;
}

bool Fleet::AreWorldsOver() const {
  return std::ranges::all_of(m_parts,
                             [](const Part& part) { return part.role != Part::Role::kWorld || part.IsOver(); });
}

unsigned Fleet::CountRestarts() const {
  unsigned restarts = 0;
  for (const Part& part : m_parts) restarts += part.keeper.Restarts();
  return restarts;
}

void Fleet::StartDue() {
  for (Part& part : m_parts) {
    const double now = command::ReadClock();
    if (!part.keeper.IsDue(now) || !CanStart(part)) continue;
    const std::string error = StartPart(part, MakeCommand(part), now);
    if (!error.empty()) Complain(part.name + ": " + error);
  }
}

bool Fleet::CanStart(const Part& part) const {
  const auto isSettled = [this](const Part& other) {
    return other.role != Part::Role::kWorld || (other.IsSettled() && (m_ports[other.world] != 0 || other.IsOver()));
  };
  switch (part.role) {
    case Part::Role::kWorld:
      return true;
    case Part::Role::kGateway:
      return std::ranges::all_of(m_parts, isSettled);
    case Part::Role::kBots:
      return m_parts[part.world].keeper.ReadState() == Keeper::State::kRunning;
  }
  return false;
}

std::vector<std::string> Fleet::MakeCommand(const Part& part) const {
  const std::string wobble = (m_plan.programFolder / "wobble").string();
  std::vector<std::string> words;
  const WorldPlan& world = m_plan.worlds[part.world];
  switch (part.role) {
    case Part::Role::kWorld:
      words = {(m_plan.programFolder / "wobbled").string(), "--port", std::to_string(m_ports[part.world])};
      words.insert(words.end(), world.options.begin(), world.options.end());
      words.insert(words.end(), {"--status", "1", "--summary", SummaryOf(part).string()});
      break;
    case Part::Role::kGateway:
      words = {wobble,     "gateway", "--http", std::to_string(m_http), "--bind", m_plan.gateway->bindAddress,
               "--status", "1"};
      words.insert(words.end(), m_plan.gateway->options.begin(), m_plan.gateway->options.end());
      for (std::size_t i = 0; i < m_plan.worlds.size(); ++i) {
        if (m_ports[i] != 0) words.insert(words.end(), {"--server", m_plan.worlds[i].name + "=" + AddressOf(i)});
      }
      break;
    case Part::Role::kBots:
      words = {wobble,
               "bots",
               AddressOf(part.world),
               "--script",
               world.script,
               "--count",
               std::to_string(world.bots),
               "--ramp",
               "1",
               "--status",
               "1",
               "--summary",
               SummaryOf(part).string()};
      break;
  }
  return words;
}

// Waits for output of the children, until then at the latest, and passes it on. A child closes its output before
// waitpid reports its end, and a closed stream cannot be polled; so the wait is then shortened.
void Fleet::Update(double until) {
  std::vector<pollfd> descriptors;
  const double now = command::ReadClock();
  double wait = std::min(until - now, 1.0);
  for (const Part& part : m_parts) {
    if (part.keeper.ReadState() == Keeper::State::kWaiting && CanStart(part)) {
      wait = std::min(wait, part.keeper.WaitLeft(now));
    }
    if (!part.HasProcess()) continue;
    for (const int descriptor : {part.child->OutputDescriptor(), part.child->ErrorsDescriptor()}) {
      if (descriptor >= 0) descriptors.push_back({descriptor, POLLIN, 0});
      if (descriptor < 0) wait = std::min(wait, 0.01);
    }
  }
  const int milliseconds = static_cast<int>(std::ceil(std::max(wait, 0.0) * 1000));
  static_cast<void>(
      poll(descriptors.data(), descriptors.size(), milliseconds));  // a signal ends it early, as it should
  for (Part& part : m_parts) Follow(part);
}

void Fleet::Follow(Part& part) {
  const PartNews news = FollowPart(part, command::ReadClock());
  for (const std::string& line : news.errors) Complain(part.name + ": " + line);
  if (news.isReady) Announce(part);
  // What could not start at first has said why itself.
  if (!news.change.empty() && FindFailedStart() != &part) Complain(part.name + ": " + news.change);
}

void Fleet::Announce(const Part& part) {
  if (part.role == Part::Role::kWorld) m_ports[part.world] = ReadPort(part.readyLine);
  if (part.role == Part::Role::kGateway) m_http = ReadPort(part.readyLine);
  if (part.keeper.Restarts() > 0 || part.role == Part::Role::kBots) return;
  if (part.role == Part::Role::kGateway) {
    Say(part.readyLine);
    return ShowOwnersLink();
  }
  const std::string port = std::to_string(m_ports[part.world]);
  std::string line = m_plan.worlds[part.world].label + " on UDP port " + port;
  if (part.world == 0) {
    const std::string self = std::filesystem::proximate(m_plan.programFolder / "wobble").string();
    line += "; watch it from another terminal with: " + self + " watch " + AddressOf(0) + "; Ctrl-C ends all";
  }
  Say(line);
}

// The servers have left their owner's key in the user's state folder. Shown to a person alone: it is a secret.
void Fleet::ShowOwnersLink() {
  std::string ignored;
  const auto file = transport::vestibule::FindStateFile(transport::vestibule::kOwnerKeyName);
  if (!m_terminal || file.empty() || !transport::vestibule::InitialiseSodium()) return;
  const auto key = transport::vestibule::LoadKey(file, ignored);
  if (!key) return;
  Say("to own the first world, and tune it: http://localhost:" + std::to_string(m_http) +
      "/#owner=" + transport::vestibule::FormatKey(*key));
}

// Of the first world, the gateway and the first bots, and what is not as it should be.
void Fleet::ShowStatus(double left) {
  std::string line;
  const auto add = [&line](const std::string& words) { line += (line.empty() ? "" : " | ") + words; };
  if (std::isfinite(left)) add(std::to_string(std::lround(left)) + " s left");
  bool hasBots = false;
  std::size_t up = 0;
  for (const Part& part : m_parts) {
    const bool isRunning = part.keeper.ReadState() == Keeper::State::kRunning;
    if (part.role == Part::Role::kWorld && isRunning) ++up;
    const bool isAside = part.role == Part::Role::kWorld ? part.world > 0 : part.role == Part::Role::kBots && hasBots;
    hasBots |= part.role == Part::Role::kBots;
    if (isAside) continue;
    if (!isRunning && part.role != Part::Role::kBots) {
      add(part.name + " is down");
    } else if (!part.line.empty()) {
      add(part.line);
    }
  }
  const unsigned restarts = CountRestarts();
  const std::size_t worlds = m_plan.worlds.size();
  if (up < worlds || restarts > 0) add(std::to_string(up) + "/" + std::to_string(worlds) + " worlds up");
  if (restarts > 0) add(CountOf(restarts, "restart"));
  winsize size{};
  if (m_terminal && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1) {
    line.resize(std::min<std::size_t>(line.size(), size.ws_col - 1));  // a wrapped line could not be rewritten
  }
  std::printf(m_terminal ? "\r%s\033[K" : "%s\n", line.c_str());
  std::fflush(stdout);
  m_statusOpen = m_terminal;
}

// What does not run at the end although it was to. Before the parts are asked to end.
void Fleet::NoteFailures() {
  for (const Part& part : m_parts) {
    const Keeper::State state = part.keeper.ReadState();
    const std::string code = std::to_string(part.exitCode.value_or(0));
    if (state == Keeper::State::kGivenUp) {
      m_failures.push_back("the " + part.name + " ended with exit code " + code + " and could not be started again");
    } else if (state != Keeper::State::kRunning && part.keeper.Deaths() > 0) {
      m_failures.push_back("the " + part.name + " had died and was not back at the end");
    }
  }
}

// In the reverse order of starting.
void Fleet::EndAll() {
  for (auto part = m_parts.rbegin(); part != m_parts.rend(); ++part) End(*part);
}

// Asks a process that still runs to end, and kills it when it does not. One that was not ready yet has nothing to say.
void Fleet::End(Part& part) {
  const bool wasReady = part.keeper.ReadState() == Keeper::State::kRunning;
  part.keeper.AskToEnd();
  if (!part.HasProcess()) return;
  part.child->Signal(SIGINT);
  const double deadline = command::ReadClock() + (wasReady ? kEndPatience : kEndPatienceAtStart);
  while (part.HasProcess() && command::ReadClock() < deadline) Update(deadline);
  if (part.HasProcess()) {
    if (wasReady) {
      m_failures.push_back("the " + part.name + " did not end within " + std::to_string(std::lround(kEndPatience)) +
                           " s of being asked, and had to be killed");
    }
    part.child->Signal(SIGKILL);
    while (part.HasProcess()) Update(command::ReadClock() + 1);
    return;
  }
  if (wasReady && part.exitCode != 0) {
    m_failures.push_back("the " + part.name + " ended with exit code " + std::to_string(part.exitCode.value_or(0)));
  }
}

// Ends after a failed start. A part that refused its options has said so itself.
int Fleet::GiveUp() {
  const Part& failed = *FindFailedStart();
  const int code = failed.exitCode.value_or(command::kExitFailed);
  EndAll();
  if (code == command::kExitBadUse) return code;
  std::fprintf(stderr, "%s: the %s ended at once with exit code %d\n", m_plan.command.c_str(), failed.name.c_str(),
               code);
  return command::kExitFailed;
}

int Fleet::Report() {
  const double now = command::ReadClock();
  const bool isEarly = !m_isReady || now < m_readyAt + kJoinTime;
  for (const Part& part : m_parts) {
    if (part.role == Part::Role::kGateway) {
      if (!part.line.empty()) std::printf("gateway: %s\n", part.line.c_str());  // its last is what it counted
    } else if (part.child) {
      const bool isExpected = part.exitCode == 0 && part.keeper.HasBeenReady();
      const bool wasCutOff = part.role == Part::Role::kBots && m_parts[part.world].keeper.Deaths() > 0;
      if (part.role == Part::Role::kWorld) ReportServer(part.name, SummaryOf(part), isExpected, m_failures);
      if (part.role == Part::Role::kBots) {
        ReportBots(part.name, SummaryOf(part), {.isExpected = isExpected, .wasCutOff = wasCutOff, .isEarly = isEarly},
                   m_failures);
      }
    }
    if (part.keeper.Restarts() == 0) continue;
    std::printf("%s: %s, %.1f s down; the figures are those since\n", part.name.c_str(),
                CountOf(part.keeper.Restarts(), "restart").c_str(), part.keeper.SecondsDown(now));
  }
  for (const std::string& failure : m_failures) std::printf("FAILED: %s\n", failure.c_str());
  const unsigned restarts = CountRestarts();
  if (m_failures.empty() && restarts == 0) std::printf("all went well\n");
  if (m_failures.empty() && restarts > 0) {
    std::printf("all went well in the end: what had died came back (%s)\n", CountOf(restarts, "restart").c_str());
  }
  std::fflush(stdout);
  return m_failures.empty() ? command::kExitGood : command::kExitFailed;
}

void Fleet::Say(const std::string& line) {
  EndStatusLine();
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Fleet::Complain(const std::string& line) {
  EndStatusLine();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Fleet::EndStatusLine() {
  if (m_statusOpen) std::printf("\n");
  std::fflush(stdout);
  m_statusOpen = false;
}

}  // namespace

int RunFleet(const Plan& plan, const std::function<bool()>& stopAsked) { return Fleet(plan, stopAsked).Run(); }

}  // namespace wobble::host
