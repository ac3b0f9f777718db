// A frame is the difference to the previous one: over ssh a picture of 80 x 24 cells would otherwise be 60 kB, thirty
// times a second. Three measures keep it small: cells that look the same are skipped, a colour already set is not set
// again, and an invisible difference of a few steps in 255 counts as none. The encoder stores what the terminal really
// shows, so such differences do not add up.
//
// Every run of cells begins with an absolute position: the cursor never wraps at the last column, where terminals
// differ. A frame is enclosed in the marks of synchronised output (DEC private mode 2026); terminals that do not know
// it ignore them.
#include "client/terminal/cells.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

namespace wobble::terminal {
namespace {

// Steps of 255 by which two channels may differ and still count as equal.
constexpr int kTolerance = 3;

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
  if (!m_known) Clear(wanted.columns, wanted.rows, bytes);
  assert(wanted.columns == m_shown.columns && wanted.rows == m_shown.rows);
  m_column = -1;  // another process may have moved it
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

// Clears the screen to blanks on black and resets all that is known of it.
void FrameEncoder::Clear(int columns, int rows, std::string& bytes) {
  const bool few = m_palette == Palette::k256;
  m_foreground = few ? Colour{FindNearest256({255, 255, 255}), 0, 0} : Colour{255, 255, 255};
  m_background = few ? Colour{FindNearest256({}), 0, 0} : Colour{};
  m_shown.Resize(columns, rows);
  for (Cell& cell : m_shown.cells) cell.background = m_background;
  m_known = true;
  m_nextRow = 0;
  bytes += "\033[0;";
  AppendColour(38, m_foreground, bytes);
  bytes += ';';
  AppendColour(48, m_background, bytes);
  bytes += "m\033[2J";
}

// The cell as it is sent: two equal halves become a space; in 256 colours `red` holds the colour's index.
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

// code: 38 for the foreground, 48 for the background.
void FrameEncoder::AppendColour(int code, Colour colour, std::string& bytes) const {
  AppendNumber(code, bytes);
  bytes += m_palette == Palette::k256 ? ";5;" : ";2;";
  AppendNumber(colour.red, bytes);
  if (m_palette == Palette::k256) return;
  for (const int level : {colour.green, colour.blue}) {
    bytes += ';';
    AppendNumber(level, bytes);
  }
}

// Sets the colours that must change; the cell gets the colours it is really shown in.
void FrameEncoder::SetColours(Cell& cell, std::string& bytes) {
  const int tolerance = m_palette == Palette::k256 ? 0 : kTolerance / 2;
  const bool needsForeground = cell.glyph != U' ' && !AreClose(cell.foreground, m_foreground, tolerance);
  const bool needsBackground = !AreClose(cell.background, m_background, tolerance);
  if (needsForeground || needsBackground) {
    bytes += "\033[";
    if (needsForeground) AppendColour(38, m_foreground = cell.foreground, bytes);
    if (needsForeground && needsBackground) bytes += ';';
    if (needsBackground) AppendColour(48, m_background = cell.background, bytes);
    bytes += 'm';
  }
  cell.foreground = m_foreground;
  cell.background = m_background;
}

}  // namespace wobble::terminal
