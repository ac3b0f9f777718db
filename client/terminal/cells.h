// The terminal's screen as a grid of character cells, and the encoder that turns a change of it into bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "client/terminal/colour.h"

namespace wobble::terminal {

// Fills the upper half of a cell with the foreground's colour and the lower with the background's: two pixels per cell.
inline constexpr char32_t kUpperHalf = U'\u2580';

struct Cell {
  char32_t glyph = U' ';  // printable ASCII or kUpperHalf
  Colour foreground;      // no meaning under a space
  Colour background;
};

struct CellGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Cell> cells;  // row by row, from the top

  // Makes all cells blank.
  void Resize(int newColumns, int newRows);
  [[nodiscard]] Cell& At(int column, int row) { return cells[static_cast<std::size_t>(row * columns + column)]; }
  [[nodiscard]] const Cell& At(int column, int row) const {
    return cells[static_cast<std::size_t>(row * columns + column)];
  }
  // Writes text in one row. Cuts off what does not fit; shows characters other than printable ASCII as '?'.
  void Write(int column, int row, std::string_view text, Colour foreground, Colour background);
};

enum class Palette {
  kTruecolour,
  k256,  // xterm's 6 × 6 × 6 colours and 24 greys
};

// Stores what the terminal shows and sends only cells that differ.
class FrameEncoder {
 public:
  explicit FrameEncoder(Palette palette) : m_palette(palette) {}

  // Forgets what the terminal shows: the next frame clears the screen and draws all cells.
  void Invalidate() { m_known = false; }

  // Appends the ANSI sequences that change the screen to `wanted`. Stops after maxBytes plus at most one row and then
  // returns false; the next call continues with the next row. `wanted` must have the size of the last frame unless
  // Invalidate was called.
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
  CellGrid m_shown;  // converted to the palette
  int m_nextRow = 0;
  int m_column = 0;  // of the cursor; -1: unknown
  int m_row = 0;
  Colour m_foreground;  // as last sent, converted to the palette
  Colour m_background;
};

}  // namespace wobble::terminal
