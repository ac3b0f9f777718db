// Avahi has two libraries for the same, see server/discovery/announcement.cpp.
#include "client/list/lan.h"

#include <avahi-client/client.h>
#include <avahi-client/lookup.h>
#include <avahi-common/error.h>
#include <avahi-common/malloc.h>
#include <avahi-common/simple-watch.h>
#include <avahi-common/strlst.h>
#include <avahi-core/core.h>
#include <avahi-core/log.h>
#include <avahi-core/lookup.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <memory>

#include "client/command/address.h"
#include "client/command/clock.h"

namespace wobble::list {
namespace {

using command::ReadClock;

constexpr const char* kService = "_wobble._udp";
constexpr int kTurnMs = 50;
// Anybody in the network may announce as many as they like.
constexpr std::size_t kMostWorlds = 1000;
constexpr std::size_t kMostAsked = 4 * kMostWorlds;  // by each interface, and by IPv4 and IPv6

// Where a service was seen.
struct Place {
  AvahiIfIndex interface;
  AvahiProtocol protocol;
};

// By the service's name and port, the IPv4 address first.
using Found = std::map<std::pair<std::string, std::uint16_t>, World>;

std::string FindWord(AvahiStringList* words, const char* name) {
  AvahiStringList* entry = avahi_string_list_find(words, name);
  char* value = nullptr;
  if (entry == nullptr || avahi_string_list_get_pair(entry, nullptr, &value, nullptr) < 0 || value == nullptr)
    return {};
  std::string text = value;
  avahi_free(value);
  return text;
}

void Note(Found& found, const char* name, const AvahiAddress& address, std::uint16_t port, AvahiStringList* words) {
  std::array<char, AVAHI_ADDRESS_STR_MAX> text{};
  avahi_address_snprint(text.data(), text.size(), &address);
  const auto resolved = transport::ParseIp(text.data());
  const bool isLinkLocal = address.proto == AVAHI_PROTO_INET6 && address.data.ipv6.address[0] == 0xFE &&
                           (address.data.ipv6.address[1] & 0xC0U) == 0x80;
  if (!resolved || isLinkLocal || port == 0 || found.size() >= kMostWorlds) return;
  World& world = found[{name, port}];
  if (world.resolved.port != 0 && world.resolved.IsIpv4()) return;
  world = {.address = command::Describe(command::Address{text.data(), port}), .resolved = *resolved};
  world.resolved.port = port;
  world.told.name = name;
  world.told.scene = FindWord(words, "scene");
  world.told.version = FindWord(words, "version");
  world.key = FindWord(words, "key");
}

struct Daemon {
  using Host = AvahiClient;
  static Host* MakeHost(const AvahiPoll* poll, int* error) {
    const auto ignore = [](AvahiClient*, AvahiClientState, void*) {};
    return avahi_client_new(poll, AvahiClientFlags{}, ignore, nullptr, error);
  }
  template <class Browser>
  static bool Browse(Host* host, Browser* browser) {
    const auto take = [](AvahiServiceBrowser*, AvahiIfIndex interface, AvahiProtocol protocol, AvahiBrowserEvent event,
                         const char* name, const char* type, const char* domain, AvahiLookupResultFlags, void* data) {
      static_cast<Browser*>(data)->TakeService({interface, protocol}, event, name, type, domain);
    };
    return avahi_service_browser_new(host, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC, kService, nullptr, AvahiLookupFlags{},
                                     take, browser) != nullptr;
  }
  template <class Browser>
  static void Resolve(Host* host, Browser* browser, const Place& place, const char* name, const char* type,
                      const char* domain) {
    const auto take = [](AvahiServiceResolver* resolver, AvahiIfIndex, AvahiProtocol, AvahiResolverEvent event,
                         const char* found, const char*, const char*, const char*, const AvahiAddress* address,
                         std::uint16_t port, AvahiStringList* words, AvahiLookupResultFlags, void* data) {
      if (event == AVAHI_RESOLVER_FOUND) Note(static_cast<Browser*>(data)->found, found, *address, port, words);
      avahi_service_resolver_free(resolver);
    };
    avahi_service_resolver_new(host, place.interface, place.protocol, name, type, domain, place.protocol,
                               AvahiLookupFlags{}, take, browser);
  }
  static void Free(Host* host) { avahi_client_free(host); }
};

struct Listener {
  using Host = AvahiServer;
  static Host* MakeHost(const AvahiPoll* poll, int* error) {
    AvahiServerConfig config;
    avahi_server_config_init(&config);
    config.disable_publishing = 1;
    config.enable_wide_area = 0;
    const auto ignore = [](AvahiServer*, AvahiServerState, void*) {};
    Host* host = avahi_server_new(poll, &config, ignore, nullptr, error);
    avahi_server_config_free(&config);
    return host;
  }
  template <class Browser>
  static bool Browse(Host* host, Browser* browser) {
    const auto take = [](AvahiSServiceBrowser*, AvahiIfIndex interface, AvahiProtocol protocol, AvahiBrowserEvent event,
                         const char* name, const char* type, const char* domain, AvahiLookupResultFlags, void* data) {
      static_cast<Browser*>(data)->TakeService({interface, protocol}, event, name, type, domain);
    };
    return avahi_s_service_browser_new(host, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC, kService, nullptr, AvahiLookupFlags{},
                                       take, browser) != nullptr;
  }
  template <class Browser>
  static void Resolve(Host* host, Browser* browser, const Place& place, const char* name, const char* type,
                      const char* domain) {
    const auto take = [](AvahiSServiceResolver* resolver, AvahiIfIndex, AvahiProtocol, AvahiResolverEvent event,
                         const char* found, const char*, const char*, const char*, const AvahiAddress* address,
                         std::uint16_t port, AvahiStringList* words, AvahiLookupResultFlags, void* data) {
      if (event == AVAHI_RESOLVER_FOUND) Note(static_cast<Browser*>(data)->found, found, *address, port, words);
      avahi_s_service_resolver_free(resolver);
    };
    avahi_s_service_resolver_new(host, place.interface, place.protocol, name, type, domain, place.protocol,
                                 AvahiLookupFlags{}, take, browser);
  }
  static void Free(Host* host) { avahi_server_free(host); }
};

template <class Api>
class Browser {
 public:
  Browser() = default;
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;
  ~Browser() {
    if (m_host != nullptr) Api::Free(m_host);
  }

