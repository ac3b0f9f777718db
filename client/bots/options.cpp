// Small readers for the command line's words. Each returns its value or one line that names the word, what is wrong
// with it and what is allowed, which main.cpp puts the option's name before.
#include "client/bots/options.h"

#include <charconv>

namespace wobble::bots {
namespace {

template <typename Integer>
bool ParseWhole(std::string_view text, Integer& value) {
  const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), value);
  return result == std::errc{} && end == text.data() + text.size();
}

}  // namespace

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
