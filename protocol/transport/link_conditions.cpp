// Reads and validates link conditions.
//
// Every number needs its unit: "loss=5" and "delay=50" are refused rather than guessed. strtod is used instead of
// from_chars, which Emscripten's library has for whole numbers only; only plain digits and points are passed to it, so
// signs, "nan" and "0x10" are refused.
#include "protocol/transport/link_conditions.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

namespace wobble::transport {
namespace {

constexpr double kMaxTime = 10;  // of a condition, seconds
constexpr double kMaxBlackout = 60;
constexpr double kMinPeriod = 0.1;
constexpr double kMaxPeriod = 3600;

enum class Unit { kShare, kTime, kRate, kBlackout };

struct Field {
  std::string_view key;
  Unit unit;
  double LinkConditions::*value;  // null for a black-out, which has two numbers
};
constexpr std::array kFields{
    Field{"loss", Unit::kShare, &LinkConditions::loss},
    Field{"delay", Unit::kTime, &LinkConditions::delay},
    Field{"jitter", Unit::kTime, &LinkConditions::jitter},
    Field{"duplicate", Unit::kShare, &LinkConditions::duplicate},
    Field{"reorder", Unit::kShare, &LinkConditions::reorder},
    Field{"rate", Unit::kRate, &LinkConditions::rate},
    Field{"blackout", Unit::kBlackout, nullptr},
};

struct UnitName {
  std::string_view name;
  double factor;
};

// Reads a number with one of these units, such as '12.5ms'. NaN for any other text.
double ReadQuantity(std::string_view text, std::initializer_list<UnitName> units) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789."), text.size());
  const std::string number(text.substr(0, digits));
  char* end = nullptr;
  const double value = std::strtod(number.c_str(), &end);
  if (number.empty() || *end != '\0') return std::nan("");
  for (const UnitName& unit : units) {
    if (text.substr(digits) == unit.name) return value * unit.factor;
  }
  return std::nan("");
}

double ReadTime(std::string_view text) { return ReadQuantity(text, {{"ms", 1e-3}, {"s", 1}}); }

bool IsWithin(double value, double least, double most) { return value >= least && value <= most; }  // false for a NaN

const char* Allowed(Unit unit) {
  switch (unit) {
    case Unit::kShare:
      return "0% to 100%";
    case Unit::kTime:
      return "0ms to 10s";
    case Unit::kRate:
      return "1kbit to 10000mbit";
    case Unit::kBlackout:
      return "LENGTH/PERIOD such as 250ms/15s, at most 60s of a longer period of 100ms to 3600s";
  }
  return "";
}

bool IsGood(const Blackout& blackout) {
  if (blackout.length == 0 && blackout.period == 0) return true;
  return IsWithin(blackout.length, 0, kMaxBlackout) && IsWithin(blackout.period, kMinPeriod, kMaxPeriod) &&
         blackout.length < blackout.period;
}

bool IsGoodRate(double rate) { return rate == 0 || IsWithin(rate, kMinRate, kMaxRate); }

bool ReadBlackout(std::string_view text, Blackout& blackout) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return false;
  blackout = {ReadTime(text.substr(0, slash)), ReadTime(text.substr(slash + 1))};
  return blackout.period > 0 && IsGood(blackout);
}

// Sets the field's value. False when the text is not a valid value of it.
bool ReadValue(const Field& field, std::string_view text, LinkConditions& conditions) {
  if (field.unit == Unit::kBlackout) return ReadBlackout(text, conditions.blackout);
  double& value = conditions.*field.value;
  switch (field.unit) {
    case Unit::kShare:
      value = ReadQuantity(text, {{"%", 0.01}});
      return IsWithin(value, 0, 1);
    case Unit::kTime:
      value = ReadTime(text);
      return IsWithin(value, 0, kMaxTime);
    default:
      value = ReadQuantity(text, {{"bit", 1}, {"kbit", 1e3}, {"mbit", 1e6}});
      return IsWithin(value, kMinRate, kMaxRate);
  }
}

