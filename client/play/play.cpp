// Real programs as children rather than a server in this process: what is shown here is what people will run, and a
// crash of one part is seen as what it is.
//
// The order matters. Each starts when the one before is ready, so that what it needs is there and a line that tells
// people to open something is true. At the end bots and browsers say goodbye to a server that still lives. All are
// asked by SIGINT and killed when they do not listen; what they measured is read from their summary files.
#include "client/play/play.h"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "client/play/child.h"
#include "client/play/summary.h"
#include "client/tool/clock.h"
#include "client/tool/exit_codes.h"

namespace wobble::play {
namespace {

// Places beside those of the bots, for people.
constexpr unsigned kGuests = 64;

// Seconds: a server that loads a large scene, and a program that says its goodbyes and writes its summary.
constexpr double kStartPatience = 30;
constexpr double kEndPatience = 5;
constexpr double kStatusEvery = 1;
// The children's own status lines of a second are given this long to arrive.
constexpr double kStatusLag = 0.1;

// A folder for the children's summaries, gone with this object.
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
  const char* name;
  std::string errorPrefix;  // of its own lines on standard error, which are passed on without it
  std::string readyPrefix;  // of the line that says it is ready
  Child child = {};
  std::string readyLine = {};  // empty until then
  std::string line = {};       // the latest of any other
  bool hasStarted = false;
};

class Play {
 public:
  Play(const PlayOptions& options, const std::function<bool()>& stopAsked)
      : m_options(options), m_stopAsked(stopAsked), m_terminal(isatty(STDOUT_FILENO) != 0) {}

  int Run();

