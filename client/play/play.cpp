// The parts are real programs, started as children, rather than a server in this process: people see what they will run
// themselves, and the crash of one part is visible as such.
//
// The order matters. Each part starts when the one before is ready, so that what it needs is there and a line that
// tells people to open something is true. At the end bots and browsers say goodbye to a server that still runs. All
// parts get SIGINT, and are killed when they do not react; what they measured is read from their summary files.
#include "client/play/play.h"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string_view>
#include <vector>

#include "client/command/child.h"
#include "client/command/clock.h"
#include "client/command/exit_codes.h"
#include "client/command/show_page.h"
#include "client/play/summary.h"
#include "protocol/transport/vestibule/key_file.h"

namespace wobble::play {
namespace {

// Places for people, in addition to those of the bots.
constexpr unsigned kGuests = 64;

// Seconds to wait for a server that loads a large scene, and for a program that says goodbye and writes its summary.
constexpr double kStartPatience = 30;
constexpr double kEndPatience = 5;
constexpr double kStatusEvery = 1;
// The children print a status line each second; so many seconds are allowed for it to arrive.
constexpr double kStatusLag = 0.1;

// A folder for the children's summaries, removed with this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string name = (std::filesystem::temp_directory_path(error) / "wobble-XXXXXX").string();
    if (!error && mkdtemp(name.data()) != nullptr) m_path = name;
  }
  ~TemporaryFolder() {
    std::error_code error;
    if (!m_path.empty()) std::filesystem::remove_all(m_path, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& Path() const { return m_path; }  // empty: none could be made

 private:
  std::filesystem::path m_path;
};

// One of the programs.
struct Part {
  std::string name;
  std::string errorPrefix;  // of its lines on standard error, which are passed on without it
  std::string readyPrefix;  // of the line that it prints when it is ready
  command::Child child = {};
  std::string readyLine = {};  // empty until it is ready
  std::string line = {};       // its latest other line
  bool hasStarted = false;
};

// Bots that play against people in a scene with a game.
constexpr unsigned kOpponents = 2;

// A scene file's name without folder and extension, with only characters that an address may hold.
std::string FindName(const std::string& scene) {
  std::string name = std::filesystem::path(scene).stem().string().substr(0, 32);
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
  }
  return name;
}

// From a server's "listening on UDP port 7777, scene arena".
unsigned ReadPort(const std::string& readyLine) {
  const std::size_t digits = readyLine.find_first_of("0123456789");
  return digits == std::string::npos ? 0 : static_cast<unsigned>(std::strtoul(readyLine.c_str() + digits, nullptr, 10));
}

class Play {
 public:
  Play(const PlayOptions& options, const std::function<bool()>& stopAsked)
      : m_options(options), m_stopAsked(stopAsked), m_terminal(isatty(STDOUT_FILENO) != 0) {}

  int Run();

 private:
  Part& AddPart(const std::string& name, const std::string& errorPrefix, const std::string& readyPrefix);
  bool StartServers();
  bool StartGateway();
  void ShowOwnersLink() const;
  void StartBots(std::size_t world, unsigned count, const char* script);
  [[nodiscard]] std::string AddressOf(std::size_t world) const;
  [[nodiscard]] std::filesystem::path SummaryOf(const Part& part) const {
    return m_folder.Path() / (part.name + ".json");
  }
  bool Start(Part& part, const std::vector<std::string>& command);
  bool Await(Part& part);
  void Watch();
  void EndAll();
  void End(Part& part);
  int GiveUp();
  int Report();

  void Update(double until);
  void Forward(Part& part);
  void ShowStatus(double left);
  void EndStatusLine();
  void Fail(const std::string& reason);

