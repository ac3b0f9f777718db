// Plots: SVG by gnuplot, which runs as a child of its own.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace wobble::bench {

struct Series {
  std::string name;
  bool line = true;  // else points
  std::vector<std::array<double, 2>> points;
};

struct Plot {
  std::string name;  // of the file, without ".svg"
  std::string title;
  std::string xLabel;
  std::string yLabel;
  std::vector<Series> series;
};

// Whether gnuplot is to be found on the path.
[[nodiscard]] bool HasGnuplot();

// Writes `folder`/`plot.name`.svg. False with one line in `error`.
[[nodiscard]] bool DrawPlot(const Plot& plot, const std::string& folder, std::string& error);

}  // namespace wobble::bench
