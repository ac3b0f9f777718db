// Decodes bytes from a terminal's keyboard into key events.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wobble::terminal {

// Keys without a character; the values lie beyond Unicode.
inline constexpr char32_t kKeyUp = 0x110001;
inline constexpr char32_t kKeyDown = 0x110002;
inline constexpr char32_t kKeyRight = 0x110003;
inline constexpr char32_t kKeyLeft = 0x110004;
inline constexpr char32_t kKeyBackspace = 0x110006;
inline constexpr char32_t kKeyEscape = 0x1B;
// Not a key: the terminal announces that it will report releases.
inline constexpr char32_t kReleasesReported = 0x110005;

struct KeyEvent {
  char32_t key = 0;  // a character as typed (with Ctrl: 0x01..0x1A), or a constant above
  bool released = false;
};

// kAskForReleases asks the terminal to report releases (kitty's keyboard protocol, all flags except text) and to answer
// whether it will; kStopReleases ends that. Other terminals ignore both.
inline constexpr std::string_view kAskForReleases = "\033[>15u\033[?u";
inline constexpr std::string_view kStopReleases = "\033[<u";

// Seconds after which an escape character without a successor is the Escape key.
inline constexpr double kEscapeTimeout = 0.15;

class KeyDecoder {
 public:
  // Appends the events that these bytes complete. Sequences may be split anywhere; unknown sequences, bytes beyond
  // ASCII and characters with Alt are ignored.
  void Feed(std::string_view bytes, double now, std::vector<KeyEvent>& events);
  // Turns an escape character that stayed alone into kKeyEscape. Call it regularly.
  void Expire(double now, std::vector<KeyEvent>& events);

 private:
  enum class State { kGround, kEscape, kControlSequence, kSingleShift };

  void Take(char byte, std::vector<KeyEvent>& events);
  void FinishSequence(char final, std::vector<KeyEvent>& events) const;

  State m_state = State::kGround;
  std::string m_parameters;  // of the control sequence so far
  double m_escapeAt = 0;
};

}  // namespace wobble::terminal
