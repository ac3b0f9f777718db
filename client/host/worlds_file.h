// Reads worlds.toml: the tables [gateway], [all] (for every world) and [[world]], whose keys are those of keys.h, and
// the variables that change them. Every mistake is reported, with its line or its variable.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace wobble::host {

// Variables by name; of those of this process only what begins with WOBBLE_ is looked at.
using Environment = std::map<std::string, std::string>;
[[nodiscard]] Environment ReadEnvironment();

// What stands behind a key.
struct Value {
  std::vector<std::string> words;  // as on a command line; of a flag "true" or "false"
  std::string where;               // for messages: "worlds.toml:7" or "WOBBLE_PORT"
  std::string shown;               // as a person wrote it
};
using Values = std::map<std::string, Value, std::less<>>;

// The first word behind a key, or another one.
[[nodiscard]] std::string FindWord(const Values& values, std::string_view key, const std::string& otherwise);

inline constexpr std::uint16_t kFirstPort = 7777;

struct World {
  std::string name;  // its own, or that of its scene
  std::string where;
  std::uint16_t port = 0;  // its own; else that of [all], or kFirstPort, and those behind it; 0: a free one
  Values values;           // its own, and those of [all] that it has not
  Values own;              // its own
};

struct WorldsFile {
  bool hasGateway = false;
  Values gateway;
  Values all;
  std::vector<World> worlds;
  std::vector<std::string> errors;  // one line each: "worlds.toml:7: port = 70000: must be ..."; empty: all is good
};

// text: TOML. path: names the source in errors; paths in the text are relative to its folder.
//
// A variable WOBBLE_KEY sets the key in [gateway] and in [all], where it may stand; WOBBLE_WORLD_NAME_KEY sets it for
// the world of that name (in capitals, with _ for -). A variable wins over the file in the same place, and what is said
// of one world wins over what is said of all. WOBBLE_HTTP alone makes a gateway.
[[nodiscard]] WorldsFile ParseWorlds(const std::string& text, const std::filesystem::path& path,
                                     const Environment& environment);

// Puts mistakes into the order of the file; those of variables come last.
void SortByLine(std::vector<std::string>& errors);

// The same of a file of at most 1 MiB.
[[nodiscard]] WorldsFile LoadWorlds(const std::filesystem::path& path, const Environment& environment);

}  // namespace wobble::host
