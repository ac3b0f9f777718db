#include "client/host/keys.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdlib>

#include "protocol/usage/duration.h"

namespace wobble::host {
namespace {

constexpr double kMostPort = 65535;
constexpr double kMostBots = 10000;
// As CLI11 reads flags, so that a variable means the same to wobbled and to `wobble host`.
constexpr std::string_view kYes[] = {"true", "1", "yes", "on"};
constexpr std::string_view kNo[] = {"false", "0", "no", "off"};

constexpr Key kKeys[] = {
    // For the fleet itself. Each world has a name and a folder for its state of its own; port in [all] is that of the
    // first world, state in [all] the folder of the worlds' folders.
    {.name = "name", .kind = Kind::kText, .ofWorld = true, .isOption = false},
    {.name = "port", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true, .isOption = false, .most = kMostPort},
    {.name = "state", .kind = Kind::kPath, .ofAll = true, .ofWorld = true, .isOption = false},
    {.name = "bots", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true, .isOption = false, .most = kMostBots},
    {.name = "script", .kind = Kind::kName, .ofAll = true, .ofWorld = true, .isOption = false},
    {.name = "http", .kind = Kind::kWhole, .ofGateway = true, .isOption = false, .most = kMostPort},
    // Of both.
    {.name = "bind", .kind = Kind::kText, .ofAll = true, .ofWorld = true, .ofGateway = true},
    {.name = "max_per_address", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true, .ofGateway = true},
    {.name = "gateway_key", .kind = Kind::kPath, .ofAll = true, .ofWorld = true, .ofGateway = true},
    // Of wobbled, for any number of worlds.
    {.name = "scene", .kind = Kind::kName, .ofAll = true, .ofWorld = true},
    {.name = "rotation", .kind = Kind::kNames, .ofAll = true, .ofWorld = true},
    {.name = "max_clients", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true},
    {.name = "client_kbit", .kind = Kind::kNumber, .ofAll = true, .ofWorld = true},
    {.name = "view_distance", .kind = Kind::kNumber, .ofAll = true, .ofWorld = true},
    {.name = "pause_after", .kind = Kind::kDuration, .ofAll = true, .ofWorld = true},
    {.name = "tick_hz", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true},
    {.name = "snapshot_hz", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true},
    {.name = "threads", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true},
    {.name = "seed", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true},
    {.name = "rounds", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true},
    {.name = "after_match", .kind = Kind::kText, .ofAll = true, .ofWorld = true},
    {.name = "reset_when_empty", .kind = Kind::kFlag, .ofAll = true, .ofWorld = true},
    {.name = "no_chat", .kind = Kind::kFlag, .ofAll = true, .ofWorld = true},
    {.name = "admit_when_busy", .kind = Kind::kFlag, .ofAll = true, .ofWorld = true},
    {.name = "announce", .kind = Kind::kFlag, .ofAll = true, .ofWorld = true},
    {.name = "hidden", .kind = Kind::kFlag, .ofAll = true, .ofWorld = true},
    {.name = "untrained", .kind = Kind::kFlag, .ofAll = true, .ofWorld = true},
    {.name = "cache", .kind = Kind::kPath, .ofAll = true, .ofWorld = true},
    {.name = "record", .kind = Kind::kPath, .ofAll = true, .ofWorld = true},
    {.name = "record_size", .kind = Kind::kWhole, .ofAll = true, .ofWorld = true},
    {.name = "password_file", .kind = Kind::kPath, .ofAll = true, .ofWorld = true},
    {.name = "token_key", .kind = Kind::kPath, .ofAll = true, .ofWorld = true},
    {.name = "owner_key", .kind = Kind::kPath, .ofAll = true, .ofWorld = true},
    {.name = "key", .kind = Kind::kPath, .ofAll = true, .ofWorld = true},
    {.name = "log_level", .kind = Kind::kText, .ofAll = true, .ofWorld = true},
    {.name = "log_format", .kind = Kind::kText, .ofAll = true, .ofWorld = true},
    {.name = "rcon_password_file", .kind = Kind::kPath, .ofAll = true, .ofWorld = true},
    // Of one world: two servers would take them from each other.
    {.name = "invites", .kind = Kind::kPath, .ofWorld = true},
    {.name = "bans", .kind = Kind::kPath, .ofWorld = true},
    {.name = "admin_socket", .kind = Kind::kPath, .ofWorld = true},
    {.name = "admin_http", .kind = Kind::kText, .ofWorld = true},
    {.name = "rcon", .kind = Kind::kText, .ofWorld = true},
    {.name = "ops", .kind = Kind::kText, .ofWorld = true},
    {.name = "trace", .kind = Kind::kPath, .ofWorld = true},
    // Of `wobble gateway`.
    {.name = "page", .kind = Kind::kPath, .ofGateway = true},
    {.name = "recordings", .kind = Kind::kPath, .ofGateway = true},
    {.name = "max_connections", .kind = Kind::kWhole, .ofGateway = true},
    {.name = "tls_cert", .kind = Kind::kPath, .ofGateway = true},
    {.name = "tls_key", .kind = Kind::kPath, .ofGateway = true},
    {.name = "list", .kind = Kind::kPath, .ofGateway = true},
    {.name = "trusted_proxy", .kind = Kind::kTexts, .ofGateway = true},
    {.name = "origin", .kind = Kind::kTexts, .ofGateway = true},
};

bool IsOf(const Key& key, Place place) {
  switch (place) {
    case Place::kAll:
      return key.ofAll;
    case Place::kWorld:
      return key.ofWorld;
    case Place::kGateway:
      return key.ofGateway;
  }
  return false;
}

template <class Number>
bool IsA(const std::string& text) {
  Number number{};
  const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
  return result == std::errc{} && end == text.data() + text.size();
}

std::string Replace(std::string_view text, char from, char to) {
  std::string replaced(text);
  std::ranges::replace(replaced, from, to);
  return replaced;
}

std::vector<std::string> Split(const std::string& text) {
  std::vector<std::string> words;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(", ", at)) != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(", ", at), text.size());
    words.push_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

}  // namespace

