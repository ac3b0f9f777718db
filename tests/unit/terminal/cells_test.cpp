// Frames as the terminal receives them, interpreted by the test's own terminal.
#include "client/terminal/cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "client/terminal/picture_file.h"
#include "client/terminal/status.h"
#include "tests/support/screen.h"

namespace wobble::terminal {
namespace {

using test::Screen;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::string_view kNoWrap = "\033[?7l";
constexpr int kTolerance = 6;  // twice the difference that the encoder may leave

int Difference(Colour a, Colour b) {
  return std::max({std::abs(a.red - b.red), std::abs(a.green - b.green), std::abs(a.blue - b.blue)});
}

// Compares what a viewer sees of a cell: the colours of its halves, and text.
void ExpectLooksLike(const CellGrid& wanted, const CellGrid& shown, int tolerance) {
  ASSERT_EQ(wanted.cells.size(), shown.cells.size());
  for (int row = 0; row < wanted.rows; ++row) {
    for (int column = 0; column < wanted.columns; ++column) {
      const Cell& a = wanted.At(column, row);
      const Cell& b = shown.At(column, row);
      const Colour upperA = a.glyph == kUpperHalf ? a.foreground : a.background;
      const Colour upperB = b.glyph == kUpperHalf ? b.foreground : b.background;
      ASSERT_LE(Difference(a.background, b.background), tolerance) << "at " << column << ", " << row;
      ASSERT_LE(Difference(upperA, upperB), tolerance) << "at " << column << ", " << row;
      if (a.glyph != kUpperHalf) {
        ASSERT_TRUE(a.glyph == b.glyph) << "at " << column << ", " << row;
      }
    }
  }
}

class Noise {
 public:
  explicit Noise(unsigned seed) : m_random(seed) {}
  Colour MakeColour() { return {Byte(), Byte(), Byte()}; }
  Cell MakeCell() {
    if (m_random() % 4 == 0) return {static_cast<char32_t>('!' + m_random() % 90), MakeColour(), MakeColour()};
    return {kUpperHalf, MakeColour(), m_random() % 3 == 0 ? Colour{9, 9, 9} : MakeColour()};
  }
  std::mt19937& Random() { return m_random; }

