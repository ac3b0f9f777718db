// Real programs as children rather than a server in this process: what is shown here is what people will run, and a
// crash of one part is seen as what it is.
//
// The order of the end matters: bots first, so that they say goodbye to a server that still lives, then the server.
// Both are asked by SIGINT and killed when they do not listen; what they measured is read from their summary files.
#include "client/play/play.h"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "client/play/child.h"
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

class Play {
 public:
  Play(const PlayOptions& options, const std::function<bool()>& stopAsked)
      : m_options(options), m_stopAsked(stopAsked), m_terminal(isatty(STDOUT_FILENO) != 0) {}

  int Run();

 private:
  bool StartServer();
  bool StartBots();
  bool AwaitServer();
  void Watch();
  void End(Child& child, const char* name);

  void Update(double until);
  void Forward(Child& child, const char* name);
  void ShowStatus(double left);
  void EndStatusLine();
  void Fail(const std::string& reason);

  [[nodiscard]] nlohmann::json ReadSummary(const char* file, const Child& child);
  void ReportServer();
  void ReportBots();

  const PlayOptions& m_options;
  const std::function<bool()>& m_stopAsked;
  bool m_terminal;
  bool m_statusOpen = false;
  bool m_ready = false;
  std::string m_serverLine;
  std::string m_botsLine;
  std::vector<std::string> m_failures;
  TemporaryFolder m_folder;
  Child m_server;
  Child m_bots;
};

int Play::Run() {
  if (m_folder.Path().empty()) {
    std::fprintf(stderr, "wobble play: no temporary folder can be made\n");
    return tool::kExitFailed;
  }
  if (!StartServer() || !AwaitServer()) {
    EndStatusLine();
    if (m_server.ExitCode() == tool::kExitBadUse) return tool::kExitBadUse;  // the server has said what is wrong
    for (const std::string& failure : m_failures) std::fprintf(stderr, "wobble play: %s\n", failure.c_str());
    return m_failures.empty() ? tool::kExitGood : tool::kExitFailed;
  }
  const std::string self = std::filesystem::proximate(m_options.programFolder / "wobble").string();
  std::printf("scene %s on UDP port %u; watch it from another terminal with: %s watch 127.0.0.1:%u; Ctrl-C ends all\n",
              m_options.scene.c_str(), m_options.port, self.c_str(), m_options.port);
  std::fflush(stdout);

  const bool botsStarted = m_options.bots > 0 && StartBots();
  Watch();
  EndStatusLine();
  End(m_bots, "bots");
  End(m_server, "server");
  ReportServer();
  if (botsStarted) ReportBots();
  for (const std::string& failure : m_failures) std::printf("FAILED: %s\n", failure.c_str());
  if (m_failures.empty()) std::printf("all went well\n");
  std::fflush(stdout);
  return m_failures.empty() ? tool::kExitGood : tool::kExitFailed;
}

bool Play::StartServer() {
  std::string error;
  if (m_server.Start({(m_options.programFolder / "wobbled").string(), "--scene", m_options.scene, "--port",
                      std::to_string(m_options.port), "--max-clients",
                      std::to_string(kGuests + static_cast<unsigned>(m_options.bots)), "--status", "1", "--log-level",
                      "warn", "--summary", (m_folder.Path() / "server.json").string()},
                     error)) {
    return true;
  }
  Fail(error);
  return false;
}

bool Play::StartBots() {
  std::string error;
  if (m_bots.Start(
          {(m_options.programFolder / "wobble").string(), "bots", "127.0.0.1:" + std::to_string(m_options.port),
           "--script", (m_options.programFolder / "scripts" / "wander.lua").string(), "--count",
           std::to_string(m_options.bots), "--ramp", "1", "--status", "1", "--summary",
           (m_folder.Path() / "bots.json").string()},
          error)) {
    return true;
  }
  Fail(error);
  return false;
}

// False when it did not get ready; without a failure noted when a stop was asked for meanwhile.
bool Play::AwaitServer() {
  const double begin = tool::ReadClock();
  while (!m_ready && m_server.IsRunning() && !m_stopAsked() && tool::ReadClock() < begin + kStartPatience) {
    Update(begin + kStartPatience);
  }
  if (m_ready && m_server.IsRunning()) return true;
  if (!m_server.IsRunning()) {
    Fail("the server ended at once with exit code " + std::to_string(m_server.ExitCode().value_or(0)));
  } else if (!m_stopAsked()) {
    Fail("the server was not ready after 30 s");
  }
  End(m_server, "server");
  return false;
}

void Play::Watch() {
  const double begin = tool::ReadClock();
  const double end = m_options.duration > 0 ? begin + m_options.duration : INFINITY;
  double nextStatus = begin + kStatusEvery + kStatusLag;
  while (!m_stopAsked() && tool::ReadClock() < end) {
    Update(std::min(nextStatus, end));
    if (!m_server.IsRunning()) {
      return Fail("the server ended early with exit code " + std::to_string(m_server.ExitCode().value_or(0)));
    }
    if (m_options.bots > 0 && !m_bots.IsRunning()) {
      return Fail("the bots ended early with exit code " + std::to_string(m_bots.ExitCode().value_or(0)));
    }
    if (tool::ReadClock() < nextStatus) continue;
    nextStatus += kStatusEvery;
    ShowStatus(end - tool::ReadClock());
  }
}

