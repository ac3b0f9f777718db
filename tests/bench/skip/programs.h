// The programs that lie beside the laboratory's, run as children.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace wobble::bench {

// Of the program of that name in the laboratory's own folder.
[[nodiscard]] std::string FindProgram(const std::string& name);

// What the command, looked for on the path, has written to both outputs by its end; empty when it failed.
[[nodiscard]] std::string RunAndRead(const std::vector<std::string>& command);

// A program that runs until this ends, its outputs thrown away.
class Running {
 public:
  explicit Running(const std::vector<std::string>& command);
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  // That all of its threads have worked, s; not a number once it has ended.
  [[nodiscard]] double ReadProcessTime() const;

 private:
  pid_t m_process = -1;
};

}  // namespace wobble::bench