  // False with one line in `error`: Avahi, of this kind, is not there.
  bool Start(const AvahiPoll* poll, std::string& error) {
    int code = 0;
    m_host = Api::MakeHost(poll, &code);
    if (m_host != nullptr && Api::Browse(m_host, this)) return true;
    error = avahi_strerror(code);
    return false;
  }
  void TakeService(const Place& place, AvahiBrowserEvent event, const char* name, const char* type,
                   const char* domain) {
    if (event != AVAHI_BROWSER_NEW || ++m_asked > kMostAsked) return;
    Api::Resolve(m_host, this, place, name, type, domain);
  }

  Found found;

 private:
  typename Api::Host* m_host = nullptr;
  std::size_t m_asked = 0;
};

struct PollDeleter {
  void operator()(AvahiSimplePoll* poll) const { avahi_simple_poll_free(poll); }
};

}  // namespace

std::vector<World> BrowseLan(double seconds, const std::function<bool()>& isStopAsked, std::string& error) {
  avahi_set_log_function([](AvahiLogLevel, const char*) {});
  const std::unique_ptr<AvahiSimplePoll, PollDeleter> poll(avahi_simple_poll_new());
  Browser<Daemon> daemon;
  Browser<Listener> listener;
  if (!daemon.Start(avahi_simple_poll_get(poll.get()), error) &&
      !listener.Start(avahi_simple_poll_get(poll.get()), error)) {
    error = "the local network cannot be browsed: " + error;
    return {};
  }
  error.clear();
  for (const double end = ReadClock() + seconds; ReadClock() < end && !isStopAsked();) {
    if (avahi_simple_poll_iterate(poll.get(), kTurnMs) != 0) break;
  }
  std::vector<World> worlds;
  for (Found* found : {&daemon.found, &listener.found}) {
    for (auto& [name, world] : *found) worlds.push_back(std::move(world));
  }
  return worlds;
}

}  // namespace wobble::list
