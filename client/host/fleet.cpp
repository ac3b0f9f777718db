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

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <string>

#include "client/command/clock.h"
#include "client/command/exit_codes.h"
#include "client/command/show_page.h"
#include "client/host/part.h"
#include "client/host/part_commands.h"
#include "client/host/ports.h"
#include "client/host/report.h"
#include "client/host/screen.h"
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

// Bots apart.
bool IsSameServer(WorldPlan a, const WorldPlan& b) {
  a.bots = b.bots;
  return a == b;
}

class Fleet {
 public:
  Fleet(Plan plan, const std::function<bool()>& stopAsked, const TakePlan& takePlan)
      : m_plan(std::move(plan)), m_stopAsked(stopAsked), m_takePlan(takePlan) {}

  int Run();

 private:
  // number: of a world of the plan.
  void AddWorld(std::size_t number);
  void AddBots(std::size_t number);
  void AddGateway();
  void AddPart(Part::Role role, std::size_t world, const std::string& name, const char* errorPrefix,
               const char* readyPrefix);
  void Watch();
  void FollowPlan();
  void FollowBots(std::size_t world, const BotsPlan& next);
  void RetireParts(std::size_t world, bool andItself);
  void Retire(Part& part);
  void StartDue();
  [[nodiscard]] bool CanStart(const Part& part) const;
  [[nodiscard]] std::vector<std::string> MakeCommand(const Part& part) const;
  void Update(double until);
  void Follow(Part& part);
  void Announce(const Part& part);
  void ShowOwnersLink();
  void EndAll();
  void End(Part& part);
  int GiveUp();

  // For programs of this machine.
  [[nodiscard]] std::string AddressOf(std::size_t world) const {
    return m_plan.worlds[world].host + ":" + std::to_string(m_ports[world]);
  }
  [[nodiscard]] std::vector<std::string> ListServers() const;
  // The first world or gateway that could not be started at all; null: none.
  [[nodiscard]] const Part* FindFailedStart() const;
  [[nodiscard]] const Part& FindWorld(std::size_t number) const;
  [[nodiscard]] bool AreWorldsOver() const;

  Plan m_plan;
  const std::function<bool()>& m_stopAsked;
  const TakePlan& m_takePlan;
  Screen m_screen;
  bool m_isReady = false;  // every world and the gateway was ready, or has failed
  double m_readyAt = 0;
  std::vector<std::string> m_failures;
  TemporaryFolder m_folder;
  std::deque<Part> m_parts;            // as they were added
  std::vector<std::uint16_t> m_ports;  // UDP, of the worlds; 0: not known yet
  std::uint16_t m_http = 0;            // TCP, of the gateway
};

int Fleet::Run() {
  if (m_folder.Path().empty()) {
    std::fprintf(stderr, "%s: no temporary folder can be made\n", m_plan.command.c_str());
    return command::kExitFailed;
  }
  // Before anything starts: the gateway itself is started when the worlds are ready.
  if (const std::string taken = FindTakenPort(m_plan); !taken.empty()) {
    std::fprintf(stderr, "%s: %s\n", m_plan.command.c_str(), taken.c_str());
    return command::kExitBadUse;
  }
  for (std::size_t i = 0; i < m_plan.worlds.size(); ++i) AddWorld(i);
  if (m_plan.gateway) AddGateway();
  Watch();
  m_screen.EndStatus();
  if (FindFailedStart() != nullptr) return GiveUp();
  m_failures = FindFailures(m_parts);
  const bool isEarly = !m_isReady || command::ReadClock() < m_readyAt + kJoinTime;
  EndAll();
  return Report(m_parts, m_folder.Path(), isEarly, command::ReadClock(), std::move(m_failures));
}

void Fleet::AddWorld(std::size_t number) {
  const WorldPlan& world = m_plan.worlds[number];
  m_ports.push_back(world.port);
  AddPart(Part::Role::kWorld, number, world.title, "wobbled: ", "listening");
  AddBots(number);
}

void Fleet::AddBots(std::size_t number) {
  const WorldPlan& world = m_plan.worlds[number];
  if (world.bots.count == 0) return;
  const std::string name = number == 0 ? "bots" : "bots in " + world.name;
  AddPart(Part::Role::kBots, number, name, "wobble bots: ", "bots ");
}

