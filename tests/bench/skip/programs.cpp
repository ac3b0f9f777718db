#include "tests/bench/skip/programs.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <limits>

#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

// output: file descriptor for both outputs. Returns -1 when the program cannot be started.
pid_t Start(const std::vector<std::string>& command, int output) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  pid_t process = -1;
  if (posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ) != 0) process = -1;
  posix_spawn_file_actions_destroy(&actions);
  return process;
}

int Wait(pid_t process) {
  int status = -1;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::string FindProgram(const std::string& name) {
  std::error_code code;
  return std::filesystem::read_symlink("/proc/self/exe", code).parent_path() / name;
}

std::string RunAndRead(const std::vector<std::string>& command) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return "";
  const pid_t process = Start(command, ends[1]);
  close(ends[1]);
  std::string text;
  char part[4096];
  for (ssize_t count = 0; (count = read(ends[0], part, sizeof part)) > 0;) {
    text.append(part, static_cast<std::size_t>(count));
  }
  close(ends[0]);
  return process > 0 && Wait(process) == 0 ? text : "";
}

Running::Running(const std::vector<std::string>& command) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  m_process = Start(command, nowhere);
  close(nowhere);
}

Running::~Running() {
  if (m_process <= 0) return;
  kill(m_process, SIGTERM);
  Wait(m_process);
}

double Running::ReadProcessTime() const {
  clockid_t clock{};
  if (m_process <= 0 || waitpid(m_process, nullptr, WNOHANG) != 0 || clock_getcpuclockid(m_process, &clock) != 0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return ReadClock(clock);
}

}  // namespace wobble::bench
