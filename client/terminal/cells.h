// What a terminal shows, as a grid of character cells, and the bytes that bring it there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "client/terminal/colour.h"

namespace wobble::terminal {

// The upper half of a cell in the foreground's colour, the lower in the background's: two pixels a cell.
inline constexpr char32_t kUpperHalf = U'\u2580';

struct Cell {
  char32_t glyph = U' ';  // printable ASCII or kUpperHalf
  Colour foreground;      // means nothing under a space
  Colour background;
};

struct CellGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Cell> cells;  // row by row from the top

  // All cells are blank after it.
  void Resize(int newColumns, int newRows);
  [[nodiscard]] Cell& At(int column, int row) { return cells[static_cast<std::size_t>(row * columns + column)]; }
  [[nodiscard]] const Cell& At(int column, int row) const {
    return cells[static_cast<std::size_t>(row * columns + column)];
  }
  // What does not fit is cut off; what is no printable ASCII shows as '?'.
  void Write(int column, int row, std::string_view text, Colour foreground, Colour background);
};

enum class Palette {
  kTruecolour,
  k256,  // xterm's 6 × 6 × 6 colours and 24 greys
};

// Remembers what the terminal shows and sends only cells that differ.
class FrameEncoder {
 public:
  explicit FrameEncoder(Palette palette) : m_palette(palette) {}

  // Nothing is known of what the terminal shows; the next frame clears it and draws all.
  void Invalidate() { m_known = false; }

  // Appends what turns what the terminal shows into `wanted`, as plain ANSI. After maxBytes and at most a row more it
  // stops; then false, and the next call goes on with the row after. Of one size as before, or invalidated.
  bool Encode(const CellGrid& wanted, std::size_t maxBytes, std::string& bytes);

 private:
  void Clear(int columns, int rows, std::string& bytes);
  [[nodiscard]] Cell Convert(const Cell& cell) const;
  [[nodiscard]] bool LooksLike(const Cell& a, const Cell& b) const;
  void EncodeRow(const CellGrid& wanted, int row, std::string& bytes);
  void MoveTo(int column, int row, std::string& bytes);
  void AppendColour(int code, Colour colour, std::string& bytes) const;
  void SetColours(Cell& cell, std::string& bytes);

  Palette m_palette;
  bool m_known = false;
  CellGrid m_shown;  // in the palette's terms
  int m_nextRow = 0;
  int m_column = 0;  // of the cursor; -1: not known
  int m_row = 0;
  Colour m_foreground;  // as set last, in the palette's terms
  Colour m_background;
};

}  // namespace wobble::terminal
