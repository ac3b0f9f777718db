#include "client/list/public_list.h"

#include <httplib.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "client/command/address.h"
#include "protocol/transport/vestibule/udp_socket.h"

namespace wobble::list {
namespace {

constexpr int kPatience = 5;  // s, for the connection and for the answer

// nullopt with one line in `error`.
std::optional<std::string> ReadFile(const std::string& path, std::string& error) {
  std::ifstream in(path, std::ios::binary);
  std::string text(kMaxListBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (!in.eof() || text.empty()) {
    error = text.empty() ? "cannot be read" : "is larger than 1 MiB";
    return {};
  }
  return text;
}

std::optional<std::string> Download(const std::string& url, std::string& error) {
  const std::size_t host = url.find("://") + 3, path = url.find('/', host);
  httplib::Client client(url.substr(0, path));
  client.set_connection_timeout(kPatience);
  client.set_read_timeout(kPatience);
  client.set_follow_location(true);
  std::string text;
  const auto take = [&text](const char* bytes, std::size_t count) {
    text.append(bytes, count);
    return text.size() <= kMaxListBytes;
  };
  const httplib::Result result = client.Get(path == std::string::npos ? "/" : url.substr(path), take);
  if (text.size() > kMaxListBytes) {
    error = "is larger than 1 MiB";
  } else if (!result) {
    error = "no answer";
  } else if (result->status != 200) {
    error = "HTTP status " + std::to_string(result->status);
  } else {
    return text;
  }
  return {};
}

// False: the field is there and is no text.
bool TakeText(const nlohmann::json& entry, const char* name, std::string& text) {
  const auto field = entry.find(name);
  if (field == entry.end()) return true;
  if (!field->is_string()) return false;
  text = field->get<std::string>();
  return true;
}

}  // namespace

std::vector<World> ParseList(const std::string& text, std::string& error) {
  const auto list = nlohmann::json::parse(text, nullptr, false);
  const auto entries = list.is_object() ? list.find("worlds") : list.end();
  if (entries == list.end() || !entries->is_array()) {
    error = R"(is no list of worlds: {"worlds": [{"address": "HOST:PORT"}, ...]})";
    return {};
  }
  if (entries->empty() || entries->size() > kMaxListedWorlds) {
    error =
        "worlds: must be 1 to " + std::to_string(kMaxListedWorlds) + " entries, not " + std::to_string(entries->size());
    return {};
  }
  std::vector<World> worlds;
  for (const auto& entry : *entries) {
    const std::string place = "worlds[" + std::to_string(worlds.size()) + "]";
    World& world = worlds.emplace_back();
    const bool areTexts = entry.is_object() && TakeText(entry, "address", world.address) &&
                          TakeText(entry, "name", world.told.name) && TakeText(entry, "scene", world.told.scene) &&
                          TakeText(entry, "version", world.told.version) && TakeText(entry, "key", world.key);
    std::string why;
    if (areTexts && command::ParseAddress(world.address, why)) continue;
    error = place + (areTexts ? ".address: " + why : ": must be an object of texts");
    return {};
  }
  return worlds;
}

std::vector<World> ReadList(const std::string& where, std::string& error) {
  const bool isUrl = where.starts_with("http://") || where.starts_with("https://");
  const auto text = isUrl ? Download(where, error) : ReadFile(where, error);
  std::vector<World> worlds;
  if (text) worlds = ParseList(*text, error);
  if (!error.empty()) error = where + ": " + error;
  for (World& world : worlds) {
    std::string unknown;
    const auto address = command::ParseAddress(world.address, unknown);
    const auto found = transport::vestibule::ResolveAddresses(address->host, address->port, unknown);
    if (!found.empty()) world.resolved = found.front();
  }
  return worlds;
}

}  // namespace wobble::list
