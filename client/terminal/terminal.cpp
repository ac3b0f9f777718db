// The terminal is opened a second time, for a file description of our own: it must be non-blocking, and that flag
// belongs to the description, which the shell shares with our standard streams and would keep if the process were
// killed.
#include "client/terminal/terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "client/terminal/keys.h"

namespace wobble::terminal {
namespace {

// The alternate screen comes first: kitty's modes belong to a screen and disappear with it.
constexpr std::string_view kEnterScreen = "\033[?1049h";
constexpr std::string_view kPrepareScreen = "\033[?25l\033[?7l\033[0m\033[2J";
// Begins with an escape character, which also ends an interrupted sequence.
constexpr std::string_view kResetScreen = "\033[?2026l\033[0m";
constexpr std::string_view kLeaveScreen = "\033[?7h\033[?25h\033[?1049l";

// Milliseconds to wait for a terminal that takes no bytes.
constexpr int kWritePatience = 500;

// While alive, a process in the background may set and write to the shell's terminal instead of being stopped.
class BackgroundAllowed {
 public:
  BackgroundAllowed() {
    sigset_t blocked;
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGTTOU);
    sigprocmask(SIG_BLOCK, &blocked, &m_before);
  }
  ~BackgroundAllowed() { sigprocmask(SIG_SETMASK, &m_before, nullptr); }
  BackgroundAllowed(const BackgroundAllowed&) = delete;
  BackgroundAllowed& operator=(const BackgroundAllowed&) = delete;

 private:
  sigset_t m_before{};
};

}  // namespace

std::unique_ptr<Terminal> Terminal::Open(std::string& error) {
  if (isatty(STDOUT_FILENO) == 0) {
    error = "standard output is no terminal";
    return nullptr;
  }
  const char* kind = std::getenv("TERM");
  if (kind == nullptr || *kind == '\0' || std::strcmp(kind, "dumb") == 0) {
    error = "the terminal cannot show pictures: TERM is " +
            (kind == nullptr || *kind == '\0' ? std::string("not set") : "'" + std::string(kind) + "'");
    return nullptr;
  }
  constexpr int kFlags = O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
  int descriptor = open("/proc/self/fd/1", kFlags);
  if (descriptor < 0) descriptor = open("/dev/tty", kFlags);
  termios found{};
  if (descriptor < 0 || tcgetattr(descriptor, &found) != 0) {
    error = std::string("cannot open the terminal: ") + std::strerror(errno);
    if (descriptor >= 0) close(descriptor);
    return nullptr;
  }
  const pid_t foreground = tcgetpgrp(descriptor);
  if (foreground > 0 && foreground != getpgrp()) {
    error = "a background process cannot read keys; start it in the foreground";
    close(descriptor);
    return nullptr;
  }
  return std::unique_ptr<Terminal>(new Terminal(descriptor, found));
}

Terminal::Terminal(int descriptor, const termios& found) : m_descriptor(descriptor), m_found(found), m_raw(found) {
  m_raw.c_iflag &= ~static_cast<tcflag_t>(BRKINT | ICRNL | INLCR | IGNCR | INPCK | ISTRIP | IXON);
  m_raw.c_lflag &= ~static_cast<tcflag_t>(ECHO | ECHONL | ICANON | IEXTEN | ISIG);
  m_raw.c_cc[VMIN] = 1;
  m_raw.c_cc[VTIME] = 0;
}

Terminal::~Terminal() { close(m_descriptor); }

void Terminal::Enter() {
  const BackgroundAllowed allowed;
  tcsetattr(m_descriptor, TCSANOW, &m_raw);
  // Entering the alternate screen twice would store its cursor as the shell's. The keyboard's modes are a stack, so the
  // entry of an earlier Enter is removed first.
  WriteAll(std::string(m_entered ? "" : kEnterScreen) + std::string(kStopReleases) + std::string(kAskForReleases) +
           std::string(kPrepareScreen));
  m_entered = true;
}

void Terminal::Leave() {
  const BackgroundAllowed allowed;
  WriteAll(std::string(kResetScreen) + std::string(kStopReleases) + std::string(kLeaveScreen));
  tcflush(m_descriptor, TCIFLUSH);  // typed keys were meant for this program, not for the shell
  tcsetattr(m_descriptor, TCSANOW, &m_found);
  m_entered = false;
}

void Terminal::LeaveToOthers() {
  const BackgroundAllowed allowed;
  termios now{};
  const bool isOurs =
      tcgetattr(m_descriptor, &now) == 0 && now.c_iflag == m_raw.c_iflag && now.c_lflag == m_raw.c_lflag;
  if (isOurs) {  // before any write, because writing takes long enough for a shell to set its own
    tcsetattr(m_descriptor, TCSANOW, &m_found);
    tcflush(m_descriptor, TCIFLUSH);
  }
  WriteAll(std::string(kResetScreen) + std::string(kStopReleases) + std::string(kLeaveScreen));
  m_entered = false;
}

Size Terminal::ReadSize() const {
  winsize size{};
  if (ioctl(m_descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return {80, 24};
  return {size.ws_col, size.ws_row};
}

bool Terminal::Read(std::string& bytes) {
  char buffer[4096];
  const ssize_t count = read(m_descriptor, buffer, sizeof buffer);
  if (count > 0) bytes.assign(buffer, static_cast<std::size_t>(count));
  if (count <= 0) bytes.clear();
  return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

bool Terminal::Write(std::string& bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(m_descriptor, bytes.data(), bytes.size());
    if (count <= 0) return count == 0 || errno == EAGAIN || errno == EINTR;
    bytes.erase(0, static_cast<std::size_t>(count));
  }
  return true;
}

void Terminal::WriteAll(std::string bytes) {
  while (Write(bytes) && !bytes.empty()) {
    pollfd writable{m_descriptor, POLLOUT, 0};
    if (poll(&writable, 1, kWritePatience) > 0) continue;
    tcflush(m_descriptor, TCOFLUSH);  // discards a picture that the terminal does not read
    static_cast<void>(Write(bytes));
    return;
  }
}

}  // namespace wobble::terminal
