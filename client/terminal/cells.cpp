// A frame is the difference to the one before: over ssh a picture of 80 × 24 cells would otherwise be 60 kB, thirty
// times a second. Three things keep it small: cells that look the same are skipped, a colour that is set already is not
// set again, and a difference of a few steps in 255, which nobody sees, counts as none. What the terminal really shows
// is remembered, so such differences do not add up.
//
// Every run of cells begins with an absolute position: the cursor is never left to wrap at the last column, where
// terminals differ. A frame is enclosed in the marks of synchronised output (DEC private mode 2026); terminals that do
// not know it ignore them.
#include "client/terminal/cells.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace wobble::terminal {
namespace {

// Steps of 255 that two colours may differ by and still be taken for one.
constexpr int kTolerance = 3;

// xterm's colour cube has these levels, its greys are 8, 18 ... 238.
constexpr int kLevels[] = {0, 95, 135, 175, 215, 255};

int FindLevel(int value) {
  int best = 0;
  for (int i = 1; i < 6; ++i) {
    if (std::abs(kLevels[i] - value) < std::abs(kLevels[best] - value)) best = i;
  }
  return best;
}

int Distance(Colour a, Colour b) {
  const auto square = [](int x) { return x * x; };
  return square(a.red - b.red) + square(a.green - b.green) + square(a.blue - b.blue);
}

bool AreClose(Colour a, Colour b, int tolerance) {
  return std::abs(a.red - b.red) <= tolerance && std::abs(a.green - b.green) <= tolerance &&
         std::abs(a.blue - b.blue) <= tolerance;
}

void AppendNumber(int number, std::string& bytes) { bytes += std::to_string(number); }

void AppendGlyph(char32_t glyph, std::string& bytes) {
  if (glyph == kUpperHalf) {
    bytes += "\xE2\x96\x80";
  } else {
    bytes += static_cast<char>(glyph);
  }
}

}  // namespace

Colour Show(Light light) {
  const auto show = [](float value) {
    if (!(value > 0)) return std::uint8_t{0};
    return static_cast<std::uint8_t>(std::lround(std::sqrt(std::min(value, 1.0F)) * 255));
  };
  return {show(light.x), show(light.y), show(light.z)};
}

std::uint8_t FindNearest256(Colour colour) {
  const int red = FindLevel(colour.red), green = FindLevel(colour.green), blue = FindLevel(colour.blue);
  const auto cube = static_cast<std::uint8_t>(16 + 36 * red + 6 * green + blue);
  const int mean = (colour.red + colour.green + colour.blue) / 3;
  const auto grey = static_cast<std::uint8_t>(232 + std::clamp((mean - 3) / 10, 0, 23));
  return Distance(Show256(grey), colour) < Distance(Show256(cube), colour) ? grey : cube;
}

Colour Show256(std::uint8_t index) {
  assert(index >= 16);
  if (index >= 232) {
    const auto grey = static_cast<std::uint8_t>(8 + 10 * (index - 232));
    return {grey, grey, grey};
  }
  const int cube = index - 16;
  const auto level = [](int i) { return static_cast<std::uint8_t>(kLevels[i]); };
  return {level(cube / 36), level(cube / 6 % 6), level(cube % 6)};
}

void CellGrid::Resize(int newColumns, int newRows) {
  assert(newColumns > 0 && newRows > 0);
  columns = newColumns;
  rows = newRows;
  cells.assign(static_cast<std::size_t>(columns * rows), Cell{});
}

void CellGrid::Write(int column, int row, std::string_view text, Colour foreground, Colour background) {
  if (row < 0 || row >= rows) return;
  for (const char c : text) {
    if (column >= columns) return;
    const bool printable = c >= ' ' && c <= '~';
    if (column >= 0) At(column, row) = {printable ? static_cast<char32_t>(c) : U'?', foreground, background};
    ++column;
  }
}

