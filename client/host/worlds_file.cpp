// The reader takes every value as the words that will stand on a command line, so that a variable's text and a value of
// the file are one thing after it. Ranges of options are not known here: the programs are asked (check.h).
#include "client/host/worlds_file.h"

#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <limits>
#include <sstream>

#include "client/host/keys.h"
#include "client/host/ports.h"
#include "protocol/usage/capitals.h"
#include "protocol/usage/likeness.h"

namespace wobble::host {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kMostWorlds = 64;
constexpr std::size_t kMaxNameBytes = 32;  // as the gateway has it
constexpr std::string_view kPrefix = "WOBBLE_WORLD_";
constexpr std::string_view kNameKey = "name";  // it has no variable: others are called by it

// The mistakes of one file and the variables that change it.
class Mistakes {
 public:
  explicit Mistakes(std::string file) : m_file(std::move(file)) {}
  // A key that stands in two places is read twice from its one variable: what has been said is not said again.
  void Add(const std::string& line) {
    if (std::ranges::find(m_lines, line) == m_lines.end()) m_lines.push_back(line);
  }
  void Add(const toml::source_region& where, const std::string& what) { Add(Where(where) + ": " + what); }
  [[nodiscard]] std::string Where(const toml::source_region& where) const {
    return m_file + ":" + std::to_string(where.begin.line);
  }
  [[nodiscard]] std::vector<std::string> Take() {
    SortByLine(m_lines);
    return std::move(m_lines);
  }

 private:
  std::string m_file;
  std::vector<std::string> m_lines;
};

std::string ShowNode(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_table<decltype(value)>) {
      text << "{...}";
    } else {
      text << value;
    }
  });
  const std::string shown = text.str();
  return shown.size() <= 100 ? shown : shown.substr(0, 100) + "...";
}

// The text of a node whose TOML type fits the kind.
std::optional<std::string> FindText(const Key& key, const toml::node& node) {
  const bool takesText = key.kind != Kind::kWhole && key.kind != Kind::kNumber && key.kind != Kind::kFlag;
  const bool takesWhole =
      key.kind == Kind::kWhole || key.kind == Kind::kNumber || key.kind == Kind::kDuration || key.kind == Kind::kText;
  if (const auto text = node.value_exact<std::string>(); text && takesText) return *text;
  if (const auto whole = node.value_exact<std::int64_t>(); whole && takesWhole) return std::to_string(*whole);
  if (const auto flag = node.value_exact<bool>(); flag && key.kind == Kind::kFlag) return *flag ? "true" : "false";
  const auto number = node.value_exact<double>();
  if (!number || (key.kind != Kind::kNumber && key.kind != Kind::kDuration)) return {};
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, *number).ptr);
}

std::optional<std::vector<std::string>> FindWords(const Key& key, const toml::node& node) {
  const toml::array* array = node.as_array();
  const bool isMany = key.kind == Kind::kNames || key.kind == Kind::kTexts;
  if (array == nullptr || !isMany) {
    const auto text = FindText(key, node);
    return text ? ReadWords(key, *text) : std::nullopt;
  }
  std::vector<std::string> words;
  for (const toml::node& each : *array) {
    const auto text = FindText(key, each);
    if (!text || text->empty()) return {};
    words.push_back(*text);
  }
  return words.empty() ? std::nullopt : std::optional(words);
}

void ResolvePaths(const Key& key, const fs::path& folder, std::vector<std::string>& words) {
  for (std::string& word : words) {
    const bool isPath = key.kind == Kind::kPath || ((key.kind == Kind::kName || key.kind == Kind::kNames) &&
                                                    (word.find('/') != std::string::npos || word.ends_with(".toml")));
    if (isPath) word = (folder / word).lexically_normal().string();
  }
}

void ReadTable(const toml::table& table, Place place, const fs::path& folder, Mistakes& mistakes, Values& values) {
  for (const auto& [name, node] : table) {
    const Key* key = FindKey(place, name.str());
    if (key == nullptr) {
      mistakes.Add(name.source(),
                   std::string(name.str()) + " is no key here" + usage::Suggest(name.str(), ListNames(place)));
      continue;
    }
    auto words = FindWords(*key, node);
    if (!words) {
      mistakes.Add(node.source(), std::string(key->name) + " = " + ShowNode(node) + ": must be " + DescribeKind(*key));
      continue;
    }
    ResolvePaths(*key, folder, *words);
    values[key->name] = {std::move(*words), mistakes.Where(node.source()), ShowNode(node)};
  }
}

// Sets the key from the variable, if there is one.
void ReadVariable(const Key& key, const std::string& variable, const Environment& environment, Mistakes& mistakes,
                  Values& values) {
  const auto found = environment.find(variable);
  if (found == environment.end() || found->second.empty()) return;
  if (auto words = ReadWords(key, found->second)) {
    values[key.name] = {std::move(*words), variable, found->second};
  } else {
    mistakes.Add(variable + " = " + found->second + ": must be " + DescribeKind(key));
  }
}