// Asks a child that still runs to end, and sees to it that it does.
void Play::End(Child& child, const char* name) {
  if (!child.IsRunning()) return;
  child.Signal(SIGINT);
  const double deadline = tool::ReadClock() + kEndPatience;
  while (child.IsRunning() && tool::ReadClock() < deadline) Update(deadline);
  if (child.IsRunning()) {
    Fail(std::string("the ") + name + " did not end within " + std::to_string(std::lround(kEndPatience)) +
         " s of being asked, and had to be killed");
    child.Signal(SIGKILL);
    while (child.IsRunning()) Update(tool::ReadClock() + 1);
    return;
  }
  // Stopped in its first moments, before it listened for the signal: an end as asked for.
  const bool deafYet = child.ExitCode() == 128 + SIGINT && m_stopAsked();
  if (child.ExitCode() != 0 && !deafYet) {
    Fail(std::string("the ") + name + " ended with exit code " + std::to_string(child.ExitCode().value_or(0)));
  }
}

// Waits for output of the children until then at the latest, and passes it on. A child's end closes its output, but
// may be noticed a little later: a closed stream is polled no more, so that wait is cut short.
void Play::Update(double until) {
  pollfd descriptors[4];
  nfds_t count = 0;
  double wait = until - tool::ReadClock();
  for (const Child* child : {&m_server, &m_bots}) {
    for (const int descriptor : {child->OutputDescriptor(), child->ErrorsDescriptor()}) {
      if (descriptor >= 0) descriptors[count++] = {descriptor, POLLIN, 0};
      if (descriptor < 0 && child->IsRunning()) wait = std::min(wait, 0.01);
    }
  }
  const int milliseconds = static_cast<int>(std::ceil(std::clamp(wait, 0.0, 1.0) * 1000));
  static_cast<void>(poll(descriptors, count, milliseconds));  // a signal cuts it short, which is as well
  Forward(m_server, "server");
  Forward(m_bots, "bots");
}

void Play::Forward(Child& child, const char* name) {
  child.Update();
  for (std::string& line : child.TakeOutput()) {
    if (&child == &m_server && line.rfind("listening", 0) == 0) {
      m_ready = true;
      continue;
    }
    line.erase(0, line.find_first_not_of(' '));
    (&child == &m_server ? m_serverLine : m_botsLine) = std::move(line);
  }
  const std::string_view program = &child == &m_server ? "wobbled: " : "wobble bots: ";
  for (const std::string& line : child.TakeErrors()) {
    EndStatusLine();
    const std::size_t begin = line.rfind(program, 0) == 0 ? program.size() : 0;
    std::fprintf(stderr, "%s: %s\n", name, line.c_str() + begin);
  }
}

void Play::ShowStatus(double left) {
  std::string line;
  for (const std::string* part : {&m_serverLine, &m_botsLine}) {
    if (!line.empty() && !part->empty()) line += " | ";
    line += *part;
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

nlohmann::json Play::ReadSummary(const char* file, const Child& child) {
  std::ifstream stream(m_folder.Path() / file);
  nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  if (summary.is_object()) return summary;
  if (child.ExitCode() == 0) Fail(std::string(file) + ", the summary, is missing or broken");
  return nlohmann::json::object();
}

// A figure as text, "?" when it is missing or null.
std::string Show(const nlohmann::json& summary, const char* key, int decimals = 0) {
  const auto figure = summary.find(key);
  if (figure == summary.end() || !figure->is_number()) return "?";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, figure->get<double>());
  return text;
}

double Number(const nlohmann::json& summary, const char* key) {
  const auto figure = summary.find(key);
  return figure != summary.end() && figure->is_number() ? figure->get<double>() : 0;
}

void Play::ReportServer() {
  const nlohmann::json summary = ReadSummary("server.json", m_server);
  if (summary.empty()) return;
  std::printf("server: %s ticks of %s ms (p50), %s ms (p99), %s overruns, %s joins, %s disconnects, %s non-finite\n",
              Show(summary, "ticks").c_str(), Show(summary, "tick_ms_p50", 2).c_str(),
              Show(summary, "tick_ms_p99", 2).c_str(), Show(summary, "overruns").c_str(),
              Show(summary, "joins").c_str(), Show(summary, "disconnects").c_str(),
              Show(summary, "non_finite").c_str());
  if (Number(summary, "non_finite") > 0) Fail("bodies became non-finite");
  // No failure: a busy machine can be late for a tick, and the world then only runs behind for a moment.
  if (Number(summary, "overruns") > 0)
    std::printf("warning: %s ticks took too long\n", Show(summary, "overruns").c_str());
}

void Play::ReportBots() {
  const nlohmann::json summary = ReadSummary("bots.json", m_bots);
  if (summary.empty()) return;
  std::printf("bots: %s of %u connected, %s disconnects, %s script errors, snapshots %s ms old (p50), %s ms (p99)\n",
              Show(summary, "connected").c_str(), m_options.bots, Show(summary, "disconnects").c_str(),
              Show(summary, "script_errors").c_str(), Show(summary, "snapshot_age_ms_p50", 1).c_str(),
              Show(summary, "snapshot_age_ms_p99", 1).c_str());
  if (Number(summary, "connected") < Number(summary, "bots")) Fail("not all bots connected");
  if (Number(summary, "disconnects") > 0) Fail("bots were disconnected");
  if (Number(summary, "script_errors") > 0) Fail("scripts failed");
}

}  // namespace

int RunPlay(const PlayOptions& options, const std::function<bool()>& stopAsked) {
  return Play(options, stopAsked).Run();
}

}  // namespace wobble::play
