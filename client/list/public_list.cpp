#include "client/list/public_list.h"

#include <httplib.h>

#include <optional>

#include "client/command/address.h"
#include "client/command/world_list.h"
#include "protocol/transport/vestibule/udp_socket.h"

namespace wobble::list {
namespace {

constexpr int kPatience = 5;  // s, for the connection and for the answer

// nullopt with one line in `error`.
std::optional<std::string> Download(const std::string& url, std::string& error) {
  const std::size_t host = url.find("://") + 3, path = url.find('/', host);
  httplib::Client client(url.substr(0, path));
  client.set_connection_timeout(kPatience);
  client.set_read_timeout(kPatience);
  client.set_follow_location(true);
  std::string text;
  const auto take = [&text](const char* bytes, std::size_t count) {
    text.append(bytes, count);
    return text.size() <= command::kMaxListBytes;
  };
  const httplib::Result result = client.Get(path == std::string::npos ? "/" : url.substr(path), take);
  if (text.size() > command::kMaxListBytes) {
    error = "is larger than 256 KiB";
  } else if (!result) {
    error = "no answer";
  } else if (result->status != 200) {
    error = "HTTP status " + std::to_string(result->status);
  } else {
    return text;
  }
  return {};
}

std::optional<std::vector<command::ListedWorld>> FetchList(const std::string& url, std::string& error) {
  const auto text = Download(url, error);
  auto listed = text ? command::ParseWorldList(*text, error) : std::nullopt;
  if (!listed) error = url + ": " + error;
  return listed;
}

}  // namespace

std::vector<World> ReadList(const std::string& where, std::string& error) {
  const bool isUrl = where.starts_with("http://") || where.starts_with("https://");
  const auto listed = isUrl ? FetchList(where, error) : command::LoadWorldList(where, error);
  std::vector<World> worlds;
  if (!listed) return worlds;
  for (const command::ListedWorld& each : *listed) {
    const auto address = command::ParseAddress(each.address, error);
    if (!address) continue;
    World& world = worlds.emplace_back(World{.address = each.address, .resolved = {}});
    world.told.name = each.name;
    world.told.scene = each.scene;
    const auto found = transport::vestibule::ResolveAddresses(address->host, address->port, error);
    if (!found.empty()) world.resolved = found.front();
  }
  error = worlds.empty() ? where + ": no world of it has an address" : "";
  return worlds;
}

}  // namespace wobble::list
