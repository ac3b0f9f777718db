// Bytes from a terminal's keyboard, and what they mean.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wobble::terminal {

// Keys that are no character, beyond all of Unicode.
inline constexpr char32_t kKeyUp = 0x110001;
inline constexpr char32_t kKeyDown = 0x110002;
inline constexpr char32_t kKeyRight = 0x110003;
inline constexpr char32_t kKeyLeft = 0x110004;
inline constexpr char32_t kKeyEscape = 0x1B;
// No key: the terminal says that it will report releases from now on.
inline constexpr char32_t kReleasesReported = 0x110005;

struct KeyEvent {
  char32_t key = 0;  // a character as typed (with Ctrl: 0x01..0x1A), or one of the above
  bool released = false;
};

// What a terminal is sent to report releases where it can (kitty's keyboard protocol, all but its text), and to answer
// whether it will; and to stop that. Others ignore both.
inline constexpr std::string_view kAskForReleases = "\033[>15u\033[?u";
inline constexpr std::string_view kStopReleases = "\033[<u";

// Seconds after which an escape character that nothing followed was the key itself.
inline constexpr double kEscapeTimeout = 0.15;

class KeyDecoder {
 public:
  // Appends what these bytes complete. Sequences may be split anywhere; unknown ones, bytes beyond ASCII and characters
  // with Alt are ignored.
  void Feed(std::string_view bytes, double now, std::vector<KeyEvent>& events);
  // To be called now and then: an escape character left alone becomes kKeyEscape.
  void Expire(double now, std::vector<KeyEvent>& events);

 private:
  enum class State { kGround, kEscape, kControlSequence, kSingleShift };

  void Take(char byte, std::vector<KeyEvent>& events);
  void FinishSequence(char final, std::vector<KeyEvent>& events) const;

  State m_state = State::kGround;
  std::string m_parameters;  // of a control sequence so far
  double m_escapeAt = 0;
};

}  // namespace wobble::terminal
