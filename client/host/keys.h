// The keys of worlds.toml: where each may stand, and what may stand behind it.
//
// Most are options of wobbled or of `wobble gateway` with the same name (max_clients is --max-clients); their ranges
// are those of the programs, which are asked for them (check.h), so that they stand once.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::host {

enum class Kind : std::uint8_t {
  kWhole,     // a whole number
  kNumber,    // a number
  kDuration,  // a number of seconds, or a text such as "1.5m"
  kFlag,      // true or false
  kText,      // a text, or a whole number such as a port
  kPath,      // of a file or folder; from the folder of worlds.toml
  kName,      // a shipped scene or script, or with a slash a path as above
  kNames,     // several of them
  kTexts,     // several texts
};

struct Key {
  const char* name;
  Kind kind;
  bool ofAll = false;      // it may stand in [all], for every world
  bool ofWorld = false;    // in [[world]]
  bool ofGateway = false;  // in [gateway]
  bool isOption = true;    // an option of the program; else it is for the fleet itself
  double most = 0;         // of a kWhole that is for the fleet, from 0
};

[[nodiscard]] std::span<const Key> ListKeys();

enum class Place : std::uint8_t { kAll, kWorld, kGateway };
// Null: there is no such key in this place.
[[nodiscard]] const Key* FindKey(Place place, std::string_view name);
[[nodiscard]] std::vector<std::string> ListNames(Place place);

// "--max-clients" of "max_clients", and the other way round.
[[nodiscard]] std::string OptionOf(std::string_view key);
[[nodiscard]] std::string KeyOf(std::string_view option);

// Words for a message: "a whole number", "true or false".
[[nodiscard]] std::string DescribeKind(const Key& key);

// Reads the text of a variable: the words that stand for it on a command line (of a flag "true" or "false"; of several
// things each, which commas or blanks separate). nullopt: it is not of the kind.
[[nodiscard]] std::optional<std::vector<std::string>> ReadWords(const Key& key, const std::string& text);

}  // namespace wobble::host
