// A real server, a real pseudo-terminal, and `wobble watch` between them: the test plays the terminal. It reads the
// output, computes the screen (screen.h), and types.
#pragma once

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
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/pace.h"
#include "tests/support/places.h"
#include "tests/support/screen.h"

namespace wobble::test {

inline constexpr double kPatience = 60;  // seconds after which a program counts as hung
inline constexpr int kColumns = 80;
inline constexpr int kRows = 24;

inline double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline std::string ReadWhole(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline std::vector<char*> MakeArguments(std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  return arguments;
}

inline std::vector<std::string> Watching(int port, const std::vector<std::string>& options = {}) {
  std::vector<std::string> words{FindProgram("wobble"), "watch", "127.0.0.1:" + std::to_string(port)};
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

// A server that runs as long as the object lives. scene: several with commas between are a rotation. port: 0: the
// system picks one. more: options.
class Wobbled {
 public:
  explicit Wobbled(const std::string& scene = "arena", int port = 0, const std::vector<std::string>& more = {}) {
    const char* option = scene.find(',') == std::string::npos ? "--scene" : "--rotation";
    std::vector<std::string> words{FindProgram("wobbled"), option, scene};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--port", std::to_string(port), "--cache"});
    words.insert(words.end(), {FindBases(), "--log-level", "error", "--admit-when-busy", "--key"});
    words.push_back(FindBases() + "/server.key");
    if (kIsSanitized) words.emplace_back("--untrained");  // training would take half a minute
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
    EXPECT_EQ(std::sscanf(line.c_str(), "listening on UDP port %d", &m_port), 1) << line;
  }
  ~Wobbled() { Kill(); }
  void Kill() {
    if (m_pid <= 0) return;
    kill(m_pid, SIGKILL);
    waitpid(m_pid, nullptr, 0);
    m_pid = -1;
  }
  void Signal(int signal) const { kill(m_pid, signal); }
  [[nodiscard]] int Port() const { return m_port; }

 private:
  pid_t m_pid = -1;
  int m_port = 0;
};

// The program on a pseudo-terminal, and the screen of that terminal.
class Session {
 public:
  explicit Session(std::vector<std::string> words, const char* colorTerm = "truecolor", int columns = kColumns,
                   int rows = kRows)
      : m_screen(columns, rows) {
    const std::vector<char*> arguments = MakeArguments(words);
    std::string name = testing::TempDir() + "/watch_errors_XXXXXX";
    const int errors = mkstemp(name.data());
    m_errors = name;
    winsize size{};
    size.ws_col = static_cast<unsigned short>(columns);
    size.ws_row = static_cast<unsigned short>(rows);
    // Opened here and not by forkpty alone: the settings stay readable while the test holds the other end.
    EXPECT_EQ(openpty(&m_master, &m_slave, nullptr, nullptr, &size), 0);
    tcgetattr(m_slave, &m_before);
    fcntl(m_master, F_SETFL, O_NONBLOCK);
    m_pid = fork();
    if (m_pid == 0) {
      setenv("TERM", "xterm", 1);
      setenv("COLORTERM", colorTerm, 1);
      // What it keeps is not for the user who runs the tests.
      setenv("XDG_CACHE_HOME", Kept().c_str(), 1);
      setenv("XDG_DATA_HOME", Kept().c_str(), 1);
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
    std::filesystem::remove_all(Kept());
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

  // Writes as another program on the same terminal would; the text stays unless the whole screen is redrawn.
  void Scribble() {
    m_screen.Take("\033[1;1Hscribbled");
    m_screen.LoseCursor();
  }

  // Reads until the condition holds. False when it does not within kPatience.
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

  // Exit code as a shell reports it; -1 when the program did not end.
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
    EXPECT_THAT(m_screen.Faults(), testing::IsEmpty());
    termios after{};
    for (int i = 0; i < 50; ++i) {  // a process without its guardian cannot be waited for
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
  [[nodiscard]] tcflag_t LocalModes() const {
    termios now{};
    tcgetattr(m_slave, &now);
    return now.c_lflag;
  }
  [[nodiscard]] std::string Status() const { return m_screen.Row(m_screen.Grid().rows - 1); }
  [[nodiscard]] std::string Text() const {
    std::string text;
    for (int row = 0; row < m_screen.Grid().rows; ++row) text += m_screen.Row(row) + "\n";
    return text;
  }
  // Number of cells that show two different pixels.
  [[nodiscard]] int CountHalves() const {
    int count = 0;
    for (const terminal::Cell& cell : m_screen.Grid().cells) count += cell.glyph == terminal::kUpperHalf ? 1 : 0;
    return count;
  }
  [[nodiscard]] std::string Errors() const { return ReadWhole(m_errors); }
  // The folder for what the program keeps from one run to the next.
  [[nodiscard]] std::string Kept() const { return m_errors.string() + "_kept"; }
  [[nodiscard]] const Screen& Shown() const { return m_screen; }
  [[nodiscard]] pid_t Guardian() const { return m_pid; }
  [[nodiscard]] std::size_t Bytes() const { return m_bytes; }

  // Children of the guardian: the process that draws.
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

}  // namespace wobble::test
