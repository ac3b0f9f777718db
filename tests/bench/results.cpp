#include "tests/bench/results.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <fstream>

#include "server/physics/kernels/kernels.h"
#include "tests/bench/commit.h"

namespace wobble::bench {
namespace {

std::string FormatNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// JSON cannot represent NaN and infinity: they become null.
nlohmann::ordered_json MakeNumber(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == std::floor(value) && std::fabs(value) < 9e15) return static_cast<std::int64_t>(value);
  return value;
}

std::string FindCompiler() {
#ifdef __clang__
  return "clang " __clang_version__;
#else
  return "gcc " __VERSION__;
#endif
}

}  // namespace

std::string ReadInstructionSet() {
  return physics::FindSweepKernels<float>(physics::kWidestPack).back().width == 16 ? "avx512" : "avx2";
}

void Results::AddFigure(const std::string& key, double value) { figures.push_back({key, value, "", true}); }

void Results::AddFigureAtMost(const std::string& key, double value, double limit, bool isHeld) {
  if (!isHeld) return AddFigure(key, value);
  figures.push_back({key, value, "<= " + FormatNumber(limit), value <= limit});
}

void Results::AddFigureAtLeast(const std::string& key, double value, double limit, bool isHeld) {
  if (!isHeld) return AddFigure(key, value);
  figures.push_back({key, value, ">= " + FormatNumber(limit), value >= limit});
}

void Results::AddFigureWithin(const std::string& key, double value, double least, double most) {
  figures.push_back({key, value, FormatNumber(least) + " to " + FormatNumber(most), value >= least && value <= most});
}

bool Results::AreAllKept() const {
  return std::all_of(figures.begin(), figures.end(), [](const Figure& figure) { return figure.kept; });
}

std::string FormatLine(const char* format, ...) {
  char line[400];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  return line;
}

std::string ReadCpuName() {
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string FormatJson(const Results& results) {
  nlohmann::ordered_json json;
  json["cpu"] = ReadCpuName();
  json["isa"] = ReadInstructionSet();
  json["compiler"] = FindCompiler();
  json["commit"] = kCommit;
  json["rows"] = results.rows;
  json["summary"] = nlohmann::ordered_json::object();
  for (const Figure& figure : results.figures) json["summary"][figure.key] = MakeNumber(figure.value);
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string FormatText(const Results& results) {
  std::string text;
  for (const std::string& remark : results.remarks) text += remark + "\n";
  for (const Figure& figure : results.figures) {
    char line[160];
    std::snprintf(line, sizeof line, "%-30s %-12s %-14s%s\n", figure.key.c_str(), FormatNumber(figure.value).c_str(),
                  figure.limit.c_str(),
                  figure.limit.empty() ? ""
                  : figure.kept        ? " ok"
                                       : " MISSED");
    text += line;
  }
  return text;
}

}  // namespace wobble::bench
