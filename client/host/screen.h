// What a fleet shows: lines, and on a terminal a status line that is written over.
#pragma once

#include <string>

namespace wobble::host {

class Screen {
 public:
  Screen();
  [[nodiscard]] bool IsTerminal() const { return m_isTerminal; }

  void Say(const std::string& line);       // on standard output
  void Complain(const std::string& line);  // on standard error
  void ShowStatus(std::string line);
  // Ends a status line; before anything else is written to the terminal.
  void EndStatus();

 private:
  bool m_isTerminal;
  bool m_isStatusOpen = false;
};

}  // namespace wobble::host
