// The terminal is opened a second time, for a file description of our own: it must not block, and that flag belongs to
// the description, which the shell shares with our standard streams and would keep if we were killed.
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

// The alternate screen first: kitty's modes belong to a screen, and ours are then gone with it.
constexpr std::string_view kEnterScreen = "\033[?1049h";
constexpr std::string_view kPrepareScreen = "\033[?25l\033[?7l\033[0m\033[2J";
// Begins with an escape, which also ends a sequence that was broken off.
constexpr std::string_view kResetScreen = "\033[?2026l\033[0m";
constexpr std::string_view kLeaveScreen = "\033[?7h\033[?25h\033[?1049l";

// For a terminal that takes nothing, milliseconds.
constexpr int kWritePatience = 500;

// While this process is in the background the shell's terminal may be set and written to; else it would be stopped.
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
    error = std::string("the terminal cannot be opened: ") + std::strerror(errno);
    if (descriptor >= 0) close(descriptor);
    return nullptr;
  }
  const pid_t foreground = tcgetpgrp(descriptor);
  if (foreground > 0 && foreground != getpgrp()) {
    error = "in the background there are no keys to read; start it in the foreground";
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
  // Entered again, the alternate screen would take its own cursor for that of the shell. The keyboard's modes are a
  // stack: what an earlier Enter has put there is taken off first.
  WriteAll(std::string(m_entered ? "" : kEnterScreen) + std::string(kStopReleases) + std::string(kAskForReleases) +
           std::string(kPrepareScreen));
  m_entered = true;
}

void Terminal::Leave() {
  const BackgroundAllowed allowed;
  WriteAll(std::string(kResetScreen) + std::string(kStopReleases) + std::string(kLeaveScreen));
  tcflush(m_descriptor, TCIFLUSH);  // keys meant for us, not for the shell
  tcsetattr(m_descriptor, TCSANOW, &m_found);
  m_entered = false;
}

void Terminal::LeaveToOthers() {
  const BackgroundAllowed allowed;
  termios now{};
  const bool isOurs =
      tcgetattr(m_descriptor, &now) == 0 && now.c_iflag == m_raw.c_iflag && now.c_lflag == m_raw.c_lflag;
  if (isOurs) {  // before anything is written, which takes long enough for a shell to put in its own
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
    tcflush(m_descriptor, TCOFLUSH);  // a picture that nobody fetches makes room
    static_cast<void>(Write(bytes));
    return;
  }
}

}  // namespace wobble::terminal
