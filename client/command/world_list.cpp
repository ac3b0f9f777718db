// The page shows to everybody what strangers wrote: texts are kept short, and only URLs that a browser opens as a page
// pass.
#include "client/command/world_list.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/command/address.h"
#include "protocol/text.h"

namespace wobble::command {
namespace {

using nlohmann::json;

constexpr int kVersion = 1;
constexpr std::size_t kMostMistakes = 5;       // that are named
constexpr std::size_t kMaxAddressBytes = 262;  // a name of DNS, brackets, colon and port

// Visible ASCII behind http:// or https://, without a user's name, with which "https://bank.example@evil.example" poses
// as somebody else's page.
bool IsPageUrl(const std::string& text) {
  const std::size_t begin = text.starts_with("https://") ? 8 : text.starts_with("http://") ? 7 : 0;
  if (begin == 0 || text.size() > kMaxPageUrlBytes) return false;
  const std::string host = text.substr(begin, text.find_first_of("/?#", begin) - begin);
  const auto isGood = [](unsigned char c) {
    return c > 0x20 && c < 0x7f &&
           std::string_view("\"'<>\\^`{|}").find(static_cast<char>(c)) == std::string_view::npos;
  };
  return !host.empty() && host.find('@') == std::string::npos && std::all_of(text.begin(), text.end(), isGood);
}

// Reads one entry after the other and collects what is wrong with them.
class Reader {
 public:
  std::vector<ListedWorld> worlds;
  std::vector<std::string> mistakes;

  void Read(const json& root) {
    if (!root.is_object() || root.value("version", json()) != kVersion) {
      return mistakes.push_back("version: must be 1");
    }
    const json list = root.value("worlds", json());
    if (!list.is_array()) return mistakes.push_back("worlds: must be an array");
    if (list.size() > kMaxListedWorlds) {
      return mistakes.push_back("worlds: " + std::to_string(list.size()) + " are more than " +
                                std::to_string(kMaxListedWorlds));
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
      m_place = "worlds[" + std::to_string(i) + "]";
      if (list[i].is_object()) {
        ReadWorld(list[i]);
      } else {
        mistakes.push_back(m_place + ": must be an object");
      }
    }
  }

 private:
  void ReadWorld(const json& entry) {
    const std::size_t before = mistakes.size();
    ListedWorld world{.name = ReadText(entry, "name", kMaxListedNameBytes),
                      .page = ReadText(entry, "page", kMaxPageUrlBytes),
                      .address = ReadText(entry, "address", kMaxAddressBytes),
                      .scene = ReadText(entry, "scene", kMaxListedNameBytes)};
    if (mistakes.size() > before) return;
    std::string error;
    if (world.name.empty()) mistakes.push_back(m_place + ": needs a name");
    if (world.page.empty() && world.address.empty()) mistakes.push_back(m_place + ": needs a page or an address");
    if (!world.page.empty() && !IsPageUrl(world.page)) {
      mistakes.push_back(m_place + ".page: '" + world.page + "' is no http://HOST... or https://HOST...");
    }
    if (!world.address.empty() && !ParseAddress(world.address, error)) {
      mistakes.push_back(m_place + ".address: " + error);
    }
    worlds.push_back(std::move(world));
  }

  // Empty when it is not there.
  std::string ReadText(const json& entry, const char* field, std::size_t maxBytes) {
    const auto found = entry.find(field);
    if (found == entry.end()) return "";
    if (!found->is_string()) {
      mistakes.push_back(m_place + "." + field + ": must be a text");
      return "";
    }
    const std::string& text = found->get_ref<const std::string&>();
    if (text.size() <= maxBytes) return protocol::MakeLine(text, maxBytes);
    mistakes.push_back(m_place + "." + field + ": has more than " + std::to_string(maxBytes) + " bytes");
    return "";
  }

  std::string m_place;
};

}  // namespace

std::optional<std::vector<ListedWorld>> ParseWorldList(std::string_view text, std::string& error) {
  if (text.size() > kMaxListBytes) {
    error = "has more than " + std::to_string(kMaxListBytes / 1024) + " KiB";
    return std::nullopt;
  }
  // The parser leaves out all that lies deeper than a list's own fields: a text of brackets alone is 256 Ki deep.
  constexpr int kMostDepth = 8;
  const json root = json::parse(
      text, [](int depth, json::parse_event_t, json&) { return depth <= kMostDepth; }, false);
  if (root.is_discarded()) {
    error = "is no JSON";
    return std::nullopt;
  }
  Reader reader;
  reader.Read(root);
  if (reader.mistakes.empty()) return std::move(reader.worlds);
  error.clear();
  for (std::size_t i = 0; i < std::min(reader.mistakes.size(), kMostMistakes); ++i) {
    error += (i == 0 ? "" : "; ") + reader.mistakes[i];
  }
  if (reader.mistakes.size() > kMostMistakes) {
    error += "; and " + std::to_string(reader.mistakes.size() - kMostMistakes) + " more";
  }
  return std::nullopt;
}

std::optional<std::vector<ListedWorld>> LoadWorldList(const std::string& path, std::string& error) {
  std::error_code failure;
  std::string text(kMaxListBytes + 1, '\0');
  std::ifstream stream;
  if (std::filesystem::is_regular_file(path, failure)) stream.open(path, std::ios::binary);
  if (!stream.is_open()) {
    error = "'" + path + "' cannot be read";
    return std::nullopt;
  }
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  auto worlds = ParseWorldList(text, error);
  if (!worlds) error = "'" + path + "': " + error;
  return worlds;
}

std::string FormatWorldList(const std::vector<ListedWorld>& worlds) {
  json list = json::array();
  for (const ListedWorld& world : worlds) {
    json entry{{"name", world.name}};
    if (!world.page.empty()) entry["page"] = world.page;
    if (!world.address.empty()) entry["address"] = world.address;
    if (!world.scene.empty()) entry["scene"] = world.scene;
    list.push_back(std::move(entry));
  }
  return json{{"version", kVersion}, {"worlds", std::move(list)}}.dump() + "\n";
}

std::string FormatPages(const std::vector<ListedWorld>& worlds) {
  json list = json::array();
  for (const ListedWorld& world : worlds) {
    if (!world.page.empty()) list.push_back({{"name", world.name}, {"page", world.page}, {"scene", world.scene}});
  }
  return list.dump();
}

}  // namespace wobble::command
