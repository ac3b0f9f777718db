// One list, ListFigures, gives the summary its keys and the thresholds their names: every figure of the summary can be
// used in a threshold, and no threshold can name anything else.
//
// A threshold on a figure that does not exist fails: a load test in which no snapshot arrived must not pass
// 'snapshot_age_ms_p99<150'.
#include "client/bots/summary.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/version.h"

namespace wobble::bots {
namespace {

struct Operator {
  std::string_view text;
  Comparison comparison;
};
// Operators of two characters first, so that "<=" is not read as "<".
constexpr Operator kOperators[] = {
    {"<=", Comparison::kLessEqual}, {">=", Comparison::kGreaterEqual}, {"==", Comparison::kEqual},
    {"!=", Comparison::kNotEqual},  {"<", Comparison::kLess},          {">", Comparison::kGreater},
};

std::string_view TrimBlanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool Holds(Comparison comparison, double value, double limit) {
  switch (comparison) {
    case Comparison::kLess:
      return value < limit;
    case Comparison::kLessEqual:
      return value <= limit;
    case Comparison::kGreater:
      return value > limit;
    case Comparison::kGreaterEqual:
      return value >= limit;
    case Comparison::kEqual:
      return value == limit;
    case Comparison::kNotEqual:
      return value != limit;
  }
  return false;
}

// Counts are written as integers; other figures with three decimals, finer than their precision.
nlohmann::ordered_json MakeNumber(std::optional<double> value) {
  if (!value) return nullptr;
  if (*value == std::floor(*value) && std::abs(*value) < 9e15) return static_cast<std::int64_t>(*value);
  return std::round(*value * 1000) / 1000;
}

}  // namespace

bool IsValid(const Figures& figures) { return !figures.lateMsP99 || *figures.lateMsP99 <= kMaxLateMs; }

std::vector<NamedFigure> ListFigures(const Figures& figures) {
  const auto count = [](std::uint64_t value) { return static_cast<double>(value); };
  return {
      {"bots", count(figures.bots)},
      {"connected", count(figures.connected)},
      {"joins", count(figures.joins)},
      {"join_ms_p99", figures.joinMsP99},
      {"disconnects", count(figures.disconnects)},
      {"sent_away", count(figures.sentAway)},
      {"rejoins", count(figures.rejoins)},
      {"rejoin_ms_p99", figures.rejoinMsP99},
      {"snapshots", count(figures.snapshots)},
      {"snapshot_age_ms_p50", figures.snapshotAgeMsP50},
      {"snapshot_age_ms_p99", figures.snapshotAgeMsP99},
      {"input_to_snapshot_ms_p50", figures.inputToSnapshotMsP50},
      {"stalls", count(figures.stalls)},
      {"kbit_per_s_per_bot", figures.kbitPerSecondPerBot},
      {"decode_us_p99", figures.decodeUsP99},
      {"late_ms_p99", figures.lateMsP99},
      {"script_errors", count(figures.scriptErrors)},
  };
}

std::optional<Threshold> ParseThreshold(std::string_view rule, std::string& error) {
  const auto refuse = [&](const std::string& reason) {
    error = std::string("'").append(rule).append("': ").append(reason);
    return std::nullopt;
  };
  const std::size_t position = rule.find_first_of("<>=!");
  if (position == std::string_view::npos) return refuse("no comparison; write 'key op number', op < <= > >= == !=");
  const Operator* found = nullptr;
  for (const Operator& candidate : kOperators) {
    if (found == nullptr && rule.substr(position, candidate.text.size()) == candidate.text) found = &candidate;
  }
  if (found == nullptr) return refuse("unknown comparison; allowed are < <= > >= == !=");

  Threshold threshold;
  threshold.rule = std::string(rule);
  threshold.key = std::string(TrimBlanks(rule.substr(0, position)));
  threshold.comparison = found->comparison;
  std::string keys;
  bool known = false;
  for (const NamedFigure& figure : ListFigures({})) {
    known = known || threshold.key == figure.key;
    if (!keys.empty()) keys += ", ";
    keys += figure.key;
  }
  if (!known) return refuse("unknown key '" + threshold.key + "'; known are " + keys);

  const std::string_view number = TrimBlanks(rule.substr(position + found->text.size()));
  const auto [end, result] = std::from_chars(number.data(), number.data() + number.size(), threshold.limit);
  if (result != std::errc{} || end != number.data() + number.size() || !std::isfinite(threshold.limit)) {
    return refuse(std::string("'").append(number).append("' is not a number"));
  }
  return threshold;
}

std::vector<Verdict> JudgeThresholds(const std::vector<Threshold>& thresholds, const Figures& figures) {
  const std::vector<NamedFigure> named = ListFigures(figures);
  std::vector<Verdict> verdicts;
  for (const Threshold& threshold : thresholds) {
    Verdict verdict{threshold.rule, std::nullopt, false};
    for (const NamedFigure& figure : named) {
      if (threshold.key == figure.key) verdict.value = figure.value;
    }
    verdict.ok = verdict.value && Holds(threshold.comparison, *verdict.value, threshold.limit);
    verdicts.push_back(std::move(verdict));
  }
  return verdicts;
}

std::string MakeSummary(const Figures& figures, const std::vector<Verdict>& verdicts) {
  nlohmann::ordered_json summary;
  summary["version"] = kVersion;
  for (const NamedFigure& figure : ListFigures(figures)) summary[figure.key] = MakeNumber(figure.value);
  summary["valid"] = IsValid(figures);
  summary["thresholds"] = nlohmann::ordered_json::array();
  for (const Verdict& verdict : verdicts) {
    summary["thresholds"].push_back({{"rule", verdict.rule}, {"value", MakeNumber(verdict.value)}, {"ok", verdict.ok}});
  }
  return summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace wobble::bots
