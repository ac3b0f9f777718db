// A state machine over single bytes after ECMA-48: a control sequence is ESC [, parameters (0x30..0x3F), intermediates
// (0x20..0x2F) and a final byte (0x40..0x7E). ESC restarts it in every state, so a broken sequence loses only itself.
//
// Kitty's protocol encodes a key as CSI code:shifted:base ; 1+modifiers:event u, an arrow as CSI 1 ; 1+modifiers:event
// A. The flags asked for are 1, 2, 4 and 8: every key as a sequence, its releases, and its character with Shift.
#include "client/terminal/keys.h"

#include <array>
#include <charconv>

namespace wobble::terminal {
namespace {

constexpr std::size_t kMaxParameters = 64;  // bytes; longer sequences are not ours
constexpr int kDelete = 0x7F;               // what the key Backspace sends
constexpr int kControl = 4;                 // bit in the modifiers
constexpr int kAlt = 2;
constexpr int kReleaseEvent = 3;

// numbers[i][j] is part j of parameter i; -1 where absent.
using Numbers = std::array<std::array<int, 3>, 2>;

// False when the text is not a list of numbers.
bool ReadNumbers(std::string_view text, Numbers& numbers) {
  for (auto& parameter : numbers) parameter.fill(-1);
  std::size_t parameter = 0, part = 0;
  while (!text.empty()) {
    if (text[0] == ';') {
      ++parameter;
      part = 0;
      text.remove_prefix(1);
    } else if (text[0] == ':') {
      ++part;
      text.remove_prefix(1);
    } else {
      int number = 0;
      const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
      if (result != std::errc{} || number < 0) return false;
      if (parameter < numbers.size() && part < numbers[parameter].size()) numbers[parameter][part] = number;
      text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
  }
  return true;
}

char32_t FindArrow(char final) {
  switch (final) {
    case 'A':
      return kKeyUp;
    case 'B':
      return kKeyDown;
    case 'C':
      return kKeyRight;
    case 'D':
      return kKeyLeft;
    default:
      return 0;
  }
}

// 0: not a key of ours. A keyboard of another script reports which Latin key is in that place.
char32_t FindKey(const std::array<int, 3>& codes, int modifiers) {
  constexpr int kShift = 1;
  int code = (modifiers & kShift) != 0 && codes[1] > 0 ? codes[1] : codes[0];
  if (code == kDelete) return kKeyBackspace;
  if (code > 0x7E && codes[2] > 0) code = codes[2];
  if (code <= 0 || code > 0x7E) return 0;
  if ((modifiers & kControl) != 0) return static_cast<char32_t>(code & 0x1F);
  return static_cast<char32_t>(code);
}

}  // namespace

void KeyDecoder::Feed(std::string_view bytes, double now, std::vector<KeyEvent>& events) {
  Expire(now, events);
  for (const char byte : bytes) {
    if (byte == '\033') m_escapeAt = now;
    Take(byte, events);
  }
}

void KeyDecoder::Expire(double now, std::vector<KeyEvent>& events) {
  if (m_state != State::kEscape || now < m_escapeAt + kEscapeTimeout) return;
  m_state = State::kGround;
  events.push_back({kKeyEscape});
}

void KeyDecoder::Take(char byte, std::vector<KeyEvent>& events) {
  if (byte == '\033') {
    if (m_state == State::kEscape) events.push_back({kKeyEscape});  // Escape pressed twice
    m_state = State::kEscape;
    return;
  }
  const auto code = static_cast<unsigned char>(byte);
  switch (m_state) {
    case State::kGround:
      if (code <= 0x7F) events.push_back({code == kDelete ? kKeyBackspace : code});
      return;
    case State::kEscape:
      m_parameters.clear();
      m_state = byte == '[' ? State::kControlSequence : byte == 'O' ? State::kSingleShift : State::kGround;
      return;
    case State::kSingleShift:
      m_state = State::kGround;
      if (const char32_t arrow = FindArrow(byte); arrow != 0) events.push_back({arrow});
      return;
    case State::kControlSequence:
      if (code >= 0x20 && code <= 0x3F) {
        if (m_parameters.size() <= kMaxParameters) m_parameters += byte;
        return;
      }
      m_state = State::kGround;
      if (code >= 0x40 && code <= 0x7E) return FinishSequence(byte, events);
      if (code < 0x20) events.push_back({code});  // interrupted by a key such as Ctrl-C
      return;
  }
}

void KeyDecoder::FinishSequence(char final, std::vector<KeyEvent>& events) const {
  if (m_parameters.size() > kMaxParameters) return;
  Numbers numbers;
  if (final == 'u' && !m_parameters.empty() && m_parameters[0] == '?') {
    // Bits of the flags that are set; without the one for releases the protocol is of no use here.
    constexpr int kReportEvents = 2;
    if (ReadNumbers(std::string_view(m_parameters).substr(1), numbers) && numbers[0][0] > 0 &&
        (numbers[0][0] & kReportEvents) != 0) {
      events.push_back({kReleasesReported});
    }
    return;
  }
  if (!ReadNumbers(m_parameters, numbers)) return;
  const int modifiers = numbers[1][0] > 0 ? numbers[1][0] - 1 : 0;
  const char32_t key = final == 'u' ? FindKey(numbers[0], modifiers) : FindArrow(final);
  if (key == 0 || (modifiers & kAlt) != 0) return;
  events.push_back({key, numbers[1][1] == kReleaseEvent});
}

}  // namespace wobble::terminal
