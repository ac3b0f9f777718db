#include "client/host/ports.h"

#include <algorithm>

#include "client/command/show_page.h"
#include "client/command/sockets.h"

namespace wobble::host {
namespace {

struct Listener {
  std::string what;   // "ops of the world arena"
  std::string where;  // for messages: "worlds.toml:7: ops = '9100'"
  std::string host;
  std::string port;
};

bool IsEverywhere(const std::string& host) { return host.empty() || host == "0.0.0.0" || host == "[::]"; }

bool AreOne(const Listener& a, const Listener& b) {
  const bool canMeet = a.host == b.host || IsEverywhere(a.host) || IsEverywhere(b.host);
  return canMeet && a.port == b.port && a.port != "0";
}

std::vector<Listener> ListListeners(const WorldsFile& file) {
  std::vector<Listener> listeners;
  if (file.hasGateway) {
    listeners.push_back({"the page", "", FindWord(file.gateway, "bind", ""),
                         FindWord(file.gateway, "http", std::to_string(command::kPagePort))});
  }
  for (const World& world : file.worlds) {
    for (const char* key : {"ops", "admin_http", "rcon"}) {
      const auto value = world.own.find(key);
      if (value == world.own.end()) continue;
      const std::string& text = value->second.words.front();  // HOST:PORT, or PORT of this machine alone
      const std::size_t colon = text.rfind(':');
      const bool hasHost = colon != std::string::npos;
      listeners.push_back({std::string(key) + " of the world " + world.name,
                           value->second.where + ": " + key + " = " + value->second.shown,
                           hasHost ? text.substr(0, colon) : "127.0.0.1", hasHost ? text.substr(colon + 1) : text});
    }
  }
  return listeners;
}

}  // namespace

std::vector<std::string> FindPortClashes(const WorldsFile& file) {
  std::vector<std::string> clashes;
  const std::vector<Listener> listeners = ListListeners(file);
  for (auto own = listeners.begin(); own != listeners.end(); ++own) {
    const auto other = std::find_if(listeners.begin(), own, [&](const Listener& each) { return AreOne(each, *own); });
    if (other != own) clashes.push_back(own->where + ": " + other->what + " has port " + own->port + " already");
  }
  return clashes;
}

std::string FindTakenPort(const Plan& plan) {
  using command::PortKind;
  std::string error;
  for (const WorldPlan& world : plan.worlds) {
    const bool isBracketed = world.host.front() == '[';
    const std::string host = isBracketed ? world.host.substr(1, world.host.size() - 2) : world.host;
    if (!command::IsFree(PortKind::kUdp, host, world.port, error)) return "the " + world.title + ": " + error;
  }
  const auto& gateway = plan.gateway;
  const bool isPageFree = !gateway || command::IsFree(PortKind::kTcp, gateway->bindAddress, gateway->port, error);
  return isPageFree ? "" : "the page's " + error;
}

}  // namespace wobble::host
