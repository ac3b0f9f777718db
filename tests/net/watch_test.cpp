// `wobble watch` on a terminal of its own: a real server, a real pseudo-terminal, and every way to end.
//
// The test is the terminal: it reads what comes, knows what a screen would show (support/screen.h), and types. What
// must hold after any end: the alternate screen left, the cursor shown, colours plain, the keyboard's modes popped, and
// the terminal's settings what they were.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "client/client.h"
#include "protocol/transport/enet_transport.h"
#include "tests/support/screen.h"

namespace wobble::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPatience = 60;  // seconds after which anything is hung
constexpr int kColumns = 80;
constexpr int kRows = 24;

double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string ReadWhole(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<char*> MakeArguments(std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  return arguments;
}

const std::string kProgram = WOBBLE_BIN_DIR "/wobble";

std::vector<std::string> Watching(int port, const std::vector<std::string>& options = {}) {
  std::vector<std::string> words{kProgram, "watch", "127.0.0.1:" + std::to_string(port)};
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

// A server on a port of its own for as long as the test lasts.
class Wobbled {
 public:
  explicit Wobbled(int port) {
    std::vector<std::string> words{WOBBLE_BIN_DIR "/wobbled", "--scene",     "arena", "--port",
                                   std::to_string(port),      "--log-level", "error"};
    const std::vector<char*> arguments = MakeArguments(words);
    int output[2];
    if (pipe(output) != 0) return;
    m_pid = fork();
    if (m_pid == 0) {
      dup2(output[1], STDOUT_FILENO);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(output[1]);
    char byte = 0;
    std::string line;
    while (read(output[0], &byte, 1) == 1 && byte != '\n') line += byte;
    close(output[0]);
    EXPECT_THAT(line, HasSubstr("listening"));
  }
  ~Wobbled() { Kill(); }
  void Kill() {
    if (m_pid <= 0) return;
    kill(m_pid, SIGKILL);
    waitpid(m_pid, nullptr, 0);
    m_pid = -1;
  }
  void Signal(int signal) const { kill(m_pid, signal); }

 private:
  pid_t m_pid = -1;
};

// The program on a pseudo-terminal, whose screen this is.
class Session {
 public:
  explicit Session(std::vector<std::string> words, const char* colorTerm = "truecolor") : m_screen(kColumns, kRows) {
    const std::vector<char*> arguments = MakeArguments(words);
    std::string name = testing::TempDir() + "/watch_errors_XXXXXX";
    const int errors = mkstemp(name.data());
    m_errors = name;
    winsize size{};
    size.ws_col = kColumns;
    size.ws_row = kRows;
    // Opened here, not by forkpty alone: the settings can be read as long as the test holds the other end.
    EXPECT_EQ(openpty(&m_master, &m_slave, nullptr, nullptr, &size), 0);
    tcgetattr(m_slave, &m_before);
    fcntl(m_master, F_SETFL, O_NONBLOCK);
    m_pid = fork();
    if (m_pid == 0) {
      setenv("TERM", "xterm", 1);
      setenv("COLORTERM", colorTerm, 1);
      close(m_master);
      login_tty(m_slave);
      dup2(errors, STDERR_FILENO);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(errors);
  }
  ~Session() {
    if (m_pid > 0) {
      for (const pid_t child : FindChildren()) kill(child, SIGKILL);
      kill(m_pid, SIGKILL);
      waitpid(m_pid, nullptr, 0);
    }
    close(m_slave);
    close(m_master);
    std::filesystem::remove(m_errors);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void Type(const std::string& keys) { EXPECT_EQ(write(m_master, keys.data(), keys.size()), std::ssize(keys)); }
  void Resize(int columns, int rows) {
    winsize size{};
    size.ws_col = static_cast<unsigned short>(columns);
    size.ws_row = static_cast<unsigned short>(rows);
    m_screen = Screen(columns, rows);
    ioctl(m_master, TIOCSWINSZ, &size);
  }

  // As something else that writes to the same terminal; where it is still unless the whole screen is drawn anew.
  void Scribble() { m_screen.Take("\033[1;1Hscribbled"); }

  // Reads until then. False when it never was.
  bool Await(const std::function<bool()>& condition) {
    for (const double end = ReadClock() + kPatience; ReadClock() < end;) {
      Take(20);
      if (condition()) return true;
    }
    return false;
  }
  bool AwaitPlaying() {
    return Await([this] { return Status().find("kbit/s") != std::string::npos && CountHalves() > 300; });
  }
  bool AwaitStatus(const std::string& part) {
    return Await([&] { return Status().find(part) != std::string::npos; });
  }
  void Take(int milliseconds) {
    pollfd readable{m_master, POLLIN, 0};
    if (poll(&readable, 1, milliseconds) <= 0) return;
    char buffer[65536];
    const ssize_t count = read(m_master, buffer, sizeof buffer);
    if (count <= 0) return;
    m_bytes += static_cast<std::size_t>(count);
    m_screen.Take({buffer, static_cast<std::size_t>(count)});
  }

  // Exit code, as a shell has it; -1 when it did not end.
  int AwaitEnd() {
    int status = 0;
    if (!Await([&] { return waitpid(m_pid, &status, WNOHANG) == m_pid; })) return -1;
    m_pid = -1;
    Take(0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  void ExpectRestored() {
    for (int i = 0; i < 50 && (m_screen.IsSet("?1049") || !m_screen.IsSet("?25")); ++i) Take(20);
    EXPECT_FALSE(m_screen.IsSet("?1049")) << "the alternate screen";
    EXPECT_TRUE(m_screen.IsSet("?25")) << "the cursor";
    EXPECT_TRUE(m_screen.IsSet("?7")) << "wrapping";
    EXPECT_FALSE(m_screen.IsSet("?2026")) << "synchronised output";
    EXPECT_TRUE(m_screen.HasPlainColours());
    EXPECT_EQ(m_screen.KeyboardModes(), 0);
    EXPECT_THAT(m_screen.Faults(), IsEmpty());
    termios after{};
    for (int i = 0; i < 50; ++i) {  // one that lost its guardian is not waited for
      ASSERT_EQ(tcgetattr(m_slave, &after), 0);
      if (after.c_lflag == m_before.c_lflag) break;
      Take(20);
    }
    EXPECT_EQ(after.c_iflag, m_before.c_iflag);
    EXPECT_EQ(after.c_oflag, m_before.c_oflag);
    EXPECT_EQ(after.c_cflag, m_before.c_cflag);
    EXPECT_EQ(after.c_lflag, m_before.c_lflag);
    EXPECT_EQ(std::memcmp(after.c_cc, m_before.c_cc, sizeof after.c_cc), 0);
  }

  [[nodiscard]] bool IsRaw() const {
    termios now{};
    tcgetattr(m_slave, &now);
    return (now.c_lflag & ICANON) == 0;
  }
  [[nodiscard]] std::string Status() const { return m_screen.Row(m_screen.Grid().rows - 1); }
  [[nodiscard]] std::string Text() const {
    std::string text;
    for (int row = 0; row < m_screen.Grid().rows; ++row) text += m_screen.Row(row) + "\n";
    return text;
  }
  // Cells that show two different pixels.
  [[nodiscard]] int CountHalves() const {
    int count = 0;
    for (const terminal::Cell& cell : m_screen.Grid().cells) count += cell.glyph == terminal::kUpperHalf ? 1 : 0;
    return count;
  }
  [[nodiscard]] std::string Errors() const { return ReadWhole(m_errors); }
  [[nodiscard]] const Screen& Shown() const { return m_screen; }
  [[nodiscard]] pid_t Guardian() const { return m_pid; }
  [[nodiscard]] std::size_t Bytes() const { return m_bytes; }

  // Of the guardian: the process that draws.
  [[nodiscard]] std::vector<pid_t> FindChildren() const {
    std::vector<pid_t> children;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string stat = ReadWhole(entry.path() / "stat");
      const std::size_t name = stat.rfind(')');
      if (name == std::string::npos) continue;
      std::istringstream rest(stat.substr(name + 1));
      std::string state;
      pid_t parent = 0;
      rest >> state >> parent;
      if (parent == m_pid) children.push_back(std::stoi(entry.path().filename()));
    }
    return children;
  }

 private:
  Screen m_screen;
  std::filesystem::path m_errors;
  int m_master = -1;
  int m_slave = -1;
  pid_t m_pid = -1;
  termios m_before{};
  std::size_t m_bytes = 0;
};

// Somebody else who looks on and knows where the player is.
class Observer {
 public:
  explicit Observer(int port) {
    std::string error;
    auto transport = transport::EnetTransport::Connect("127.0.0.1", static_cast<std::uint16_t>(port), error);
    client::Options options;
    options.spectator = true;
    m_client = std::make_unique<client::Client>(std::move(transport), options, ReadClock());
    m_client->OnEvent([this](const client::Client::Event& event) {
      if (event.kind == wire::EventKind::Join && event.body != 0) m_body = event.body;
    });
  }
  // Of the player who joined last; nullopt before it is seen.
  std::optional<protocol::Vector3> FindPlayer() {
    m_client->Update(ReadClock());
    const auto pose = m_client->NewestPose(m_body);
    return pose ? std::optional(pose->centroid) : std::nullopt;
  }

 private:
  std::unique_ptr<client::Client> m_client;
  std::uint32_t m_body = 0;
};

bool IsStopped(pid_t process) {
  const std::string stat = ReadWhole("/proc/" + std::to_string(process) + "/stat");
  const std::size_t name = stat.rfind(')');
  return name != std::string::npos && stat.compare(name, 3, ") T") == 0;
}

TEST(Watch, ShowsTheWorldAndQuitsByKey) {
  const Wobbled server(7930);
  for (const std::string key : {"q", "\x03", "\033", "\033[113u"}) {
    Session session(Watching(7930));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    EXPECT_TRUE(session.IsRaw());
    EXPECT_TRUE(session.Shown().IsSet("?1049"));
    EXPECT_FALSE(session.Shown().IsSet("?25"));
    EXPECT_FALSE(session.Shown().IsSet("?7"));
    EXPECT_TRUE(session.AwaitStatus("13 bodies  1 player ")) << session.Status();
    session.Type(key);
    EXPECT_EQ(session.AwaitEnd(), 0);
    session.ExpectRestored();
    EXPECT_EQ(session.Errors(), "");
  }
}

TEST(Watch, KeysMoveTheOwnBody) {
  const Wobbled server(7931);
  Observer observer(7931);
  Session session(Watching(7931));
  std::optional<protocol::Vector3> at;
  const auto awaitPlayer = [&](const std::function<bool()>& condition) {
    return session.Await([&] {
      at = observer.FindPlayer();
      return at && condition();
    });
  };
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  ASSERT_TRUE(awaitPlayer([] { return true; }));
  const double landed = ReadClock() + 3;
  ASSERT_TRUE(awaitPlayer([&] { return ReadClock() > landed; }));
  const protocol::Vector3 start = *at;
  // The camera looks along (0.36, 0.93) until it is turned; a held key comes again and again.
  EXPECT_TRUE(awaitPlayer([&] {
    session.Type("w");
    return at->y - start.y > 1.5F && at->x > start.x;
  })) << "forward";
  const protocol::Vector3 far = *at;
  EXPECT_TRUE(awaitPlayer([&] {
    session.Type("\033[B");
    return at->y - far.y < -1;
  })) << "back";
  session.Type("x ");
  EXPECT_TRUE(awaitPlayer([&] { return at->z > start.z + 0.4F; })) << "up";
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
}

TEST(Watch, HelpComesAndGoes) {
  const Wobbled server(7932);
  Session session(Watching(7932, {"--spectate"}), "");
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  EXPECT_TRUE(session.AwaitStatus("12 bodies  0 players")) << session.Status();
  session.Type("?");
  EXPECT_TRUE(session.Await([&] { return session.Text().find("let go of all keys") != std::string::npos; }));
  session.Type("?");
  EXPECT_TRUE(session.Await([&] { return session.Text().find("let go of all keys") == std::string::npos; }));
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  session.ExpectRestored();
}

TEST(Watch, EndsByItselfAndCapturesItsPicture) {
  const Wobbled server(7933);
  const std::string file = testing::TempDir() + "/watch_test.svg";
  Session session(Watching(7933, {"--for", "4", "--capture", file}));
  EXPECT_EQ(session.AwaitEnd(), 0);
  session.ExpectRestored();
  const std::string svg = ReadWhole(file);
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("kbit/s"));
  std::filesystem::remove(file);
}

TEST(Watch, IsRestoredAfterEverySignal) {
  const Wobbled server(7934);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    Session session(Watching(7934));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    kill(session.Guardian(), signal);
    EXPECT_EQ(session.AwaitEnd(), 0) << "signal " << signal;
    session.ExpectRestored();
  }
}

TEST(Watch, IsRestoredWhateverBecomesOfTheDrawingProcess) {
  const Wobbled server(7935);
  for (const int signal : {SIGTERM, SIGKILL, SIGSEGV, SIGABRT}) {
    Session session(Watching(7935));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    const std::vector<pid_t> drawing = session.FindChildren();
    ASSERT_EQ(drawing.size(), 1U);
    kill(drawing[0], signal);
    EXPECT_EQ(session.AwaitEnd(), signal == SIGTERM ? 0 : 1) << "signal " << signal;
    session.ExpectRestored();
    if (signal == SIGKILL) {
      EXPECT_THAT(session.Errors(), HasSubstr("ended by signal 9"));
    }
  }
}

TEST(Watch, IsRestoredWhenItsGuardianIsKilled) {
  const Wobbled server(7936);
  Session session(Watching(7936));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  const std::vector<pid_t> drawing = session.FindChildren();
  ASSERT_EQ(drawing.size(), 1U);
  kill(session.Guardian(), SIGKILL);
  EXPECT_EQ(session.AwaitEnd(), 128 + SIGKILL);
  EXPECT_TRUE(session.Await([&] { return ReadWhole("/proc/" + std::to_string(drawing[0]) + "/cmdline").empty(); }));
  session.ExpectRestored();
}

TEST(Watch, SaysWhyItEndedOnceTheTerminalIsRestored) {
  Wobbled server(7937);
  {
    Session session(Watching(7937));
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    server.Signal(SIGSTOP);
    EXPECT_TRUE(session.AwaitStatus("nothing from the server for 2 s")) << session.Status();
    server.Signal(SIGCONT);
    server.Signal(SIGTERM);
    EXPECT_EQ(session.AwaitEnd(), 1);
    session.ExpectRestored();
    EXPECT_EQ(session.Errors().rfind("wobble watch: 127.0.0.1:7937 is no longer there: ", 0), 0U) << session.Errors();
  }
  server.Kill();
  Session session(Watching(7937));
  EXPECT_TRUE(session.Await([&] { return session.Text().find("connecting to 127.0.0.1:7937") != std::string::npos; }));
  EXPECT_EQ(session.AwaitEnd(), 2);
  session.ExpectRestored();
  EXPECT_EQ(session.Errors(), "wobble watch: no server answers at 127.0.0.1:7937\n");
}

// Under a shell that knows jobs, as people run it; it takes the terminal for its own that its standard error is.
TEST(Watch, SuspendsAndComesBack) {
  const Wobbled server(7938);
  for (const bool byKey : {true, false}) {
    Session session(
        {"/bin/bash", "-c",
         "exec 2>&1; set -m; '" + kProgram + "' watch 127.0.0.1:7938; echo left; read line; fg; echo over"});
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
    const std::vector<pid_t> jobs = session.FindChildren();
    ASSERT_EQ(jobs.size(), 1U);
    if (byKey) {
      session.Type("\x1a");
    } else {
      kill(jobs[0], SIGTSTP);
    }
    ASSERT_TRUE(session.Await([&] { return session.Text().find("left") != std::string::npos; })) << session.Text();
    EXPECT_TRUE(IsStopped(jobs[0]));
    session.ExpectRestored();
    const std::size_t before = session.Bytes();
    for (int i = 0; i < 10; ++i) session.Take(50);
    EXPECT_EQ(session.Bytes(), before) << "nothing is drawn meanwhile";
    session.Type("\n");
    ASSERT_TRUE(session.AwaitPlaying()) << session.Text();
    EXPECT_TRUE(session.IsRaw());
    session.Type("q");
    EXPECT_EQ(session.AwaitEnd(), 0);
    session.ExpectRestored();
    EXPECT_THAT(session.Text(), HasSubstr("over"));
  }
}

TEST(Watch, WithoutAShellItDoesNotStop) {
  const Wobbled server(7939);
  Session session(Watching(7939));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  session.Type("\x1a");
  for (int i = 0; i < 10; ++i) session.Take(50);
  EXPECT_FALSE(IsStopped(session.Guardian()));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text();
  EXPECT_TRUE(session.Shown().IsSet("?1049"));
  // Stopped and continued by others: the screen is drawn anew.
  kill(session.Guardian(), SIGSTOP);
  ASSERT_TRUE(session.Await([&] { return IsStopped(session.Guardian()); }));
  session.Scribble();
  ASSERT_THAT(session.Text(), HasSubstr("scribbled"));
  kill(session.Guardian(), SIGCONT);
  EXPECT_TRUE(session.Await([&] { return session.Text().find("scribbled") == std::string::npos; })) << session.Text();
  EXPECT_EQ(session.Shown().KeyboardModes(), 1);
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  session.ExpectRestored();
}

TEST(Watch, FollowsTheTerminalsSize) {
  const Wobbled server(7940);
  Session session(Watching(7940));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  session.Resize(120, 40);
  EXPECT_TRUE(session.AwaitPlaying()) << session.Text();
  session.Resize(12, 3);
  EXPECT_TRUE(session.Await([&] { return session.Text().find("too small") != std::string::npos; })) << session.Text();
  session.Resize(80, 24);
  EXPECT_TRUE(session.AwaitPlaying());
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
}

// A terminal that nobody reads: the program goes on, keeps its connection, and ends when it is told to.
TEST(Watch, IsNotHeldUpByASlowTerminal) {
  const Wobbled server(7941);
  Session session(Watching(7941));
  ASSERT_TRUE(session.AwaitPlaying()) << session.Text() << session.Errors();
  session.Type("lllllllll");  // a picture that changes all over
  usleep(1'500'000);          // reading nothing
  const std::size_t before = session.Bytes();
  session.Type("q");
  EXPECT_EQ(session.AwaitEnd(), 0);
  EXPECT_LT(session.Bytes() - before, 200'000U) << "at most what the system buffers, a picture, and the end";
  session.ExpectRestored();
}

}  // namespace
}  // namespace wobble::test
