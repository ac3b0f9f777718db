// Parsers for the values of the command line. Each returns its value, or one line that names the value, the fault and
// the allowed range; the caller puts the option's name before it.
#include "client/bots/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "client/command/command.h"
#include "protocol/usage/duration.h"

namespace wobble::bots {
namespace {

template <typename Integer>
bool ParseWhole(std::string_view text, Integer& value) {
  const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), value);
  return result == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::string FindScriptFile(const std::string& name) {
  std::error_code error;
  if (name.find('/') != std::string::npos || std::filesystem::exists(name, error)) return name;
  if (!name.ends_with(".lua")) return FindScriptFile(name + ".lua");
  const auto shipped = command::FindShipped("scripts") / name;
  return std::filesystem::exists(shipped, error) ? shipped.string() : name;
}

std::optional<Stage> ParseStage(const std::string& text, std::string& error) {
  const std::size_t colon = text.find(':');
  const auto seconds = usage::ParseDuration(text.substr(0, colon), error);
  Stage stage;
  const bool isWhole = colon != std::string::npos && ParseWhole(std::string_view(text).substr(colon + 1), stage.bots);
  if (seconds && *seconds > 0 && isWhole && stage.bots <= kMaxBots) {
    stage.seconds = *seconds;
    return stage;
  }
  error = "'" + text +
          "' is no stage; write DURATION:BOTS such as 60s:200, the duration above 0 up to 1000000 s, 0 to " +
          std::to_string(kMaxBots) + " bots";
  return std::nullopt;
}

std::vector<Stage> ListStages(const LoadTestOptions& options) {
  if (!options.stages.empty()) return options.stages;
  return {{options.ramp, options.count}};
}

double FindDuration(const LoadTestOptions& options) {
  if (options.stages.empty()) return options.duration;
  double seconds = 0;
  for (const Stage& stage : options.stages) seconds += stage.seconds;
  return seconds;
}

// The first bot of a rise joins at the stage's beginning and the last before its end, so that the number is reached
// when the next stage begins; a fall is symmetric.
unsigned CountBotsAt(const std::vector<Stage>& stages, double seconds) {
  unsigned from = 0;
  for (const Stage& stage : stages) {
    if (seconds < stage.seconds) {
      const unsigned change = std::max(from, stage.bots) - std::min(from, stage.bots);
      const auto changed = std::min(change, static_cast<unsigned>(change * seconds / stage.seconds) + 1);
      return stage.bots > from ? from + changed : from - changed;
    }
    seconds -= stage.seconds;
    from = stage.bots;
  }
  return from;
}

std::size_t FindStageAt(const std::vector<Stage>& stages, double seconds) {
  std::size_t index = 0;
  for (; index + 1 < stages.size() && seconds >= stages[index].seconds; ++index) seconds -= stages[index].seconds;
  return index;
}

unsigned CountStarts(const std::vector<Stage>& stages) {
  unsigned starts = 0;
  unsigned from = 0;
  for (const Stage& stage : stages) {
    if (stage.bots > from) starts += stage.bots - from;
    from = stage.bots;
  }
  return starts;
}

bool DecodeShare::Includes(unsigned index) const {
  const auto countBefore = [this](std::uint64_t bots) { return (bots * part + whole - 1) / whole; };
  return countBefore(std::uint64_t{index} + 1) > countBefore(index);
}

std::optional<DecodeShare> ParseDecodeShare(const std::string& text, std::string& error) {
  DecodeShare share;
  const std::size_t slash = text.find('/');
  const std::string_view view = text;
  const std::string_view whole = slash == std::string::npos ? std::string_view("1") : view.substr(slash + 1);
  if (!ParseWhole(view.substr(0, slash), share.part) || !ParseWhole(whole, share.whole) || share.whole == 0 ||
      share.part > share.whole) {
    error = "'" + text + "' is no share; write A/B with A of 0 to B, such as 1/32, or 0 or 1";
    return std::nullopt;
  }
  return share;
}

}  // namespace wobble::bots