void Fleet::AddGateway() {
  m_http = m_plan.gateway->port;
  AddPart(Part::Role::kGateway, 0, "gateway", "wobble gateway: ", "open http");
}

void Fleet::AddPart(Part::Role role, std::size_t world, const std::string& name, const char* errorPrefix,
                    const char* readyPrefix) {
  const std::string summary = name + "-" + std::to_string(m_parts.size()) + ".json";
  m_parts.push_back({role, world, name, errorPrefix, readyPrefix, summary});
}

void Fleet::Watch() {
  double end = INFINITY, nextStatus = INFINITY;
  const auto now = &command::ReadClock;
  while (!m_stopAsked() && now() < end && FindFailedStart() == nullptr && !AreWorldsOver()) {
    if (m_isReady) FollowPlan();
    StartDue();
    Update(std::min(nextStatus, end));
    const auto isSettled = [](const Part& part) { return part.role == Part::Role::kBots || part.IsSettled(); };
    if (!m_isReady && FindFailedStart() == nullptr && std::ranges::all_of(m_parts, isSettled)) {
      m_isReady = true;
      if (!m_plan.notice.empty()) m_screen.Say(m_plan.notice);
      m_readyAt = now();
      if (m_plan.duration > 0) end = m_readyAt + m_plan.duration;
      if (m_plan.statusEvery > 0) nextStatus = m_readyAt + m_plan.statusEvery + kStatusLag;
    }
    if (now() < nextStatus) continue;
    nextStatus += m_plan.statusEvery;
    m_screen.ShowStatus(FormatStatus(m_parts, end - now()));
  }
}

// Adopts a new plan: worlds and gateway that are as they were go on, and worlds are told to read their files again;
// what is not in it any more ends; what has changed ends and begins anew, and what was over begins again. The gateway
// has its list of worlds from its start, so that it begins anew when a name or an address in it changes: its browsers
// join again by themselves.
void Fleet::FollowPlan() {
  const std::optional<Plan> next = m_takePlan ? m_takePlan() : std::nullopt;
  if (!next) return;
  const std::vector<std::string> before = ListServers();
  std::vector<WorldPlan> others = next->worlds;
  for (std::size_t i = 0; i < m_plan.worlds.size(); ++i) {
    const Part& present = FindWorld(i);
    if (present.isRetired) continue;
    const auto found = std::ranges::find(others, m_plan.worlds[i].name, &WorldPlan::name);
    if (found != others.end() && IsSameServer(*found, m_plan.worlds[i]) && !present.IsOver()) {
      if (present.HasProcess()) present.child->Signal(SIGHUP);
      FollowBots(i, found->bots);
      others.erase(found);
    } else {
      RetireParts(i, true);
    }
  }
  for (const WorldPlan& world : others) {
    m_plan.worlds.push_back(world);
    AddWorld(m_plan.worlds.size() - 1);
  }
  if (std::ranges::is_permutation(ListServers(), before) && next->gateway == m_plan.gateway) return;
  for (Part& part : m_parts) {
    if (part.role == Part::Role::kGateway && !part.isRetired) Retire(part);
  }
  m_plan.gateway = next->gateway;
  if (m_plan.gateway) AddGateway();
}

void Fleet::FollowBots(std::size_t world, const BotsPlan& next) {
  if (next == m_plan.worlds[world].bots) return;
  RetireParts(world, false);
  m_plan.worlds[world].bots = next;
  AddBots(world);
}

// Its bots end first.
void Fleet::RetireParts(std::size_t world, bool andItself) {
  for (auto part = m_parts.rbegin(); part != m_parts.rend(); ++part) {
    const bool isIt = part->role == Part::Role::kBots || (andItself && part->role == Part::Role::kWorld);
    if (isIt && part->world == world && !part->isRetired) Retire(*part);
  }
}

// As the gateway is told of them: but for those that ended before they had a port.
std::vector<std::string> Fleet::ListServers() const {
  std::vector<std::string> servers;
  for (std::size_t i = 0; i < m_plan.worlds.size(); ++i) {
    const Part& world = FindWorld(i);
    if (world.isRetired || (m_ports[i] == 0 && world.IsOver())) continue;
    servers.push_back(m_plan.worlds[i].name + "=" + AddressOf(i));
  }
  return servers;
}

