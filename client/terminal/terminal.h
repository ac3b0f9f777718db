// The terminal itself: its modes, its size, and bytes to and from it without ever waiting.
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
  // The one that standard output is connected to, its settings noted. Null with one line in `error` when there is none,
  // or none that can show a picture. Changes nothing yet.
  [[nodiscard]] static std::unique_ptr<Terminal> Open(std::string& error);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // Another screen, no cursor, no wrapping, keys as they are pressed; and all back as it was found. Each may be
  // repeated.
  void Enter();
  void Leave();
  // As Leave, but settings that somebody else has made since, and keys meant for him, are left alone.
  void LeaveToOthers();

  // 80 × 24 where it is not known.
  [[nodiscard]] Size ReadSize() const;

  // What has been typed, at most a few kilobytes. False once the terminal is gone.
  [[nodiscard]] bool Read(std::string& bytes);
  // Writes what the terminal takes at once and removes it from the front of `bytes`. False once the terminal is gone.
  [[nodiscard]] bool Write(std::string& bytes);

  // To be polled.
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