// Every key that may stand in this place.
void ReadVariables(Place place, const std::string& prefix, const Environment& environment, Mistakes& mistakes,
                   Values& values) {
  for (const Key& key : ListKeys()) {
    if (FindKey(place, key.name) == nullptr || key.name == kNameKey) continue;
    ReadVariable(key, prefix + usage::InCapitals(key.name), environment, mistakes, values);
  }
}

bool IsName(const std::string& text) {
  const auto isGood = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !text.empty() && text.size() <= kMaxNameBytes && std::ranges::all_of(text, isGood);
}

World ReadWorld(const toml::table& table, std::size_t number, const fs::path& folder, Mistakes& mistakes) {
  World world;
  world.where = mistakes.Where(table.source());
  ReadTable(table, Place::kWorld, folder, mistakes, world.own);
  if (const auto name = world.own.find("name"); name != world.own.end()) {
    world.name = name->second.words.front();
  } else if (const auto scene = world.own.find("scene"); scene != world.own.end()) {
    world.name = fs::path(scene->second.words.front()).stem().string();
  }
  if (!IsName(world.name)) {
    mistakes.Add(table.source(),
                 world.name.empty()
                     ? "world " + std::to_string(number) + " has no name: name = \"...\" or a scene gives it one"
                     : "name = \"" + world.name + "\": must be letters, digits, - and _, at most " +
                           std::to_string(kMaxNameBytes));
  }
  return world;
}

unsigned FindPort(const Values& values, unsigned otherwise) {
  const auto value = values.find("port");
  return value == values.end() ? otherwise : static_cast<unsigned>(std::stoul(value->second.words.front()));
}

void ChoosePorts(WorldsFile& file, Mistakes& mistakes) {
  const unsigned first = FindPort(file.all, kFirstPort);
  std::map<unsigned, const World*> taken;
  for (std::size_t i = 0; i < file.worlds.size(); ++i) {
    World& world = file.worlds[i];
    const unsigned port = FindPort(world.own, first == 0 ? 0 : first + static_cast<unsigned>(i));
    const auto own = world.own.find("port");
    const std::string what = (own == world.own.end() ? world.where : own->second.where) + ": port " +
                             std::to_string(port) + " of the world " + world.name + ": ";
    if (port > std::numeric_limits<std::uint16_t>::max()) {
      mistakes.Add(what + "must be at most 65535");
    } else if (const auto [other, isNew] = taken.emplace(port, &world); !isNew && port != 0) {
      mistakes.Add(what + "the world " + other->second->name + " has it already");
    }
    world.port = static_cast<std::uint16_t>(port);
  }
}

// What no two worlds may share.
void FindClashes(const WorldsFile& file, Mistakes& mistakes) {
  for (const char* name : {"state", "admin_socket", "trace", "invites", "bans"}) {
    std::map<std::string, const World*> taken;
    for (const World& world : file.worlds) {
      const auto value = world.own.find(name);
      if (value == world.own.end() || value->second.words.front() == "0") continue;
      const auto [other, isNew] = taken.emplace(value->second.words.front(), &world);
      if (isNew) continue;
      mistakes.Add(value->second.where + ": " + name + " = " + value->second.shown + ": the world " +
                   other->second->name + " has it already");
    }
  }
  std::map<std::string, const World*> names;
  for (const World& world : file.worlds) {
    if (world.name.empty()) continue;
    const auto [other, isNew] = names.emplace(usage::InCapitals(world.name), &world);
    if (!isNew) {
      mistakes.Add(world.where + ": the name " + world.name + " is too like that of the world at " +
                   other->second->where + ": variables cannot tell them apart");
    }
  }
}

// Bots have a password at most.
void FindLockedOutBots(const WorldsFile& file, Mistakes& mistakes) {
  for (const World& world : file.worlds) {
    const auto bots = world.values.find("bots");
    const bool asksForMore = world.values.contains("invites") || world.values.contains("token_key");
    if (bots == world.values.end() || bots->second.words.front() == "0" || !asksForMore) continue;
    if (world.values.contains("password_file")) continue;
    mistakes.Add(bots->second.where + ": bots = " + bots->second.shown + ": the world " + world.name +
                 " asks for invites or tokens, which bots do not have; password_file lets them in");
  }
}

// Variables that begin as one of a world's and are none.
void FindStrayVariables(const WorldsFile& file, const Environment& environment, Mistakes& mistakes) {
  std::vector<std::string> known;
  for (const World& world : file.worlds) {
    for (const std::string& key : ListNames(Place::kWorld)) {
      if (key == kNameKey) continue;
      known.push_back(std::string(kPrefix) + usage::InCapitals(world.name) + "_" + usage::InCapitals(key));
    }
  }
  for (const auto& [variable, text] : environment) {
    if (!variable.starts_with(kPrefix) || std::ranges::find(known, variable) != known.end()) continue;
    mistakes.Add(variable + " is no key of a world" + usage::Suggest(variable, known));
  }
}

