// A terminal with the features that `wobble watch` uses: takes bytes and computes the screen of that size.
//
// It knows exactly the sequences that the program should send and reports all others. It also reports characters beyond
// the last column, where terminals differ; the shell around the program may wrap.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/terminal/cells.h"

namespace wobble::test {

class Screen {
 public:
  Screen(int columns, int rows) {
    m_grid.Resize(columns, rows);
    m_modes = {"?7", "?25"};  // initially a terminal wraps and shows its cursor
  }

  void Take(std::string_view bytes) {
    for (const char byte : bytes) TakeByte(byte);
  }
  // Another program has moved the cursor, perhaps in the middle of a picture: the rest of its row goes nobody knows
  // where, until the program places the cursor again.
  void LoseCursor() { m_isCursorKnown = false; }

  [[nodiscard]] const terminal::CellGrid& Grid() const { return m_grid; }
  [[nodiscard]] bool IsSet(const std::string& mode) const { return m_modes.count(mode) > 0; }
  [[nodiscard]] int KeyboardModes() const { return m_keyboardModes; }  // pushed and not popped
  [[nodiscard]] bool HasPlainColours() const { return m_plain; }
  // Unknown sequences, and characters beyond the edge while wrapping is off.
  [[nodiscard]] const std::vector<std::string>& Faults() const { return m_faults; }
  // The text of a row, half blocks as '#'.
  [[nodiscard]] std::string Row(int row) const {
    std::string text;
    for (int column = 0; column < m_grid.columns; ++column) {
      const char32_t glyph = m_grid.At(column, row).glyph;
      text += glyph == terminal::kUpperHalf ? '#' : static_cast<char>(glyph);
    }
    return text;
  }

 private:
  void TakeByte(char byte) {
    if (byte == '\033') {
      m_sequence = "\033";
      m_glyph.clear();
    } else if (!m_sequence.empty()) {
      m_sequence += byte;
      if (m_sequence.size() == 2 && byte != '[') Fault();
      const bool isFinal = m_sequence.size() > 2 && byte >= '@' && byte <= '~';
      if (isFinal) Finish(byte);
    } else if (static_cast<unsigned char>(byte) >= 0x80) {
      m_glyph += byte;
      if (m_glyph == "\xE2\x96\x80") Put(terminal::kUpperHalf);
      if (m_glyph.size() == 3) m_glyph.clear();
    } else if (byte == '\r') {
      m_column = 0;
    } else if (byte == '\n') {
      m_row = std::min(m_row + 1, m_grid.rows - 1);
    } else if (byte >= ' ') {
      Put(static_cast<char32_t>(byte));
    }
  }

  void Put(char32_t glyph) {
    if (!m_isCursorKnown) return;
    if (m_column >= m_grid.columns && IsSet("?7")) {
      m_column = 0;
      m_row = std::min(m_row + 1, m_grid.rows - 1);
    }
    if (m_column >= m_grid.columns || m_row >= m_grid.rows) {
      m_faults.push_back("a character beyond the edge of row " + std::to_string(m_row));
      return;
    }
    m_grid.At(m_column, m_row) = {glyph, m_foreground, m_background};
    ++m_column;
  }

  std::vector<int> Numbers() const {
    std::vector<int> numbers{0};
    for (const char c : m_sequence.substr(2, m_sequence.size() - 3)) {
      if (c == ';') numbers.push_back(0);
      if (c >= '0' && c <= '9') numbers.back() = numbers.back() * 10 + (c - '0');
    }
    return numbers;
  }

  void Finish(char final) {
    const std::vector<int> numbers = Numbers();
    const char mark = m_sequence[2];
    if (mark == '?' && (final == 'h' || final == 'l')) {
      const std::string mode = "?" + std::to_string(numbers[0]);
      if (final == 'h') m_modes.insert(mode);
      if (final == 'l') m_modes.erase(mode);
    } else if (final == 'u' && (mark == '>' || mark == '<')) {
      m_keyboardModes = std::max(0, m_keyboardModes + (mark == '>' ? 1 : -1));
    } else if (final == 'u' && mark == '?') {
      // a query
    } else if (final == 'H' && numbers.size() == 2) {
      m_isCursorKnown = true;
      m_row = numbers[0] - 1;
      m_column = numbers[1] - 1;
    } else if (final == 'C') {
      m_column += std::max(1, numbers[0]);
    } else if (final == 'J' && numbers[0] == 2) {
      for (terminal::Cell& cell : m_grid.cells) cell = {U' ', m_foreground, m_background};
    } else if (final == 'm') {
      SetColours(numbers);
    } else {
      return Fault();
    }
    m_sequence.clear();
  }

  void SetColours(const std::vector<int>& numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i] == 0) {
        m_foreground = {255, 255, 255};
        m_background = {};
        m_plain = true;
        continue;
      }
      terminal::Colour& colour = numbers[i] == 38 ? m_foreground : m_background;
      const std::size_t left = numbers.size() - i;
      const auto level = [&](std::size_t at) { return static_cast<std::uint8_t>(numbers[i + at]); };
      m_plain = false;
      if ((numbers[i] != 38 && numbers[i] != 48) || left < 3) return Fault();
      if (numbers[i + 1] == 2 && left >= 5) {
        colour = {level(2), level(3), level(4)};
        i += 4;
      } else if (numbers[i + 1] == 5 && numbers[i + 2] >= 16) {
        colour = terminal::Show256(level(2));
        i += 2;
      } else {
        return Fault();
      }
    }
  }

  void Fault() {
    m_faults.push_back("unknown sequence " + m_sequence.substr(1));
    m_sequence.clear();
  }

  terminal::CellGrid m_grid;
  std::set<std::string> m_modes;
  int m_keyboardModes = 0;
  bool m_plain = true;
  std::vector<std::string> m_faults;
  std::string m_sequence;  // begun and incomplete
  std::string m_glyph;     // incomplete UTF-8
  int m_column = 0;
  int m_row = 0;
  bool m_isCursorKnown = true;
  terminal::Colour m_foreground{255, 255, 255};
  terminal::Colour m_background;
};

}  // namespace wobble::test
