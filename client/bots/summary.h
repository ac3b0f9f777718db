// What a load test reports: its figures, the rules they are held against, and the JSON of both.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::bots {

// nullopt: there was nothing to measure it from.
struct Figures {
  std::uint64_t bots = 0;       // started
  std::uint64_t connected = 0;  // of these, reached play
  std::uint64_t joins = 0;      // times that a bot reached play: more than connected when scripts leave and join again
  std::uint64_t disconnects = 0;  // bots that ended unasked or never reached play
  std::uint64_t snapshots = 0;    // packets, over all bots
  std::uint64_t stalls = 0;       // times that a shown body had to be held; only decoding bots can tell
  std::uint64_t scriptErrors = 0;
  std::optional<double> joinMsP99;
  std::optional<double> snapshotAgeMsP50;
  std::optional<double> snapshotAgeMsP99;
  std::optional<double> inputToSnapshotMsP50;
  std::optional<double> kbitPerSecondPerBot;  // received, transport's headers included
  std::optional<double> decodeUsP99;          // of a record, reception included: see runner.cpp
  std::optional<double> lateMsP99;            // how late the generator began its rounds
};

// Later than this in one round of a hundred, and the generator measured itself, ms.
inline constexpr double kMaxLateMs = 1.0;
[[nodiscard]] bool IsValid(const Figures& figures);

struct NamedFigure {
  const char* key;
  std::optional<double> value;
};
// Every figure under its key in the summary, in the summary's order.
[[nodiscard]] std::vector<NamedFigure> ListFigures(const Figures& figures);

enum class Comparison : std::uint8_t { kLess, kLessEqual, kGreater, kGreaterEqual, kEqual, kNotEqual };

struct Threshold {
  std::string rule;  // as it was written
  std::string key;   // one of ListFigures
  Comparison comparison = Comparison::kLess;
  double limit = 0;
};

// 'key op number' with op one of < <= > >= == !=, blanks allowed. nullopt with one line in `error` that names what is
// wrong and what would be right.
[[nodiscard]] std::optional<Threshold> ParseThreshold(std::string_view rule, std::string& error);

struct Verdict {
  std::string rule;
  std::optional<double> value;
  bool ok = false;  // a figure that does not exist holds no rule
};
[[nodiscard]] std::vector<Verdict> JudgeThresholds(const std::vector<Threshold>& thresholds, const Figures& figures);

// One flat JSON object, indented, ending in a newline; figures that do not exist are null.
[[nodiscard]] std::string MakeSummary(const Figures& figures, const std::vector<Verdict>& verdicts);

}  // namespace wobble::bots
