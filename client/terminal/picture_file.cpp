// One path for each colour, made of all rectangles in it: a run of equal half cells is one rectangle, and a run that
// the row above has in the same place extends that rectangle downwards. Colours are rounded to steps of 4, which is
// invisible and halves the file.
#include "client/terminal/picture_file.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

namespace wobble::terminal {
namespace {

constexpr int kPixel = 8;  // units; width and height of half a cell
constexpr int kColourStep = 4;

struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;  // half cells
};

int Round(std::uint8_t value) { return std::min(255, (value + kColourStep / 2) / kColourStep * kColourStep); }

int ToNumber(Colour colour) { return Round(colour.red) << 16 | Round(colour.green) << 8 | Round(colour.blue); }

// Colour of the half cell; text is drawn over its background.
int FindColour(const CellGrid& grid, int x, int y) {
  const Cell& cell = grid.At(x, y / 2);
  return ToNumber(cell.glyph == kUpperHalf && y % 2 == 0 ? cell.foreground : cell.background);
}

std::map<int, std::vector<Rectangle>> FindRectangles(const CellGrid& grid) {
  std::map<int, std::vector<Rectangle>> found;
  for (int y = 0; y < grid.rows * 2; ++y) {
    for (int x = 0; x < grid.columns;) {
      const int colour = FindColour(grid, x, y);
      int end = x + 1;
      while (end < grid.columns && FindColour(grid, end, y) == colour) ++end;
      auto& same = found[colour];
      const auto above = std::find_if(same.rbegin(), same.rend(), [&](const Rectangle& each) {
        return each.x == x && each.width == end - x && each.y + each.height == y;
      });
      if (above != same.rend()) {
        ++above->height;
      } else {
        same.push_back({.x = x, .y = y, .width = end - x, .height = 1});
      }
      x = end;
    }
  }
  return found;
}

void AppendText(const CellGrid& grid, int row, std::string& svg) {
  const auto isText = [&](int column) { return grid.At(column, row).glyph != kUpperHalf; };
  for (int column = 0; column < grid.columns;) {
    if (!isText(column) || grid.At(column, row).glyph == U' ') {
      ++column;
      continue;
    }
    const Colour colour = grid.At(column, row).foreground;
    std::string text;
    const int begin = column;
    for (; column < grid.columns && isText(column) && grid.At(column, row).glyph != U' ' &&
           grid.At(column, row).foreground == colour;
         ++column) {
      const char c = static_cast<char>(grid.At(column, row).glyph);
      text += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    }
    char head[160];
    std::snprintf(head, sizeof head, "<text x=\"%d\" y=\"%d\" textLength=\"%d\" fill=\"#%06x\">", begin * kPixel,
                  row * 2 * kPixel + 12, (column - begin) * kPixel, static_cast<unsigned>(ToNumber(colour)));
    svg += head + text + "</text>\n";
  }
}

}  // namespace

std::string MakeSvg(const CellGrid& grid) {
  const int width = grid.columns * kPixel, height = grid.rows * 2 * kPixel;
  char line[240];
  std::snprintf(line, sizeof line,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\" "
                "shape-rendering=\"crispEdges\">\n<g transform=\"scale(%d)\">\n",
                width, height, width, height, kPixel);
  std::string svg = line;
  for (const auto& [colour, rectangles] : FindRectangles(grid)) {
    std::snprintf(line, sizeof line, "<path fill=\"#%06x\" d=\"", static_cast<unsigned>(colour));
    svg += line;
    for (const Rectangle& each : rectangles) {
      std::snprintf(line, sizeof line, "M%d %dh%dv%dh-%dz", each.x, each.y, each.width, each.height, each.width);
      svg += line;
    }
    svg += "\"/>\n";
  }
  svg += "</g>\n<g font-family=\"monospace\" font-size=\"13\" shape-rendering=\"auto\">\n";
  for (int row = 0; row < grid.rows; ++row) AppendText(grid, row, svg);
  return svg + "</g>\n</svg>\n";
}

}  // namespace wobble::terminal