void Fleet::Retire(Part& part) {
  m_screen.Complain(part.name + ": ends, as its file says now");
  End(part);
  part.isRetired = true;
}

const Part* Fleet::FindFailedStart() const {
  const auto hasFailed = [this](const Part& part) {
    const bool isFinal = part.keeper.ReadState() == Keeper::State::kGivenUp && !part.keeper.HasBeenReady();
    return isFinal && !m_isReady && part.role != Part::Role::kBots;
  };
  const auto found = std::ranges::find_if(m_parts, hasFailed);
  return found == m_parts.end() ? nullptr : &*found;
}

const Part& Fleet::FindWorld(std::size_t number) const {
  return *std::ranges::find_if(
      m_parts, [&](const Part& part) { return part.role == Part::Role::kWorld && part.world == number; });
}

bool Fleet::AreWorldsOver() const {
  return std::ranges::all_of(m_parts,
                             [](const Part& part) { return part.role != Part::Role::kWorld || part.IsOver(); });
}

void Fleet::StartDue() {
  for (Part& part : m_parts) {
    const double now = command::ReadClock();
    if (!part.keeper.IsDue(now) || !CanStart(part)) continue;
    const std::string error = StartPart(part, MakeCommand(part), now);
    if (!error.empty()) m_screen.Complain(part.name + ": " + error);
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
      return FindWorld(part.world).keeper.ReadState() == Keeper::State::kRunning;
  }
  return false;
}

std::vector<std::string> Fleet::MakeCommand(const Part& part) const {
  const std::string summary = SummaryOf(part, m_folder.Path()).string();
  switch (part.role) {
    case Part::Role::kWorld:
      return MakeWorldCommand(m_plan, part.world, m_ports[part.world], summary);
    case Part::Role::kGateway:
      return MakeGatewayCommand(m_plan, m_http, ListServers());
    case Part::Role::kBots:
      return MakeBotsCommand(m_plan, part.world, AddressOf(part.world), summary);
  }
  return {};
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
  for (const std::string& line : news.errors) m_screen.Complain(part.name + ": " + line);
  if (news.isReady) Announce(part);
  // What could not start at first has said why itself.
  if (!news.change.empty() && FindFailedStart() != &part) m_screen.Complain(part.name + ": " + news.change);
}

void Fleet::Announce(const Part& part) {
  if (part.role == Part::Role::kWorld) m_ports[part.world] = ReadPort(part);
  if (part.role == Part::Role::kGateway) m_http = ReadPort(part);
  if (part.keeper.Restarts() > 0 || part.role == Part::Role::kBots) return;
  if (part.role == Part::Role::kGateway) {
    m_screen.Say(part.readyLine);
    const bool isSecure = part.readyLine.find("https://") != std::string::npos;
    command::ShowPageToFriends(isSecure ? "https" : "http", m_plan.gateway->bindAddress, m_http);
    return ShowOwnersLink();
  }
  const std::string port = std::to_string(m_ports[part.world]);
  const std::size_t scene = std::min(part.readyLine.find("scene "), part.readyLine.size());
  std::string line = m_plan.worlds[part.world].label + part.readyLine.substr(scene) + " on UDP port " + port;
  if (part.world == 0) {
    const std::string self = std::filesystem::proximate(m_plan.programFolder / "wobble").string();
    line += "; watch it from another terminal with: " + self + " watch " + AddressOf(0) + "; Ctrl-C ends all";
  }
  m_screen.Say(line);
}

// The servers have left their owner's key in the user's state folder. Shown to a person alone: it is a secret.
void Fleet::ShowOwnersLink() {
  std::string ignored;
  const auto file = transport::vestibule::FindStateFile(transport::vestibule::kOwnerKeyName);
  if (!m_screen.IsTerminal() || file.empty() || !transport::vestibule::InitialiseSodium()) return;
  const auto key = transport::vestibule::LoadKey(file, ignored);
  if (!key) return;
  m_screen.Say("to own the first world, and tune it: http://localhost:" + std::to_string(m_http) +
               "/#owner=" + transport::vestibule::FormatKey(*key));
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

}  // namespace

int RunFleet(const Plan& plan, const std::function<bool()>& stopAsked, const TakePlan& takePlan) {
  return Fleet(plan, stopAsked, takePlan).Run();
}

}  // namespace wobble::host