std::span<const Key> ListKeys() { return kKeys; }

const Key* FindKey(Place place, std::string_view name) {
  const auto found = std::ranges::find_if(kKeys, [&](const Key& key) { return IsOf(key, place) && name == key.name; });
  return found == std::end(kKeys) ? nullptr : found;
}

std::vector<std::string> ListNames(Place place) {
  std::vector<std::string> names;
  for (const Key& key : kKeys) {
    if (IsOf(key, place)) names.emplace_back(key.name);
  }
  return names;
}

std::string OptionOf(std::string_view key) { return "--" + Replace(key, '_', '-'); }

std::string KeyOf(std::string_view option) {
  return Replace(option.starts_with("--") ? option.substr(2) : option, '-', '_');
}

std::string DescribeKind(const Key& key) {
  switch (key.kind) {
    case Kind::kWhole:
      return key.isOption ? "a whole number" : "a whole number from 0 to " + std::to_string(static_cast<int>(key.most));
    case Kind::kNumber:
      return "a number";
    case Kind::kDuration:
      return "a number of seconds, or a text such as \"1.5m\"";
    case Kind::kFlag:
      return "true or false";
    case Kind::kText:
    case Kind::kPath:
    case Kind::kName:
      return "a text";
    case Kind::kNames:
    case Kind::kTexts:
      return "a text or an array of texts";
  }
  return "";
}

std::optional<std::vector<std::string>> ReadWords(const Key& key, const std::string& text) {
  std::string ignored;
  bool isGood = !text.empty();
  switch (key.kind) {
    case Kind::kWhole: {
      isGood = IsA<std::int64_t>(text);
      const auto value = isGood ? std::strtoll(text.c_str(), nullptr, 10) : 0;
      isGood = isGood && (key.isOption || (value >= 0 && static_cast<double>(value) <= key.most));
      break;
    }
    case Kind::kNumber:
      isGood = IsA<double>(text);
      break;
    case Kind::kDuration:
      isGood = usage::ParseDuration(text, ignored).has_value();
      break;
    case Kind::kFlag: {
      const auto isOneOf = [&](const auto& words) { return std::ranges::find(words, text) != std::end(words); };
      const bool isTrue = isOneOf(kYes);
      return isTrue || isOneOf(kNo) ? std::optional(std::vector<std::string>{isTrue ? "true" : "false"}) : std::nullopt;
    }
    case Kind::kNames:
    case Kind::kTexts: {
      std::vector<std::string> words = Split(text);
      return words.empty() ? std::nullopt : std::optional(std::move(words));
    }
    case Kind::kText:
    case Kind::kPath:
    case Kind::kName:
      break;
  }
  return isGood ? std::optional(std::vector{text}) : std::nullopt;
}

}  // namespace wobble::host
