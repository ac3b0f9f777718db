// The terminal: its modes, its size, and non-blocking reads and writes.
#pragma once

#include <termios.h>

#include <memory>
#include <string>
#include <string_view>

namespace wobble::terminal {

struct Size {
  int columns = 0;
  int rows = 0;

  bool operator==(const Size&) const = default;
};

class Terminal {
 public:
  // Opens the terminal that standard output is connected to and stores its settings. Changes nothing yet. On failure
  // (no terminal, or one that cannot show a picture) null, with one line in `error`.
  [[nodiscard]] static std::unique_ptr<Terminal> Open(std::string& error);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // Enter: alternate screen, no cursor, no wrapping, keys unbuffered. Leave: restores all. Each may be repeated.
  void Enter();
  void Leave();
  // As Leave, but keeps settings that another process has made since, and typed keys meant for it.
  void LeaveToOthers();

  // 80 x 24 when the terminal does not tell.
  [[nodiscard]] Size ReadSize() const;

  // Appends typed bytes, at most a few kilobytes. False once the terminal is gone.
  [[nodiscard]] bool Read(std::string& bytes);
  // Writes as much as the terminal takes without waiting and removes that from the front of `bytes`. False once the
  // terminal is gone.
  [[nodiscard]] bool Write(std::string& bytes);

  // For poll().
  [[nodiscard]] int Descriptor() const { return m_descriptor; }

 private:
  Terminal(int descriptor, const termios& found);
  void WriteAll(std::string bytes);

  int m_descriptor;
  bool m_entered = false;
  termios m_found;
  termios m_raw;
};

}  // namespace wobble::terminal
