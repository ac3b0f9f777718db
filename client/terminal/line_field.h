// The line that somebody writes on the terminal to say it to the others. Keys beyond ASCII are not decoded (keys.h).
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "client/terminal/keys.h"
#include "protocol/limits.h"

namespace wobble::terminal {

inline constexpr char32_t kKeyEnter = '\r';

class LineField {
 public:
  void Open() { m_text.emplace(); }
  [[nodiscard]] bool IsOpen() const { return m_text.has_value(); }
  // For the screen; "" while it is closed.
  [[nodiscard]] std::string Text() const { return m_text.value_or(""); }

  // Takes a key while it is open. Returns the line when Enter has ended it, which may be empty; Escape gives it up.
  [[nodiscard]] std::optional<std::string> Take(const KeyEvent& event) {
    if (event.released || !m_text) return {};
    if (event.key == kKeyEnter || event.key == '\n') return std::exchange(m_text, {});
    if (event.key == kKeyEscape) {
      m_text.reset();
      return {};
    }
    if (event.key == kKeyBackspace && !m_text->empty()) m_text->pop_back();
    const bool isText = event.key >= 0x20 && event.key < 0x7F;
    if (isText && m_text->size() < protocol::kMaxSaidBytes) *m_text += static_cast<char>(event.key);
    return {};
  }

 private:
  std::optional<std::string> m_text;  // nullopt: closed
};

}  // namespace wobble::terminal