// The text between two commas.
struct Item {
  std::string key;  // with its prefix
  const Field* field = nullptr;
  bool up = true;
  bool down = true;
  std::string value;
};

std::string ListKeys() {
  std::string keys;
  for (const Field& field : kFields) keys += (keys.empty() ? "" : ", ") + std::string(field.key);
  return keys + ", or one of these after up. or down.";
}

bool ReadItem(std::string_view text, Item& item, std::string& error) {
  const std::size_t equals = std::min(text.find('='), text.size());
  item.key = text.substr(0, equals);
  std::string_view name = item.key;
  if (name.substr(0, 3) == "up.") {
    item.down = false;
    name.remove_prefix(3);
  } else if (name.substr(0, 5) == "down.") {
    item.up = false;
    name.remove_prefix(5);
  }
  for (const Field& field : kFields) {
    if (field.key == name) item.field = &field;
  }
  if (item.field == nullptr) {
    error = "'" + item.key + "' is not known: must be " + ListKeys();
    return false;
  }
  item.value = equals < text.size() ? text.substr(equals + 1) : std::string_view{};
  LinkConditions ignored;
  if (ReadValue(*item.field, item.value, ignored)) return true;
  error = item.key + "=" + item.value + ": must be " + Allowed(item.field->unit);
  return false;
}

bool ReadItems(const std::string& text, std::vector<Item>& items, std::string& error) {
  std::set<std::string> keys;
  for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
    const std::size_t comma = std::min(text.find(',', begin), text.size());
    if (!ReadItem(std::string_view(text).substr(begin, comma - begin), items.emplace_back(), error)) return false;
    if (!keys.insert(items.back().key).second) {
      error = items.back().key + " is given twice";
      return false;
    }
    begin = comma + 1;
  }
  return true;
}

}  // namespace

std::optional<LinkSpec> ParseLinkSpec(std::string_view text, std::string& error) {
  std::string dense;
  for (const char c : text) {
    if (c != ' ') dense += c;
  }
  std::vector<Item> items;
  if (!ReadItems(dense, items, error)) return std::nullopt;
  LinkSpec spec;
  for (const bool forOneDirection : {false, true}) {  // those for one direction last, since they take precedence
    for (const Item& item : items) {
      if ((item.up != item.down) != forOneDirection) continue;
      if (item.up) static_cast<void>(ReadValue(*item.field, item.value, spec.up));
      if (item.down) static_cast<void>(ReadValue(*item.field, item.value, spec.down));
    }
  }
  return spec;
}

bool IsBlack(const Blackout& blackout, double time) {
  return blackout.length > 0 && std::fmod(time, blackout.period) >= blackout.period - blackout.length;
}

std::vector<std::string> ValidateLinkConditions(const LinkConditions& conditions) {
  std::vector<std::string> mistakes;
  const auto check = [&mistakes](const char* name, double value, double highest) {
    if (IsWithin(value, 0, highest)) return;
    mistakes.push_back(std::string(name) + " is " + std::to_string(value) + ", not in 0.." +
                       std::to_string(static_cast<int>(highest)));
  };
  check("loss", conditions.loss, 1);
  check("delay", conditions.delay, kMaxTime);
  check("jitter", conditions.jitter, kMaxTime);
  check("duplicate", conditions.duplicate, 1);
  check("reorder", conditions.reorder, 1);
  check("reorderDelay", conditions.reorderDelay, kMaxTime);
  if (!IsGoodRate(conditions.rate)) {
    mistakes.push_back("rate is " + std::to_string(conditions.rate) + " bit/s, not 0 or " + Allowed(Unit::kRate));
  }
  if (!IsGood(conditions.blackout)) {
    mistakes.push_back("blackout is " + std::to_string(conditions.blackout.length) + " s of " +
                       std::to_string(conditions.blackout.period) + " s, not " + Allowed(Unit::kBlackout));
  }
  return mistakes;
}

}  // namespace wobble::transport
