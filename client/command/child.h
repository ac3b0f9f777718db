// A child process whose output is read line by line.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace wobble::command {

class Child {
 public:
  Child() = default;
  ~Child();  // kills the process if it still runs
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Starts a program; command[0] is its path. The child is killed when its parent dies, and gets no Ctrl-C of the
  // terminal, only signals that the parent passes on; and none of the variables by which options of this program were
  // set (WOBBLE_PORT), but those about the machine (WOBBLE_CACHE, WOBBLE_UNTRAINED, WOBBLE_ADMIT_WHEN_BUSY). False with
  // one line in `error`; a program that cannot be executed shows as exit code 127.
  [[nodiscard]] bool Start(const std::vector<std::string>& command, std::string& error);

  // Reads the output that is there, without waiting, and notices the end.
  void Update();
  [[nodiscard]] bool IsRunning() const { return m_pid > 0 && !m_exitCode; }
  // As a shell has it: 128 + the signal when one killed the process. nullopt while it runs.
  [[nodiscard]] std::optional<int> ExitCode() const { return m_exitCode; }

  // Whole lines written since the last call.
  [[nodiscard]] std::vector<std::string> TakeOutput() { return TakeLines(m_output); }
  [[nodiscard]] std::vector<std::string> TakeErrors() { return TakeLines(m_errors); }

  void Signal(int signal) const;

  // For poll, to wait for output; -1 when closed.
  [[nodiscard]] int OutputDescriptor() const { return m_output.descriptor; }
  [[nodiscard]] int ErrorsDescriptor() const { return m_errors.descriptor; }

 private:
  struct Stream {
    int descriptor = -1;
    std::string pending;  // an unfinished line
    std::vector<std::string> lines;
  };
  static void Read(Stream& stream);
  static void Close(Stream& stream);
  static std::vector<std::string> TakeLines(Stream& stream);

  pid_t m_pid = -1;
  std::optional<int> m_exitCode;
  Stream m_output;
  Stream m_errors;
};

}  // namespace wobble::command
