// Whatever becomes of the process that draws, the terminal is put back as it was.
#pragma once

#include <functional>

#include "client/terminal/terminal.h"

namespace wobble::terminal {

// What the drawing process may ask of the one that guards it, and hears from it.
class Guard {
 public:
  Guard(Terminal& terminal, int guardian) : m_terminal(terminal), m_guardian(guardian) {}

  // Ctrl-Z: leaves the terminal to the shell. Until IsPaused is false again nothing may be drawn.
  void Pause();
  // Looks for signals that have come. Returns true when the terminal has to be drawn anew in full.
  [[nodiscard]] bool Update();
  [[nodiscard]] bool IsPaused() const { return m_paused; }
  // The guardian has died: the drawing process must put the terminal back itself, before anything that takes time.
  [[nodiscard]] bool IsAlone() const;
  void LeaveIfAlone();

 private:
  Terminal& m_terminal;
  int m_guardian;
  bool m_paused = false;
};

// Runs `draw` in a process of its own, with the terminal entered before and left after it. What that process writes to
// standard error is held back until the terminal is left. Returns what draw returned, or kExitFailed, with a line that
// names the signal, when it crashed. SIGTERM, SIGINT and SIGHUP are passed on to it.
[[nodiscard]] int RunGuarded(Terminal& terminal, const std::function<int(Guard&)>& draw);

}  // namespace wobble::terminal