 private:
  std::uint8_t Byte() { return static_cast<std::uint8_t>(m_random()); }
  std::mt19937 m_random;
};

TEST(TerminalCells, WhatIsSentShowsWhatWasWanted) {
  for (const Palette palette : {Palette::kTruecolour, Palette::k256}) {
    Noise noise(3);
    CellGrid grid;
    grid.Resize(80, 24);
    FrameEncoder encoder(palette);
    Screen screen(80, 24);
    screen.Take(kNoWrap);
    for (int frame = 0; frame < 60; ++frame) {
      const std::size_t changes = frame % 10 == 0 ? grid.cells.size() : noise.Random()() % 200;
      for (std::size_t i = 0; i < changes; ++i) grid.cells[noise.Random()() % grid.cells.size()] = noise.MakeCell();
      std::string bytes;
      ASSERT_TRUE(encoder.Encode(grid, 1 << 20, bytes));
      screen.Take(bytes);
      ASSERT_THAT(screen.Faults(), IsEmpty());
      // Steps of the colour cube are up to 95 apart.
      ExpectLooksLike(grid, screen.Grid(), palette == Palette::k256 ? 60 : kTolerance);
    }
    EXPECT_FALSE(screen.IsSet("?2026"));
  }
}

TEST(TerminalCells, AnEqualFrameCostsNothing) {
  CellGrid grid;
  grid.Resize(30, 10);
  Noise noise(5);
  for (Cell& cell : grid.cells) cell = noise.MakeCell();
  FrameEncoder encoder(Palette::kTruecolour);
  std::string bytes;
  ASSERT_TRUE(encoder.Encode(grid, 1 << 20, bytes));
  bytes.clear();
  ASSERT_TRUE(encoder.Encode(grid, 1 << 20, bytes));
  EXPECT_EQ(bytes, "");
  grid.At(7, 3) = {U'x', {1, 2, 3}, {200, 100, 50}};
  ASSERT_TRUE(encoder.Encode(grid, 1 << 20, bytes));
  EXPECT_LT(bytes.size(), 70U) << bytes;
  EXPECT_THAT(bytes, HasSubstr("\033[4;8H"));
}

TEST(TerminalCells, SmallDifferencesDoNotAddUp) {
  CellGrid grid;
  grid.Resize(4, 2);
  FrameEncoder encoder(Palette::kTruecolour);
  Screen screen(4, 2);
  for (int level = 0; level < 200; ++level) {
    const auto byte = static_cast<std::uint8_t>(level);
    for (Cell& cell : grid.cells) cell = {kUpperHalf, {byte, byte, byte}, {0, byte, 0}};
    std::string bytes;
    ASSERT_TRUE(encoder.Encode(grid, 1 << 20, bytes));
    screen.Take(bytes);
    ExpectLooksLike(grid, screen.Grid(), kTolerance);
  }
}

TEST(TerminalCells, AFrameIsBoundedAndTheRestFollows) {
  CellGrid grid;
  grid.Resize(80, 24);
  Noise noise(8);
  for (Cell& cell : grid.cells) cell = noise.MakeCell();
  FrameEncoder encoder(Palette::kTruecolour);
  Screen screen(80, 24);
  constexpr std::size_t kLimit = 8000;
  bool whole = false;
  int frames = 0;
  while (!whole && frames < 100) {
    std::string bytes;
    whole = encoder.Encode(grid, kLimit, bytes);
    EXPECT_LT(bytes.size(), kLimit + 80 * 45);
    screen.Take(bytes);
    ++frames;
  }
  ASSERT_TRUE(whole);
  EXPECT_GT(frames, 5);
  EXPECT_THAT(screen.Faults(), IsEmpty());
  ExpectLooksLike(grid, screen.Grid(), kTolerance);
}

TEST(TerminalCells, AfterInvalidationNothingIsTakenForKnown) {
  CellGrid grid;
  grid.Resize(10, 3);
  grid.Write(2, 1, "hello", {250, 250, 250}, {10, 20, 30});
  FrameEncoder encoder(Palette::kTruecolour);
  std::string bytes;
  ASSERT_TRUE(encoder.Encode(grid, 1 << 20, bytes));
  // Another size, and a screen overwritten by another program.
  CellGrid larger;
  larger.Resize(14, 4);
  larger.Write(2, 1, "hello", {250, 250, 250}, {10, 20, 30});
  Screen screen(14, 4);
  screen.Take("\033[1;1Hleftover\033[4;1Hleftover");
  encoder.Invalidate();
  bytes.clear();
  ASSERT_TRUE(encoder.Encode(larger, 1 << 20, bytes));
  screen.Take(bytes);
  ExpectLooksLike(larger, screen.Grid(), 0);
}

TEST(TerminalCells, TheTestsOwnTerminalSeesFaults) {
  Screen screen(4, 2);
  screen.Take(kNoWrap);
  screen.Take("\033[1;4Hab");
  EXPECT_EQ(screen.Faults().size(), 1U);
  screen.Take("\033[2K");
  EXPECT_EQ(screen.Faults().size(), 2U);
}

TEST(TerminalCells, Nearest256IsAsNearAsAny) {
  Noise noise(11);
  for (int i = 0; i < 300; ++i) {
    const Colour colour = noise.MakeColour();
    const auto distance = [&](Colour other) {
      const int red = colour.red - other.red, green = colour.green - other.green, blue = colour.blue - other.blue;
      return red * red + green * green + blue * blue;
    };
    int least = 1 << 30;
    for (int index = 16; index < 256; ++index)
      least = std::min(least, distance(Show256(static_cast<std::uint8_t>(index))));
    EXPECT_EQ(distance(Show256(FindNearest256(colour))), least) << "colour " << i;
  }
}

TEST(TerminalCells, TextIsCutAtTheEdgesAndForeignBytesAreHarmless) {
  CellGrid grid;
  grid.Resize(6, 2);
  grid.Write(4, 0, "abc", {}, {});
  grid.Write(-2, 1, "xyz\033", {}, {});
  grid.Write(0, 5, "nowhere", {}, {});
  EXPECT_TRUE(grid.At(5, 0).glyph == U'b');
  EXPECT_TRUE(grid.At(0, 1).glyph == U'z');
  EXPECT_TRUE(grid.At(1, 1).glyph == U'?');
}

TEST(TerminalStatus, FitsEightyColumnsAndSaysWhatItIs) {
  StatusFigures figures;
  figures.inputMs = 1234;
  figures.kbitPerSecond = 9999;
  figures.interpolationDelayMs = 1000;
  figures.stalls = 9999;
  figures.bodies = 500;
  figures.players = 100;
  EXPECT_LE(FormatStatus(figures).size(), 79U) << FormatStatus(figures);
  EXPECT_THAT(FormatStatus(figures), HasSubstr("input 1234 ms"));
  figures.inputMs.reset();
  EXPECT_THAT(FormatStatus(figures), HasSubstr("input -"));
}

TEST(TerminalStatus, TellsTheKeyForHelpInEightyColumns) {
  StatusFigures figures;
  figures.inputMs = 33;
  figures.kbitPerSecond = 371;
  figures.interpolationDelayMs = 81;
  figures.bodies = 19;
  figures.players = 7;
  CellGrid grid;
  grid.Resize(80, 24);
  WriteStatus(grid, FormatStatus(figures), "?: keys");
  EXPECT_EQ(grid.At(72, 23).glyph, U'?');
  EXPECT_EQ(grid.At(78, 23).glyph, U's');
  figures.stalls = 2117;
  WriteStatus(grid, FormatStatus(figures), "?: keys");
  EXPECT_EQ(grid.At(72, 23).glyph, U' ');
  EXPECT_EQ(grid.At(78, 23).glyph, U'?');
}

TEST(TerminalStatus, ABoxFitsAnySize) {
  for (int columns = 1; columns < 90; columns += 4) {
    for (int rows = 1; rows < 30; ++rows) {
      CellGrid grid;
      grid.Resize(columns, rows);
      WriteBox(grid, DescribeKeys({}));
      WriteStatus(grid, FormatStatus({}), "?: keys");
    }
  }
  CellGrid grid;
  grid.Resize(80, 24);
  WriteBox(grid, {"hello"});
  Screen screen(80, 24);
  std::string bytes;
  FrameEncoder encoder(Palette::kTruecolour);
  ASSERT_TRUE(encoder.Encode(grid, 1 << 20, bytes));
  screen.Take(bytes);
  EXPECT_EQ(screen.Row(11).substr(37, 5), "hello");
}

// Painting the SVG's rectangles in order gives the cells back.
TEST(TerminalPictureFile, SvgShowsTheCells) {
  Noise noise(2);
  CellGrid grid;
  grid.Resize(20, 8);
  for (Cell& cell : grid.cells) cell = {kUpperHalf, noise.MakeColour(), noise.MakeColour()};
  for (int column = 3; column < 15; ++column) grid.At(column, 2) = grid.At(column, 3) = grid.At(3, 2);
  grid.Write(0, 7, "a<b&c", {255, 255, 255}, {16, 32, 48});
  const std::string svg = MakeSvg(grid);
  std::vector<unsigned> painted(20 * 16, 0xFFFFFFFF);
  unsigned colour = 0;
  std::size_t areas = 0;
  for (std::size_t at = 0; at < svg.size(); ++at) {
    int x = 0, y = 0, width = 0, height = 0;
    if (std::sscanf(svg.c_str() + at, "<path fill=\"#%06x\"", &colour) == 1) continue;
    if (std::sscanf(svg.c_str() + at, "M%d %dh%dv%dh", &x, &y, &width, &height) != 4) continue;
    for (int i = 0; i < width * height; ++i)
      painted[static_cast<std::size_t>((y + i / width) * 20 + x + i % width)] = colour;
    areas += static_cast<std::size_t>(width * height);
  }
  EXPECT_EQ(areas, painted.size()) << "each half cell once";
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 20; ++x) {
      const Cell& cell = grid.At(x, y / 2);
      const Colour wanted = cell.glyph == kUpperHalf && y % 2 == 0 ? cell.foreground : cell.background;
      const unsigned got = painted[static_cast<std::size_t>(y * 20 + x)];
      const auto level = [got](int shift) { return static_cast<std::uint8_t>(got >> shift); };
      EXPECT_LE(Difference(wanted, {level(16), level(8), level(0)}), 2) << x << ", " << y;
    }
  }
  EXPECT_THAT(svg, HasSubstr(">a&lt;b&amp;c</text>"));
}

}  // namespace
}  // namespace wobble::terminal
