// The results of a report: rows of measurements, figures with limits, plots.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/plot.h"

namespace wobble::bench {

// A key of the summary. NaN: it could not be measured, and keeps no limit.
struct Figure {
  std::string key;
  double value = 0;
  std::string limit;  // as shown, such as "<= 0.01"; empty: informative only
  bool kept = true;
};

struct Results {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  std::vector<Figure> figures;
  std::vector<Plot> plots;
  std::vector<std::string> remarks;  // notes needed to read the figures, a line each

  // isHeld: whether the limit is enforced; otherwise the figure only informs, such as a time in a quick run, which
  // depends on other load of the machine.
  void AddFigure(const std::string& key, double value);
  void AddFigureAtMost(const std::string& key, double value, double limit, bool isHeld = true);
  void AddFigureAtLeast(const std::string& key, double value, double limit, bool isHeld = true);
  void AddFigureWithin(const std::string& key, double value, double least, double most);
  [[nodiscard]] bool AreAllKept() const;
};

// The stored form: one object with cpu, isa, compiler, commit, rows and summary.
[[nodiscard]] std::string FormatJson(const Results& results);
// The figures and remarks as text, one per line.
[[nodiscard]] std::string FormatText(const Results& results);

// Formats like printf, for remarks and names; at most 399 characters.
[[nodiscard]] __attribute__((format(printf, 1, 2))) std::string FormatLine(const char* format, ...);

// The processor's name according to the system.
[[nodiscard]] std::string ReadCpuName();
// Of the sweep kernels that the engine has chosen: "avx2" or "avx512".
[[nodiscard]] std::string ReadInstructionSet();

}  // namespace wobble::bench
