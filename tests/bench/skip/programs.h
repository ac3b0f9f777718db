// Runs the programs in the laboratory's own folder as child processes.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace wobble::bench {

// Path of the program of that name in the laboratory's folder.
[[nodiscard]] std::string FindProgram(const std::string& name);

// Runs a command, found on the PATH, to its end and returns both of its outputs; empty when it failed.
[[nodiscard]] std::string RunAndRead(const std::vector<std::string>& command);

// A child process that is ended by the destructor; its outputs are discarded.
class Running {
 public:
  explicit Running(const std::vector<std::string>& command);
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  // Processor time of all its threads, s; NaN once it has ended.
  [[nodiscard]] double ReadProcessTime() const;

 private:
  pid_t m_process = -1;
};

}  // namespace wobble::bench