void ReadTables(const toml::table& root, const fs::path& folder, Mistakes& mistakes, WorldsFile& file) {
  const std::vector<std::string> tables{"gateway", "all", "world"};
  for (const auto& [name, node] : root) {
    const toml::array* array = node.as_array();
    if (name.str() == "world" && array != nullptr && array->is_array_of_tables()) {
      for (const toml::node& each : *array) {
        file.worlds.push_back(ReadWorld(*each.as_table(), file.worlds.size() + 1, folder, mistakes));
      }
    } else if (name.str() == "world") {
      mistakes.Add(node.source(), "world must be tables: [[world]]");
    } else if (std::ranges::find(tables, name.str()) == tables.end()) {
      mistakes.Add(name.source(), std::string(name.str()) + " is no key here" + usage::Suggest(name.str(), tables) +
                                      "; keys stand in [gateway], [all] or [[world]]");
    } else if (!node.is_table()) {
      mistakes.Add(node.source(), std::string(name.str()) + " must be a table: [" + std::string(name.str()) + "]");
    } else {
      const bool isGateway = name.str() == "gateway";
      file.hasGateway |= isGateway;
      ReadTable(*node.as_table(), isGateway ? Place::kGateway : Place::kAll, folder, mistakes,
                isGateway ? file.gateway : file.all);
    }
  }
}

}  // namespace

void SortByLine(std::vector<std::string>& errors) {
  // "worlds.toml:7: ...": 7. Without a line: last.
  const auto findLine = [](const std::string& error) {
    const std::size_t colon = error.find(':');
    const bool hasLine = colon != std::string::npos && std::isdigit(static_cast<unsigned char>(error[colon + 1])) != 0;
    return hasLine ? std::strtoul(error.c_str() + colon + 1, nullptr, 10) : std::numeric_limits<unsigned long>::max();
  };
  std::ranges::stable_sort(errors, {}, findLine);
}

Environment ReadEnvironment() {
  Environment environment;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const std::size_t sign = text.find('=');
    if (text.starts_with("WOBBLE_") && sign != std::string_view::npos) {
      environment.emplace(text.substr(0, sign), text.substr(sign + 1));
    }
  }
  return environment;
}

WorldsFile ParseWorlds(const std::string& text, const fs::path& path, const Environment& environment) {
  WorldsFile file;
  Mistakes mistakes(path.filename().string());
  try {
    const toml::table root = toml::parse(text, path.string());
    ReadTables(root, path.parent_path(), mistakes, file);
  } catch (const toml::parse_error& error) {
    mistakes.Add(error.source(), std::string(error.description()));
    file.errors = mistakes.Take();
    return file;
  }
  if (file.worlds.empty()) mistakes.Add(path.filename().string() + ": has no [[world]]");
  if (file.worlds.size() > kMostWorlds) {
    mistakes.Add(path.filename().string() + ": " + std::to_string(file.worlds.size()) + " worlds; at most " +
                 std::to_string(kMostWorlds));
  }
  file.hasGateway |= environment.contains("WOBBLE_HTTP");
  ReadVariables(Place::kAll, "WOBBLE_", environment, mistakes, file.all);
  if (file.hasGateway) ReadVariables(Place::kGateway, "WOBBLE_", environment, mistakes, file.gateway);
  for (World& world : file.worlds) {
    ReadVariables(Place::kWorld, std::string(kPrefix) + usage::InCapitals(world.name) + "_", environment, mistakes,
                  world.own);
    world.values = world.own;
    for (const auto& [name, value] : file.all) {
      // Its own scene is no part of everybody's rotation, and the other way round.
      const bool hasOther =
          (name == "scene" && world.own.contains("rotation")) || (name == "rotation" && world.own.contains("scene"));
      if (!hasOther) world.values.emplace(name, value);
    }
  }
  ChoosePorts(file, mistakes);
  FindClashes(file, mistakes);
  for (std::string& clash : FindPortClashes(file)) mistakes.Add(std::move(clash));
  FindLockedOutBots(file, mistakes);
  FindStrayVariables(file, environment, mistakes);
  file.errors = mistakes.Take();
  return file;
}

std::string FindWord(const Values& values, std::string_view key, const std::string& otherwise) {
  const auto value = values.find(key);
  return value == values.end() ? otherwise : value->second.words.front();
}

WorldsFile LoadWorlds(const fs::path& path, const Environment& environment) {
  WorldsFile failed;
  std::error_code error;
  if (!fs::exists(path, error)) {
    failed.errors = {path.string() + ": there is no such file"};
    return failed;
  }
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) > kMostBytes || error) {
    failed.errors = {path.string() + ": must be a file of at most 1 MiB"};
    return failed;
  }
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad()) {
    failed.errors = {path.string() + ": cannot be read"};
    return failed;
  }
  return ParseWorlds(text, path, environment);
}

}  // namespace wobble::host
