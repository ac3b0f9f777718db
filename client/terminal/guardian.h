// Restores the terminal however the drawing process ends.
#pragma once

#include <functional>

#include "client/terminal/terminal.h"

namespace wobble::terminal {

// The drawing process's view of the process that guards it.
class Guard {
 public:
  Guard(Terminal& terminal, int guardian) : m_terminal(terminal), m_guardian(guardian) {}

  // Ctrl-Z: leaves the terminal to the shell. Nothing may be drawn until IsPaused is false again.
  void Pause();
  // Handles signals that arrived. Returns true when the whole screen must be drawn again.
  [[nodiscard]] bool Update();
  [[nodiscard]] bool IsPaused() const { return m_paused; }
  // True when the guardian has died: the drawing process must restore the terminal itself, before anything that takes
  // time.
  [[nodiscard]] bool IsAlone() const;
  void LeaveIfAlone();

 private:
  Terminal& m_terminal;
  int m_guardian;
  bool m_paused = false;
};

// Runs `draw` in a process of its own, with the terminal entered before and left after it. Standard error of that
// process is held back until the terminal is left. Returns draw's result, or kExitFailed, with a line that names the
// signal, when the process crashed. SIGTERM, SIGINT and SIGHUP are passed on to it.
[[nodiscard]] int RunGuarded(Terminal& terminal, const std::function<int(Guard&)>& draw);

}  // namespace wobble::terminal
