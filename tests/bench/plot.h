// Plots: SVG by gnuplot, which runs as a child of its own.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace wobble::bench {

enum class Stroke { kLine, kDashed, kPoints, kLineAndPoints };

struct Series {
  std::string name;
  Stroke stroke = Stroke::kLine;
  std::vector<std::array<double, 2>> points;
};

struct Plot {
  std::string name;  // of the file, without ".svg"
  std::string title;
  std::string xLabel;
  std::string yLabel;
  std::vector<Series> series;
  bool logX = false;
  bool logY = false;
};

// Whether gnuplot is to be found on the path.
[[nodiscard]] bool HasGnuplot();

// Writes `folder`/`plot.name`.svg. False with one line in `error`.
[[nodiscard]] bool DrawPlot(const Plot& plot, const std::string& folder, std::string& error);

}  // namespace wobble::bench