bool FrameEncoder::Encode(const CellGrid& wanted, std::size_t maxBytes, std::string& bytes) {
  const std::size_t begin = bytes.size();
  bytes += "\033[?2026h";
  const std::size_t empty = bytes.size();
  if (!m_known) {
    m_shown.Resize(wanted.columns, wanted.rows);  // black blanks, as after the clearing
    m_known = true;
    m_hasForeground = m_hasBackground = true;
    m_foreground = Colour{255, 255, 255};
    m_background = Colour{};
    if (m_palette == Palette::k256) m_foreground = {FindNearest256(m_foreground), 0, 0};
    if (m_palette == Palette::k256) m_background = {FindNearest256(m_background), 0, 0};
    for (Cell& cell : m_shown.cells) cell.background = m_background;
    bytes +=
        m_palette == Palette::k256 ? "\033[0;38;5;231;48;5;16m\033[2J" : "\033[0;38;2;255;255;255;48;2;0;0;0m\033[2J";
    m_column = -1;
  }
  assert(wanted.columns == m_shown.columns && wanted.rows == m_shown.rows);
  m_column = -1;  // others may have moved it
  int done = 0;
  for (; done < wanted.rows && bytes.size() - begin <= maxBytes; ++done) {
    EncodeRow(wanted, (m_nextRow + done) % wanted.rows, bytes);
  }
  m_nextRow = (m_nextRow + done) % wanted.rows;
  if (bytes.size() == empty) {
    bytes.resize(begin);
  } else {
    bytes += "\033[?2026l";
  }
  return done == wanted.rows;
}

// The cell as it is sent: two halves alike are a space, and in 256 colours `red` holds the colour's number.
Cell FrameEncoder::Convert(const Cell& cell) const {
  Cell converted = cell;
  if (m_palette == Palette::k256) {
    converted.foreground = {FindNearest256(cell.foreground), 0, 0};
    converted.background = {FindNearest256(cell.background), 0, 0};
  }
  const int tolerance = m_palette == Palette::k256 ? 0 : kTolerance;
  if (cell.glyph == kUpperHalf && AreClose(converted.foreground, converted.background, tolerance)) {
    converted.glyph = U' ';
  }
  return converted;
}

bool FrameEncoder::LooksLike(const Cell& a, const Cell& b) const {
  const int tolerance = m_palette == Palette::k256 ? 0 : kTolerance;
  return a.glyph == b.glyph && AreClose(a.background, b.background, tolerance) &&
         (a.glyph == U' ' || AreClose(a.foreground, b.foreground, tolerance));
}

void FrameEncoder::EncodeRow(const CellGrid& wanted, int row, std::string& bytes) {
  for (int column = 0; column < wanted.columns; ++column) {
    Cell cell = Convert(wanted.At(column, row));
    if (LooksLike(cell, m_shown.At(column, row))) continue;
    MoveTo(column, row, bytes);
    SetColours(cell, bytes);
    AppendGlyph(cell.glyph, bytes);
    m_shown.At(column, row) = cell;
    m_column = column + 1 < wanted.columns ? column + 1 : -1;
  }
}

void FrameEncoder::MoveTo(int column, int row, std::string& bytes) {
  if (m_column == column && m_row == row) return;
  bytes += "\033[";
  if (m_column >= 0 && m_row == row && column > m_column) {
    if (column > m_column + 1) AppendNumber(column - m_column, bytes);
    bytes += 'C';
  } else {
    AppendNumber(row + 1, bytes);
    bytes += ';';
    AppendNumber(column + 1, bytes);
    bytes += 'H';
  }
  m_column = column;
  m_row = row;
}

// Sets what has to be set; the cell's colours become those that it is really shown in.
void FrameEncoder::SetColours(Cell& cell, std::string& bytes) {
  const int tolerance = m_palette == Palette::k256 ? 0 : kTolerance / 2;
  const auto append = [&](int code, Colour colour) {
    AppendNumber(code, bytes);
    bytes += m_palette == Palette::k256 ? ";5;" : ";2;";
    AppendNumber(colour.red, bytes);
    if (m_palette == Palette::k256) return;
    bytes += ';';
    AppendNumber(colour.green, bytes);
    bytes += ';';
    AppendNumber(colour.blue, bytes);
  };
  const bool needsForeground =
      cell.glyph != U' ' && !(m_hasForeground && AreClose(cell.foreground, m_foreground, tolerance));
  const bool needsBackground = !(m_hasBackground && AreClose(cell.background, m_background, tolerance));
  if (needsForeground || needsBackground) {
    bytes += "\033[";
    if (needsForeground) append(38, m_foreground = cell.foreground);
    if (needsForeground && needsBackground) bytes += ';';
    if (needsBackground) append(48, m_background = cell.background);
    bytes += 'm';
    m_hasForeground |= needsForeground;
    m_hasBackground |= needsBackground;
  }
  cell.foreground = m_foreground;
  cell.background = m_background;
}

}  // namespace wobble::terminal
