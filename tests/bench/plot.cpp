#include "tests/bench/plot.h"

#include <stdio.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace wobble::bench {
namespace {

// In gnuplot's single quotes only the quote itself is escaped, by doubling it.
std::string Quote(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

// Names of ticks are formats: each % is doubled.
std::string NameTicks(const std::vector<std::string>& names) {
  if (names.empty()) return "";
  std::string ticks = "set xrange [0.5:" + std::to_string(names.size()) + ".5]\nset xtics (";
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name;
    for (const char c : names[i]) name += c == '%' ? "%%" : std::string(1, c);
    ticks += (i > 0 ? ", " : "") + Quote(name) + " " + std::to_string(i + 1);
  }
  return ticks + ")\n";
}

const char* FindStyle(Stroke stroke) {
  switch (stroke) {
    case Stroke::kLine:
      return " with lines lw 1.5";
    case Stroke::kDashed:
      return " with linespoints lw 1.5 dt 2 pt 6 ps 0.4";
    case Stroke::kPoints:
      return " with points pt 7 ps 0.4";
    case Stroke::kRings:
      return " with points pt 6 ps 0.8 lw 1.5";
    case Stroke::kLineAndPoints:
      return " with linespoints lw 1.5 pt 7 ps 0.4";
  }
  return "";
}

std::string FindColour(int colour) { return colour > 0 ? " lc " + std::to_string(colour) : ""; }

// Draws rectangles, because gnuplot writes an image as a separate file beside the SVG.
void AddMap(const Map& map, std::ostringstream& script) {
  script << "$map << EOD\n";
  for (const auto& [x, y, value] : map.cells) script << x << ' ' << y << ' ' << value << '\n';
  script << "EOD\nset palette defined (-1 '#2166ac', 0 '#ffffff', 1 '#b2182b')\nset cbrange [" << -map.reach << ':'
         << map.reach << "]\nset cblabel " << Quote(map.label) << '\n';
}

std::string MakeScript(const Plot& plot, const std::string& file) {
  std::ostringstream script;
  script.precision(9);
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    script << "$data" << i << " << EOD\n";
    for (const auto& [x, y] : plot.series[i].points) script << x << ' ' << y << '\n';
    script << "EOD\n";
  }
  const bool hasMap = !plot.map.cells.empty();
  if (hasMap) AddMap(plot.map, script);
  script << "set terminal svg size 800,500 background 'white' noenhanced\n"
         << "set output " << Quote(file) << "\nset title " << Quote(plot.title) << "\nset xlabel " << Quote(plot.xLabel)
         << " offset 0,0.4"
         << "\nset ylabel " << Quote(plot.yLabel) << "\nset grid\nset key outside bottom horizontal\n"
         << (plot.logX ? "set logscale x\nset format x '%.0e'\n" : "")
         << (plot.logY ? "set logscale y\nset format y '%.0e'\n" : "") << (plot.yFromZero ? "set yrange [0:]\n" : "")
         << NameTicks(plot.xNames)
         << (plot.rightLabel.empty() ? "" : "set ytics nomirror\nset y2tics\nset y2range [0:]\nset y2label ")
         << (plot.rightLabel.empty() ? "" : Quote(plot.rightLabel) + "\n")
         << (hasMap ? "set autoscale fix\nplot $map with image pixels notitle, " : "plot ");
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    script << (i > 0 ? ", " : "") << "$data" << i << (plot.series[i].isRight ? " axes x1y2" : "")
           << FindStyle(plot.series[i].stroke) << FindColour(plot.series[i].colour) << " title "
           << Quote(plot.series[i].name);
  }
  script << '\n';
  return script.str();
}

}  // namespace

bool HasGnuplot() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  std::string folder;
  while (std::getline(folders, folder, ':')) {
    if (access((folder + "/gnuplot").c_str(), X_OK) == 0) return true;
  }
  return false;
}

bool DrawPlot(const Plot& plot, const std::string& folder, std::string& error) {
  const std::string file = folder + "/" + plot.name + ".svg";
  FILE* const gnuplot = popen("gnuplot", "w");
  if (gnuplot == nullptr) {
    error = "gnuplot cannot be started";
    return false;
  }
  const std::string script = MakeScript(plot, file);
  const bool written = fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  const bool good = pclose(gnuplot) == 0;  // gnuplot has printed the reason on standard error
  if (!written || !good) error = file + ": gnuplot failed";
  return written && good;
}

}  // namespace wobble::bench
