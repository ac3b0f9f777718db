// fork, exec and two pipes. The child gets a process group of its own: a terminal sends Ctrl-C to the whole foreground
// group, so server and bots would end at the same time and the bots would count as disconnected.
//
// Between fork and exec only async-signal-safe calls are made; all strings are prepared before.
#include "client/command/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

namespace wobble::command {
namespace {

constexpr int kCannotExecute = 127;
// A line longer than this is cut, so that a child cannot fill our memory without ever ending one.
constexpr std::size_t kMaxLine = 4096;

// Variables that set an option (usage/command_line.h) are meant for the program that was started with them: a child is
// given all it needs as options. These are about the machine, and meant for all.
constexpr std::string_view kOurs = "WOBBLE_";
constexpr std::string_view kInherited[] = {
    "WOBBLE_CACHE=", "WOBBLE_UNTRAINED=", "WOBBLE_ADMIT_WHEN_BUSY=", "WOBBLE_ISA="};

// The environment of a child: pointers into that of this process, and a null.
std::vector<char*> ChooseEnvironment() {
  std::vector<char*> chosen;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const auto isIt = [text](std::string_view name) { return text.starts_with(name); };
    if (!text.starts_with(kOurs) || std::ranges::any_of(kInherited, isIt)) chosen.push_back(*variable);
  }
  chosen.push_back(nullptr);
  return chosen;
}

[[noreturn]] void BecomeProgram(char* const* arguments, char* const* environment, int output, int errors,
                                pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kCannotExecute);  // the parent died before the line above
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
  // Asio opens sockets that a program inherits: a connection would outlive the parent's end of it.
  close_range(STDERR_FILENO + 1, ~0U, 0);
  execve(arguments[0], arguments, environment);
  const char* reason = strerrordesc_np(errno);
  for (const char* text : {"cannot run ", static_cast<const char*>(arguments[0]), ": ", reason, "\n"}) {
    if (text != nullptr && write(STDERR_FILENO, text, std::strlen(text)) < 0) break;
  }
  _exit(kCannotExecute);
}

}  // namespace

Child::~Child() {
  if (IsRunning()) {
    kill(m_pid, SIGKILL);
    while (waitpid(m_pid, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Close(m_output);
  Close(m_errors);
}

bool Child::Start(const std::vector<std::string>& command, std::string& error) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  const std::vector<char*> environment = ChooseEnvironment();

  int output[2] = {-1, -1};
  int errors[2] = {-1, -1};
  const pid_t parent = getpid();
  if (pipe2(output, O_CLOEXEC | O_NONBLOCK) == 0 && pipe2(errors, O_CLOEXEC | O_NONBLOCK) == 0) m_pid = fork();
  if (m_pid < 0) {
    error = "cannot start " + command[0] + ": " + std::strerror(errno);
    for (const int descriptor : {output[0], output[1], errors[0], errors[1]}) {
      if (descriptor >= 0) close(descriptor);
    }
    return false;
  }
  if (m_pid == 0) {
    // Only our ends are non-blocking: programs do not expect EAGAIN from their standard output.
    fcntl(output[1], F_SETFL, 0);
    fcntl(errors[1], F_SETFL, 0);
    BecomeProgram(arguments.data(), environment.data(), output[1], errors[1], parent);
  }
  close(output[1]);
  close(errors[1]);
  m_output.descriptor = output[0];
  m_errors.descriptor = errors[0];
  return true;
}

void Child::Update() {
  if (m_pid > 0 && !m_exitCode) {
    int status = 0;
    if (waitpid(m_pid, &status, WNOHANG) == m_pid) {
      m_exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
  }
  // After waitpid, so that the last output of an ended child is read in full.
  Read(m_output);
  Read(m_errors);
}

void Child::Signal(int signal) const {
  if (IsRunning()) kill(m_pid, signal);
}

void Child::Read(Stream& stream) {
  char buffer[4096];
  ssize_t count = 0;
  while (stream.descriptor >= 0 && (count = read(stream.descriptor, buffer, sizeof buffer)) > 0) {
    for (const char c : std::string_view(buffer, static_cast<std::size_t>(count))) {
      if (c == '\n') {
        stream.lines.push_back(std::exchange(stream.pending, {}));
      } else if (stream.pending.size() < kMaxLine) {
        stream.pending += c;
      }
    }
  }
  if (count == 0 && stream.descriptor >= 0) Close(stream);
}

void Child::Close(Stream& stream) {
  if (stream.descriptor >= 0) close(stream.descriptor);
  stream.descriptor = -1;
  if (!stream.pending.empty()) stream.lines.push_back(std::exchange(stream.pending, {}));
}

std::vector<std::string> Child::TakeLines(Stream& stream) { return std::exchange(stream.lines, {}); }

}  // namespace wobble::command
