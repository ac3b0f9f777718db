// The report of a load test: its figures, the thresholds they are judged by, and the JSON of both.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::bots {

// The figures of a run. nullopt: no data to compute it from.
struct Figures {
  std::uint64_t bots = 0;         // started
  std::uint64_t connected = 0;    // of these, how many reached play
  std::uint64_t joins = 0;        // how often a bot reached play; exceeds connected when bots come again
  std::uint64_t rejoins = 0;      // of these, how often a bot that was cut off came back by itself
  std::uint64_t disconnects = 0;  // bots that were cut off, whether or not they came back, or never reached play
  std::uint64_t sentAway = 0;     // bots that were kicked or banned; not in disconnects
  std::uint64_t snapshots = 0;    // snapshot packets, over all bots
  std::uint64_t stalls = 0;  // how often a shown body had to be held at its last pose; measured by decoding bots only
  std::uint64_t scriptErrors = 0;
  std::optional<double> joinMsP99;    // without rejoins
  std::optional<double> rejoinMsP99;  // from being cut off to playing again
  std::optional<double> snapshotAgeMsP50;
  std::optional<double> snapshotAgeMsP99;
  std::optional<double> inputToSnapshotMsP50;
  std::optional<double> kbitPerSecondPerBot;  // received, transport headers included
  std::optional<double> decodeUsP99;          // per record, including reception: see runner.cpp
  std::optional<double> lateMsP99;            // by how much the generator began its rounds late
};

// When 1% of the rounds begin later than this (ms), the figures measure the generator itself and are not valid.
inline constexpr double kMaxLateMs = 1.0;
[[nodiscard]] bool IsValid(const Figures& figures);

struct NamedFigure {
  const char* key;
  std::optional<double> value;
};
// All figures with their keys, in the order of the summary.
[[nodiscard]] std::vector<NamedFigure> ListFigures(const Figures& figures);

enum class Comparison : std::uint8_t { kLess, kLessEqual, kGreater, kGreaterEqual, kEqual, kNotEqual };

struct Threshold {
  std::string rule;  // as given on the command line
  std::string key;   // a key of ListFigures
  Comparison comparison = Comparison::kLess;
  double limit = 0;
};

// Parses 'key op number' with op one of < <= > >= == !=; blanks are allowed. On failure nullopt, with one line in
// `error` that names the fault and the allowed values.
[[nodiscard]] std::optional<Threshold> ParseThreshold(std::string_view rule, std::string& error);

struct Verdict {
  std::string rule;
  std::optional<double> value;
  bool ok = false;  // false when the figure does not exist
};
[[nodiscard]] std::vector<Verdict> JudgeThresholds(const std::vector<Threshold>& thresholds, const Figures& figures);

// Returns one flat indented JSON object that ends in a newline; figures without a value are null.
[[nodiscard]] std::string MakeSummary(const Figures& figures, const std::vector<Verdict>& verdicts);

}  // namespace wobble::bots
