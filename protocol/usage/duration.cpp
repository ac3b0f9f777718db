#include "protocol/usage/duration.h"

#include <charconv>
#include <string_view>

namespace wobble::usage {
namespace {

struct Unit {
  std::string_view suffix;
  double seconds;
};
// "ms" stands before "s" and "m", which it ends and begins with.
constexpr Unit kUnits[] = {{"ms", 0.001}, {"s", 1}, {"m", 60}, {"h", 3600}};

}  // namespace

std::optional<double> ParseDuration(const std::string& text, std::string& error) {
  std::string_view number = text;
  double unit = 1;
  for (const Unit& each : kUnits) {
    if (!number.ends_with(each.suffix)) continue;
    number.remove_suffix(each.suffix.size());
    unit = each.seconds;
    break;
  }
  double value = 0;
  const auto [end, result] = std::from_chars(number.data(), number.data() + number.size(), value);
  const bool isNumber = result == std::errc{} && end == number.data() + number.size();
  if (isNumber && value >= 0 && value * unit <= kMaxDuration) return value * unit;
  error = "'" + text + "' is no duration; write 90 or 90s, 500ms, 1.5m or 2h, of 0 to 1000000 s";
  return std::nullopt;
}

}  // namespace wobble::usage
