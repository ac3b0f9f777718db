// Draws plots as SVG by gnuplot, in a child process.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace wobble::bench {

enum class Stroke { kLine, kDashed, kPoints, kRings, kLineAndPoints };  // rings: points on a line

struct Series {
  std::string name;  // empty: not in the key
  Stroke stroke = Stroke::kLine;
  std::vector<std::array<double, 2>> points;
  int colour = 0;        // series of one colour belong together; 0: one of its own
  bool isRight = false;  // by the axis on the right
};

// Colours below the series: blue below 0, white at 0, red above.
struct Map {
  std::string label;                         // of the colours
  double reach = 1;                          // from 0 to the fullest colour, either way; what lies beyond has that one
  std::vector<std::array<double, 3>> cells;  // x and y of the middle, value; row by row, equally far apart
};

struct Plot {
  std::string name;  // of the file, without ".svg"
  std::string title;
  std::string xLabel;
  std::string yLabel;
  std::vector<Series> series = {};
  bool logX = false;
  bool logY = false;
  Map map = {};                          // no cells: none
  bool yFromZero = false;                // where a small difference is to look small
  std::vector<std::string> xNames = {};  // not empty: of x = 1, 2, ..., which are kinds and not quantities
  std::string rightLabel = {};           // empty: there is no axis on the right; it begins at 0
};

// Whether gnuplot is to be found on the path.
[[nodiscard]] bool HasGnuplot();

// Writes `folder`/`plot.name`.svg. False with one line in `error`.
[[nodiscard]] bool DrawPlot(const Plot& plot, const std::string& folder, std::string& error);

}  // namespace wobble::bench