  const PlayOptions& m_options;
  const std::function<bool()>& m_stopAsked;
  bool m_terminal;
  bool m_statusOpen = false;
  std::vector<std::string> m_failures;
  TemporaryFolder m_folder;
  std::deque<Part> m_parts;       // as they were started: servers, in the order of the scenes, gateway, bots
  std::vector<unsigned> m_ports;  // UDP, of the servers that listen
  Part* m_gateway = nullptr;
  std::vector<Part*> m_bots;
};

int Play::Run() {
  if (m_folder.Path().empty()) {
    std::fprintf(stderr, "wobble play: no temporary folder can be made\n");
    return command::kExitFailed;
  }
  if (!StartServers() || !StartGateway()) return GiveUp();
  if (m_options.bots > 0) StartBots(0, m_options.bots, "wander.lua");
  for (std::size_t world = 1; world < m_options.scenes.size(); ++world) {
    if (m_options.scenes[world] == "sumo") StartBots(world, kOpponents, "chase.lua");
  }
  Watch();
  EndStatusLine();
  EndAll();
  return Report();
}

Part& Play::AddPart(const std::string& name, const std::string& errorPrefix, const std::string& readyPrefix) {
  return m_parts.emplace_back(name, errorPrefix, readyPrefix);
}

std::string Play::AddressOf(std::size_t world) const { return "127.0.0.1:" + std::to_string(m_ports[world]); }

// Starts all servers at once: each trains for a while first. A world stands still until a player comes, so that its
// beginning can be seen and it costs nothing.
bool Play::StartServers() {
  const unsigned places = kGuests + m_options.bots;
  for (std::size_t world = 0; world < m_options.scenes.size(); ++world) {
    const std::string name = world == 0 ? "server" : "server of " + FindName(m_options.scenes[world]);
    Part& part = AddPart(name, "wobbled: ", "listening");
    std::vector<std::string> command{(m_options.programFolder / "wobbled").string(),
                                     "--scene",
                                     m_options.scenes[world],
                                     "--port",
                                     std::to_string(m_options.port == 0 ? 0 : m_options.port + world),
                                     "--max-clients",
                                     std::to_string(places),
                                     "--status",
                                     "1",
                                     "--log-level",
                                     "warn",
                                     "--summary",
                                     SummaryOf(part).string()};
    if (world > 0) command.insert(command.end(), {"--pause-after", "0.02"});
    if (!m_options.recordings.empty()) command.insert(command.end(), {"--record", m_options.recordings});
    if (!Start(part, command)) return false;
  }
  for (std::size_t world = 0; world < m_options.scenes.size(); ++world) {
    if (!Await(m_parts[world])) return false;
    m_ports.push_back(ReadPort(m_parts[world].readyLine));
  }
  const std::string self = std::filesystem::proximate(m_options.programFolder / "wobble").string();
  std::printf("scene %s on UDP port %u; watch it from another terminal with: %s watch %s; Ctrl-C ends all\n",
              m_options.scenes[0].c_str(), m_ports[0], self.c_str(), AddressOf(0).c_str());
  std::fflush(stdout);
  return true;
}

// True also when no gateway is wanted or there is no page for it.
bool Play::StartGateway() {
  if (!m_options.http) return true;
  std::error_code error;
  if (!std::filesystem::is_directory(m_options.page, error)) {
    std::printf("no page for browsers: '%s' is not there; sh docker/packages.sh web and the next build make it\n",
                std::filesystem::proximate(m_options.page).c_str());
    std::fflush(stdout);
    return true;
  }
  m_gateway = &AddPart("gateway", "wobble gateway: ", "open http");
  std::vector<std::string> command{(m_options.programFolder / "wobble").string(),
                                   "gateway",
                                   "--http",
                                   std::to_string(*m_options.http),
                                   "--page",
                                   m_options.page.string(),
                                   "--max-connections",
                                   std::to_string(kGuests),
                                   "--status",
                                   "1"};
  for (std::size_t world = 0; world < m_options.scenes.size(); ++world) {
    command.insert(command.end(), {"--server", FindName(m_options.scenes[world]) + "=" + AddressOf(world)});
  }
  if (!m_options.recordings.empty()) command.insert(command.end(), {"--recordings", m_options.recordings});
  if (!Start(*m_gateway, command) || !Await(*m_gateway)) return false;
  std::printf("%s\n", m_gateway->readyLine.c_str());
  command::ShowPageToFriends("http", "0.0.0.0", ReadPort(m_gateway->readyLine));
  ShowOwnersLink();
  std::fflush(stdout);
  return true;
}

// The servers have left their owner's key in the user's state folder. Shown to a person alone: it is a secret.
void Play::ShowOwnersLink() const {
  std::string ignored;
  const auto file = transport::vestibule::FindStateFile(transport::vestibule::kOwnerKeyName);
  if (!m_terminal || file.empty() || !transport::vestibule::InitialiseSodium()) return;
  const auto key = transport::vestibule::LoadKey(file, ignored);
  if (!key) return;
  std::printf("to own the first world, and tune it: http://localhost:%u/#owner=%s\n", ReadPort(m_gateway->readyLine),
              transport::vestibule::FormatKey(*key).c_str());
}

void Play::StartBots(std::size_t world, unsigned count, const char* script) {
  const std::string name = world == 0 ? "bots" : "bots in " + FindName(m_options.scenes[world]);
  Part& part = AddPart(name, "wobble bots: ", "\n");  // a prefix that never comes: nothing waits for bots
  m_bots.push_back(&part);
  static_cast<void>(Start(
      part, {(m_options.programFolder / "wobble").string(), "bots", AddressOf(world), "--script", script, "--count",
             std::to_string(count), "--ramp", "1", "--status", "1", "--summary", SummaryOf(part).string()}));
}

bool Play::Start(Part& part, const std::vector<std::string>& command) {
  std::string error;
  part.hasStarted = part.child.Start(command, error);
  if (!part.hasStarted) Fail(error);
  return part.hasStarted;
}

// Waits until a part is ready. False when it is not; then a failure is noted, unless a stop was asked for meanwhile.
bool Play::Await(Part& part) {
  const double end = command::ReadClock() + kStartPatience;
  while (part.readyLine.empty() && part.child.IsRunning() && !m_stopAsked() && command::ReadClock() < end) Update(end);
  if (!part.readyLine.empty() && part.child.IsRunning()) return true;
  if (!part.child.IsRunning()) {
    Fail("the " + part.name + " ended at once with exit code " + std::to_string(part.child.ExitCode().value_or(0)));
  } else if (!m_stopAsked()) {
    Fail("the " + part.name + " was not ready after 30 s");
  }
  return false;
}

// Ends after a failed start. A part that refused its options has said so itself.
int Play::GiveUp() {
  EndStatusLine();
  const bool isBadUse = std::any_of(m_parts.begin(), m_parts.end(),
                                    [](const Part& part) { return part.child.ExitCode() == command::kExitBadUse; });
  EndAll();
  if (isBadUse) return command::kExitBadUse;
  for (const std::string& failure : m_failures) std::fprintf(stderr, "wobble play: %s\n", failure.c_str());
  return m_failures.empty() ? command::kExitGood : command::kExitFailed;
}

void Play::Watch() {
  const double begin = command::ReadClock();
  const double end = m_options.duration > 0 ? begin + m_options.duration : INFINITY;
  double nextStatus = begin + kStatusEvery + kStatusLag;
  while (!m_stopAsked() && command::ReadClock() < end) {
    Update(std::min(nextStatus, end));
    for (const Part& part : m_parts) {
      if (!part.hasStarted || part.child.IsRunning()) continue;
      const int code = part.child.ExitCode().value_or(0);
      return Fail("the " + part.name + " ended early with exit code " + std::to_string(code));
    }
    if (command::ReadClock() < nextStatus) continue;
    nextStatus += kStatusEvery;
    ShowStatus(end - command::ReadClock());
  }
}

// In the reverse order of starting.
void Play::EndAll() {
  for (auto part = m_parts.rbegin(); part != m_parts.rend(); ++part) End(*part);
}

// Asks a child that still runs to end, and kills it when it does not.
void Play::End(Part& part) {
  command::Child& child = part.child;
  if (!child.IsRunning()) return;
  child.Signal(SIGINT);
  const double deadline = command::ReadClock() + kEndPatience;
  while (child.IsRunning() && command::ReadClock() < deadline) Update(deadline);
  if (child.IsRunning()) {
    Fail("the " + part.name + " did not end within " + std::to_string(std::lround(kEndPatience)) +
         " s of being asked, and had to be killed");
    child.Signal(SIGKILL);
    while (child.IsRunning()) Update(command::ReadClock() + 1);
    return;
  }
  // A child that gets the signal in its first moments, before it handles it, has ended as asked.
  const bool deafYet = child.ExitCode() == 128 + SIGINT && m_stopAsked();
  if (child.ExitCode() != 0 && !deafYet) {
    Fail("the " + part.name + " ended with exit code " + std::to_string(child.ExitCode().value_or(0)));
  }
}

// Waits for output of the children, until then at the latest, and passes it on. A child closes its output before
// waitpid reports its end, and a closed stream cannot be polled; so the wait is then shortened.
void Play::Update(double until) {
  std::vector<pollfd> descriptors;
  double wait = until - command::ReadClock();
  for (const Part& part : m_parts) {
    for (const int descriptor : {part.child.OutputDescriptor(), part.child.ErrorsDescriptor()}) {
      if (descriptor >= 0) descriptors.push_back({descriptor, POLLIN, 0});
      if (descriptor < 0 && part.child.IsRunning()) wait = std::min(wait, 0.01);
    }
  }
  const int milliseconds = static_cast<int>(std::ceil(std::clamp(wait, 0.0, 1.0) * 1000));
  static_cast<void>(
      poll(descriptors.data(), descriptors.size(), milliseconds));  // a signal ends it early, as it should
  for (Part& part : m_parts) Forward(part);
}

void Play::Forward(Part& part) {
  part.child.Update();
  for (std::string& line : part.child.TakeOutput()) {
    if (part.readyLine.empty() && line.rfind(part.readyPrefix, 0) == 0) {
      part.readyLine = std::move(line);
      continue;
    }
    line.erase(0, line.find_first_not_of(' '));
    part.line = std::move(line);
  }
  for (const std::string& line : part.child.TakeErrors()) {
    EndStatusLine();
    const std::size_t begin = line.rfind(part.errorPrefix, 0) == 0 ? part.errorPrefix.size() : 0;
    std::fprintf(stderr, "%s: %s\n", part.name.c_str(), line.c_str() + begin);
  }
}

void Play::ShowStatus(double left) {
  std::string line;
  for (const Part& part : m_parts) {
    const bool isAside = &part != &m_parts[0] && &part != m_gateway && (m_bots.empty() || &part != m_bots[0]);
    if (isAside || part.line.empty()) continue;
    line += (line.empty() ? "" : " | ") + part.line;
  }
  if (std::isfinite(left)) line = std::to_string(std::lround(left)) + " s left | " + line;
  winsize size{};
  if (m_terminal && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1) {
    line.resize(std::min<std::size_t>(line.size(), size.ws_col - 1));  // a wrapped line could not be rewritten
  }
  std::printf(m_terminal ? "\r%s\033[K" : "%s\n", line.c_str());
  std::fflush(stdout);
  m_statusOpen = m_terminal;
}

void Play::EndStatusLine() {
  if (m_statusOpen) std::printf("\n");
  std::fflush(stdout);
  m_statusOpen = false;
}

void Play::Fail(const std::string& reason) { m_failures.push_back(reason); }

int Play::Report() {
  for (std::size_t world = 0; world < m_options.scenes.size(); ++world) {
    const Part& part = m_parts[world];
    ReportServer(part.name, SummaryOf(part), part.child.ExitCode() == 0, m_failures);
  }
  if (m_gateway != nullptr) std::printf("gateway: %s\n", m_gateway->line.c_str());  // its last is what it counted
  for (const Part* bots : m_bots) {
    if (bots->hasStarted) ReportBots(bots->name, SummaryOf(*bots), bots->child.ExitCode() == 0, m_failures);
  }
  for (const std::string& failure : m_failures) std::printf("FAILED: %s\n", failure.c_str());
  if (m_failures.empty()) std::printf("all went well\n");
  std::fflush(stdout);
  return m_failures.empty() ? command::kExitGood : command::kExitFailed;
}

}  // namespace

int RunPlay(const PlayOptions& options, const std::function<bool()>& stopAsked) {
  return Play(options, stopAsked).Run();
}

}  // namespace wobble::play
