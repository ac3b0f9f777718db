// What a report has found: rows of measurements, figures that must keep to a limit, plots.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/plot.h"

namespace wobble::bench {

// A key of the summary. Not a number: it could not be measured, and keeps to no limit.
struct Figure {
  std::string key;
  double value = 0;
  std::string limit;  // as it is shown, such as "<= 0.01"; empty: none, the figure only informs
  bool kept = true;
};

struct Results {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  std::vector<Figure> figures;
  std::vector<Plot> plots;
  std::vector<std::string> remarks;  // what a reader must know to read the figures, a line each

  // isHeld: else it only informs, such as a time in a quick run, which a busy machine makes what it likes.
  void AddFigure(const std::string& key, double value);
  void AddFigureAtMost(const std::string& key, double value, double limit, bool isHeld = true);
  void AddFigureAtLeast(const std::string& key, double value, double limit, bool isHeld = true);
  void AddFigureWithin(const std::string& key, double value, double least, double most);
  [[nodiscard]] bool AreAllKept() const;
};

// The stored form: one object with cpu, isa, compiler, commit, rows and summary.
[[nodiscard]] std::string FormatJson(const Results& results);
// For people, on lines of their own.
[[nodiscard]] std::string FormatText(const Results& results);

// As printf does, for remarks and names.
[[nodiscard]] __attribute__((format(printf, 1, 2))) std::string FormatLine(const char* format, ...);

// Of this machine, as the system names it.
[[nodiscard]] std::string ReadCpuName();

}  // namespace wobble::bench
