// Instructions per step, counted by callgrind, which does not know AVX-512: eight lanes. Bodies of springs alone, and
// of springs and gas, in the air, on the engine's normal path, which includes all checks for gas, a plane constraint, a
// push and a ground. They are compared with the same sweep compiled without any of these, called directly.
//
// A separate program is run twice for the engine, with more and with fewer steps: the difference excludes one-time
// costs. For the bare sweep callgrind counts its functions alone.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/bench/skip/experiments.h"
#include "tests/bench/skip/programs.h"

namespace wobble::bench {
namespace {

constexpr int kFewSteps = 8;
constexpr int kManySteps = 40;
constexpr const char* kKinds[] = {"gas", "solid"};

// Instructions of the matching functions including their callees; NaN when they could not be counted.
double CountInstructions(const std::string& functions, const std::string& kind, const std::string& sweep, int steps) {
  const std::string text =
      RunAndRead({"valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=" + functions,
                  FindProgram("wobble_terms"), kind, sweep, std::to_string(steps)});
  const std::string mark = "Collected : ";
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return std::numeric_limits<double>::quiet_NaN();
  return std::atof(text.c_str() + at + mark.size());
}

double CountOfEngine(const std::string& kind) {
  const std::string functions = "*IntegrateBatch*";
  const double many = CountInstructions(functions, kind, "engine", kManySteps);
  return (many - CountInstructions(functions, kind, "engine", kFewSteps)) / (kManySteps - kFewSteps);
}

}  // namespace

void MeasureTerms(Bench& bench) {
  double most = 0;
  for (const char* kind : kKinds) {
    const double engine = CountOfEngine(kind);
    const double bare = CountInstructions("*SweepBare*", kind, "bare", kFewSteps) / kFewSteps;
    if (bench.progress.IsStopAsked()) return;
    bench.results.rows.push_back(
        {{"experiment", "terms"}, {"has", kind}, {"instructions", engine}, {"instructions_bare", bare}});
    const double ratio = bare > 0 ? engine / bare : std::numeric_limits<double>::quiet_NaN();
    most = std::isnan(ratio) ? ratio : std::max(most, ratio);
    if (std::isnan(most)) break;
  }
  bench.results.AddFigureAtMost("term_ratio_max", most, 1.02);
}

}  // namespace wobble::bench