 private:
  bool StartServer();
  bool StartGateway();
  void StartBots();
  bool Start(Part& part, const std::vector<std::string>& command);
  bool Await(Part& part);
  void Watch();
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
  Part m_server{"server", "wobbled: ", "listening"};
  Part m_gateway{"gateway", "wobble gateway: ", "open http"};
  Part m_bots{"bots", "wobble bots: ", "\n"};                          // never: nobody waits for them
  const std::array<Part*, 3> m_parts{&m_bots, &m_gateway, &m_server};  // in the order of their end
};

int Play::Run() {
  if (m_folder.Path().empty()) {
    std::fprintf(stderr, "wobble play: no temporary folder can be made\n");
    return tool::kExitFailed;
  }
  if (!StartServer() || !StartGateway()) return GiveUp();
  if (m_options.bots > 0) StartBots();
  Watch();
  EndStatusLine();
  for (Part* part : m_parts) End(*part);
  return Report();
}

bool Play::StartServer() {
  const unsigned places = kGuests + m_options.bots;
  if (!Start(m_server, {(m_options.programFolder / "wobbled").string(), "--scene", m_options.scene, "--port",
                        std::to_string(m_options.port), "--max-clients", std::to_string(places), "--status", "1",
                        "--log-level", "warn", "--summary", (m_folder.Path() / "server.json").string()}) ||
      !Await(m_server)) {
    return false;
  }
  const std::string self = std::filesystem::proximate(m_options.programFolder / "wobble").string();
  std::printf("scene %s on UDP port %u; watch it from another terminal with: %s watch 127.0.0.1:%u; Ctrl-C ends all\n",
              m_options.scene.c_str(), m_options.port, self.c_str(), m_options.port);
  std::fflush(stdout);
  return true;
}

// True also where none is wanted or there is no page for it.
bool Play::StartGateway() {
  if (m_options.http == 0) return true;
  std::error_code error;
  if (!std::filesystem::is_directory(m_options.page, error)) {
    std::printf("no page for browsers: '%s' is not there; sh docker/packages.sh web and the next build make it\n",
                std::filesystem::proximate(m_options.page).c_str());
    std::fflush(stdout);
    return true;
  }
  if (!Start(m_gateway,
             {(m_options.programFolder / "wobble").string(), "gateway", "--http", std::to_string(m_options.http),
              "--server", "127.0.0.1:" + std::to_string(m_options.port), "--page", m_options.page.string(),
              "--max-connections", std::to_string(kGuests), "--status", "1"}) ||
      !Await(m_gateway)) {
    return false;
  }
  std::printf("%s\n", m_gateway.readyLine.c_str());
  std::fflush(stdout);
  return true;
}

void Play::StartBots() {
  static_cast<void>(Start(
      m_bots,
      {(m_options.programFolder / "wobble").string(), "bots", "127.0.0.1:" + std::to_string(m_options.port), "--script",
       (m_options.programFolder / "scripts" / "wander.lua").string(), "--count", std::to_string(m_options.bots),
       "--ramp", "1", "--status", "1", "--summary", (m_folder.Path() / "bots.json").string()}));
}

bool Play::Start(Part& part, const std::vector<std::string>& command) {
  std::string error;
  part.hasStarted = part.child.Start(command, error);
  if (!part.hasStarted) Fail(error);
  return part.hasStarted;
}

// False when it did not get ready; without a failure noted when a stop was asked for meanwhile.
bool Play::Await(Part& part) {
  const double end = tool::ReadClock() + kStartPatience;
  while (part.readyLine.empty() && part.child.IsRunning() && !m_stopAsked() && tool::ReadClock() < end) Update(end);
  if (!part.readyLine.empty() && part.child.IsRunning()) return true;
  if (!part.child.IsRunning()) {
    Fail(std::string("the ") + part.name + " ended at once with exit code " +
         std::to_string(part.child.ExitCode().value_or(0)));
  } else if (!m_stopAsked()) {
    Fail(std::string("the ") + part.name + " was not ready after 30 s");
  }
  return false;
}

// What was told to start in a way that it cannot has said so itself.
int Play::GiveUp() {
  EndStatusLine();
  const auto refused = std::find_if(m_parts.begin(), m_parts.end(),
                                    [](const Part* part) { return part->child.ExitCode() == tool::kExitBadUse; });
  const bool isBadUse = refused != m_parts.end();
  for (Part* part : m_parts) End(*part);
  if (isBadUse) return tool::kExitBadUse;
  for (const std::string& failure : m_failures) std::fprintf(stderr, "wobble play: %s\n", failure.c_str());
  return m_failures.empty() ? tool::kExitGood : tool::kExitFailed;
}

void Play::Watch() {
  const double begin = tool::ReadClock();
  const double end = m_options.duration > 0 ? begin + m_options.duration : INFINITY;
  double nextStatus = begin + kStatusEvery + kStatusLag;
  while (!m_stopAsked() && tool::ReadClock() < end) {
    Update(std::min(nextStatus, end));
    for (const Part* part : m_parts) {
      if (!part->hasStarted || part->child.IsRunning()) continue;
      return Fail(std::string("the ") + part->name + " ended early with exit code " +
                  std::to_string(part->child.ExitCode().value_or(0)));
    }
    if (tool::ReadClock() < nextStatus) continue;
    nextStatus += kStatusEvery;
    ShowStatus(end - tool::ReadClock());
  }
}

// Asks a child that still runs to end, and sees to it that it does.
void Play::End(Part& part) {
  Child& child = part.child;
  if (!child.IsRunning()) return;
  child.Signal(SIGINT);
  const double deadline = tool::ReadClock() + kEndPatience;
  while (child.IsRunning() && tool::ReadClock() < deadline) Update(deadline);
  if (child.IsRunning()) {
    Fail(std::string("the ") + part.name + " did not end within " + std::to_string(std::lround(kEndPatience)) +
         " s of being asked, and had to be killed");
    child.Signal(SIGKILL);
    while (child.IsRunning()) Update(tool::ReadClock() + 1);
    return;
  }
  // Stopped in its first moments, before it listened for the signal: an end as asked for.
  const bool deafYet = child.ExitCode() == 128 + SIGINT && m_stopAsked();
  if (child.ExitCode() != 0 && !deafYet) {
    Fail(std::string("the ") + part.name + " ended with exit code " + std::to_string(child.ExitCode().value_or(0)));
  }
}

// Waits for output of the children until then at the latest, and passes it on. A child's end closes its output, but
// may be noticed a little later: a closed stream is polled no more, so that wait is cut short.
void Play::Update(double until) {
  pollfd descriptors[2 * std::tuple_size_v<decltype(m_parts)>];
  nfds_t count = 0;
  double wait = until - tool::ReadClock();
  for (const Part* part : m_parts) {
    for (const int descriptor : {part->child.OutputDescriptor(), part->child.ErrorsDescriptor()}) {
      if (descriptor >= 0) descriptors[count++] = {descriptor, POLLIN, 0};
      if (descriptor < 0 && part->child.IsRunning()) wait = std::min(wait, 0.01);
    }
  }
  const int milliseconds = static_cast<int>(std::ceil(std::clamp(wait, 0.0, 1.0) * 1000));
  static_cast<void>(poll(descriptors, count, milliseconds));  // a signal cuts it short, which is as well
  for (Part* part : m_parts) Forward(*part);
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
    std::fprintf(stderr, "%s: %s\n", part.name, line.c_str() + begin);
  }
}

void Play::ShowStatus(double left) {
  std::string line;
  for (const Part* part : {&m_server, &m_gateway, &m_bots}) {
    if (!line.empty() && !part->line.empty()) line += " | ";
    line += part->line;
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
  const bool hasServerEndedWell = m_server.child.ExitCode() == 0;
  ReportServer(m_folder.Path() / "server.json", hasServerEndedWell, m_failures);
  if (m_gateway.hasStarted) std::printf("gateway: %s\n", m_gateway.line.c_str());  // its last is what it counted
  if (m_bots.hasStarted) ReportBots(m_folder.Path() / "bots.json", m_bots.child.ExitCode() == 0, m_failures);
  for (const std::string& failure : m_failures) std::printf("FAILED: %s\n", failure.c_str());
  if (m_failures.empty()) std::printf("all went well\n");
  std::fflush(stdout);
  return m_failures.empty() ? tool::kExitGood : tool::kExitFailed;
}

}  // namespace

int RunPlay(const PlayOptions& options, const std::function<bool()>& stopAsked) {
  return Play(options, stopAsked).Run();
}

}  // namespace wobble::play
