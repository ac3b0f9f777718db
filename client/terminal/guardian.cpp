// A process cannot clean up after its own SIGKILL, nor safely after a crash. The started process therefore only guards:
// it enters the terminal, forks, waits, and leaves the terminal. The fork draws. If the guardian is killed, the kernel
// signals the fork (PR_SET_PDEATHSIG), which then leaves the terminal itself and ends. Only when both are killed at
// once does the terminal stay as it is.
//
// Suspending (Ctrl-Z, or SIGTSTP from outside): the shell knows only the guardian and waits for it to stop. The fork
// leaves the terminal and sends SIGUSR1, and the guardian stops itself; the fork keeps the connection alive, so that
// the server does not drop its player. When the shell continues the guardian, it sends SIGUSR1, and the fork enters the
// terminal again. The same happens after a stop by other means, because the screen has changed.
#include "client/terminal/guardian.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <string>

#include "client/command/clock.h"
#include "client/command/exit_codes.h"

namespace wobble::terminal {
namespace {

// State of the fork; global because a signal handler can reach nothing else.
std::atomic<bool> g_pauseAsked{false};
std::atomic<bool> g_resumed{false};

constexpr int kResumed = SIGUSR1;  // guardian to fork: enter the terminal again
constexpr int kPaused = SIGUSR1;   // fork to guardian: the terminal is left

// Seconds in which the fork must end after it was asked to; a client's goodbye takes a second at most.
constexpr double kEndPatience = 3;
constexpr std::size_t kMaxHeldBack = 64 * 1024;  // bytes kept of the fork's standard error

sigset_t MakeSet(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

const sigset_t kGuarded = MakeSet({SIGTERM, SIGINT, SIGHUP, SIGCHLD, SIGTSTP, SIGCONT, SIGUSR1});

[[noreturn]] void RunFork(Terminal& terminal, pid_t guardian, int errors, const sigset_t& mask,
                          const std::function<int(Guard&)>& draw) {
  dup2(errors, STDERR_FILENO);
  close(errors);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  struct sigaction action {};
  action.sa_handler = [](int) { g_pauseAsked = true; };
  sigaction(SIGTSTP, &action, nullptr);
  action.sa_handler = [](int) { g_resumed = true; };
  sigaction(kResumed, &action, nullptr);
  action.sa_handler = [](int) {};  // interrupts the wait, and the size is read again
  sigaction(SIGWINCH, &action, nullptr);
  sigprocmask(SIG_SETMASK, &mask, nullptr);
  Guard guard(terminal, guardian);
  const int code = guard.IsAlone() ? command::kExitFailed : draw(guard);
  guard.LeaveIfAlone();
  std::fflush(nullptr);
  _exit(code);
}

class Guardian {
 public:
  Guardian(pid_t child, int signals, int errors) : m_child(child), m_signals(signals), m_errors(errors) {}

  // Returns the fork's status as waitpid gives it.
  int Wait();
  [[nodiscard]] const std::string& HeldBack() const { return m_heldBack; }

 private:
  void HandleSignals();
  void Stop() const;
  void ReadErrors();

  pid_t m_child;
  int m_signals;
  int m_errors;
  std::string m_heldBack;
  std::optional<double> m_deadline;  // time at which the fork is killed
};

int Guardian::Wait() {
  for (;;) {
    int status = 0;
    if (waitpid(m_child, &status, WNOHANG) == m_child) {
      ReadErrors();
      return status;
    }
    if (m_deadline && command::ReadClock() >= *m_deadline) kill(m_child, SIGKILL);
    pollfd descriptors[]{{m_signals, POLLIN, 0}, {m_errors, POLLIN, 0}};
    static_cast<void>(poll(descriptors, m_errors >= 0 ? 2 : 1, m_deadline ? 100 : 1000));
    ReadErrors();
    HandleSignals();
  }
}

void Guardian::HandleSignals() {
  signalfd_siginfo signal{};
  while (read(m_signals, &signal, sizeof signal) == static_cast<ssize_t>(sizeof signal)) {
    switch (signal.ssi_signo) {
      case SIGTERM:
      case SIGINT:
      case SIGHUP:
        kill(m_child, SIGTERM);
        if (!m_deadline) m_deadline = command::ReadClock() + kEndPatience;
        break;
      case SIGTSTP:
        kill(m_child, SIGTSTP);
        break;
      case kPaused:
        Stop();
        kill(m_child, kResumed);
        break;
      case SIGCONT:
        kill(m_child, kResumed);
        break;
      default:
        break;
    }
  }
}

// Returns when the shell continues the process, or at once where no shell can.
void Guardian::Stop() const {
  const sigset_t stop = MakeSet({SIGTSTP});
  raise(SIGTSTP);
  sigprocmask(SIG_UNBLOCK, &stop, nullptr);  // the process stops here
  sigprocmask(SIG_BLOCK, &stop, nullptr);
}

void Guardian::ReadErrors() {
  char buffer[4096];
  while (m_errors >= 0) {
    const ssize_t count = read(m_errors, buffer, sizeof buffer);
    if (count < 0) return;
    if (count == 0) {
      m_errors = -1;
      return;
    }
    if (m_heldBack.size() < kMaxHeldBack) m_heldBack.append(buffer, static_cast<std::size_t>(count));
  }
}

int Conclude(int status, const std::string& heldBack) {
  std::fwrite(heldBack.data(), 1, heldBack.size(), stderr);
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  std::fprintf(stderr, "wobble watch: the drawing process was ended by signal %d (%s)\n", WTERMSIG(status),
               strsignal(WTERMSIG(status)));
  return command::kExitFailed;
}

}  // namespace

void Guard::Pause() {
  if (m_paused) return;
  m_terminal.Leave();
  m_paused = true;
  kill(m_guardian, kPaused);
}

bool Guard::Update() {
  if (g_pauseAsked.exchange(false)) Pause();
  if (!g_resumed.exchange(false)) return false;
  m_terminal.Enter();
  m_paused = false;
  return true;
}

bool Guard::IsAlone() const { return getppid() != m_guardian; }

// The shell notices the guardian's death and continues at the same time.
void Guard::LeaveIfAlone() {
  if (m_paused || !IsAlone()) return;
  m_terminal.LeaveToOthers();
  m_paused = true;  // drawing has ended
}

int RunGuarded(Terminal& terminal, const std::function<int(Guard&)>& draw) {
  int errors[2];
  if (pipe2(errors, O_CLOEXEC | O_NONBLOCK) != 0) {
    std::fprintf(stderr, "wobble watch: cannot create a pipe: %s\n", std::strerror(errno));
    return command::kExitFailed;
  }
  sigset_t before;
  sigprocmask(SIG_BLOCK, &kGuarded, &before);
  const int signals = signalfd(-1, &kGuarded, SFD_CLOEXEC | SFD_NONBLOCK);
  const pid_t guardian = getpid();
  std::fflush(nullptr);
  terminal.Enter();
  const pid_t child = signals < 0 ? -1 : fork();
  if (child == 0) {
    close(errors[0]);
    close(signals);
    RunFork(terminal, guardian, errors[1], before, draw);
  }
  const int reason = errno;
  close(errors[1]);
  int code = command::kExitFailed;
  if (child < 0) {
    terminal.Leave();
    std::fprintf(stderr, "wobble watch: cannot create the drawing process: %s\n", std::strerror(reason));
  } else {
    Guardian waiting(child, signals, errors[0]);
    const int status = waiting.Wait();
    terminal.Leave();
    code = Conclude(status, waiting.HeldBack());
  }
  close(errors[0]);
  if (signals >= 0) close(signals);
  sigprocmask(SIG_SETMASK, &before, nullptr);
  return code;
}

}  // namespace wobble::terminal
