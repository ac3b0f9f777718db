// Nothing is sent and no name is looked up: the system lists the addresses. Which network of a machine with several the
// friends are in nobody can tell, so the choice is by likelihood.
#include "client/command/lan_address.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string_view>

namespace wobble::command {
namespace {

// How likely friends reach an address; the least is the likeliest.
enum class Reach { kPrivate, kPublic, kIpv6, kTunnel };

// Names that container engines and hypervisors give to networks inside this machine.
constexpr std::string_view kInside[] = {"docker", "veth", "virbr", "vmnet",  "vboxnet", "lxc",
                                        "lxd",    "cni",  "cali",  "podman", "flannel", "kube"};

bool IsInside(const std::string& interface) {
  constexpr std::size_t kDockersName = 15;  // "br-" and twelve digits; people call bridges of theirs br-lan
  if (interface.starts_with("br-")) return interface.size() == kDockersName;
  return std::any_of(std::begin(kInside), std::end(kInside),
                     [&](std::string_view prefix) { return interface.starts_with(prefix); });
}

// RFC 1918.
bool IsPrivate(std::uint32_t ipv4) {
  return ipv4 >> 24 == 10 || ipv4 >> 20 == (172 << 4 | 1) || ipv4 >> 16 == (192 << 8 | 168);
}

std::optional<Reach> FindReach(const InterfaceAddress& each) {
  if (!each.isUp || IsInside(each.interface)) return std::nullopt;
  in_addr ipv4{};
  in6_addr ipv6{};
  std::optional<Reach> reach;
  if (inet_pton(AF_INET, each.address.c_str(), &ipv4) == 1) {
    const std::uint32_t number = ntohl(ipv4.s_addr);
    const bool isLinkLocal = number >> 16 == (169 << 8 | 254);
    if (number >> 24 == 127 || number == 0 || isLinkLocal) return std::nullopt;
    reach = IsPrivate(number) ? Reach::kPrivate : Reach::kPublic;
  } else if (inet_pton(AF_INET6, each.address.c_str(), &ipv6) == 1) {
    if (IN6_IS_ADDR_LOOPBACK(&ipv6) || IN6_IS_ADDR_UNSPECIFIED(&ipv6) || IN6_IS_ADDR_LINKLOCAL(&ipv6)) {
      return std::nullopt;
    }
    reach = Reach::kIpv6;
  }
  return reach && each.isPointToPoint ? Reach::kTunnel : reach;
}

std::vector<InterfaceAddress> ListInterfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(first, freeifaddrs);
  std::vector<InterfaceAddress> all;
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr) continue;
    const int family = each->ifa_addr->sa_family;
    if (family != AF_INET && family != AF_INET6) continue;
    const void* bytes = family == AF_INET
                            ? static_cast<const void*>(&reinterpret_cast<const sockaddr_in*>(each->ifa_addr)->sin_addr)
                            : &reinterpret_cast<const sockaddr_in6*>(each->ifa_addr)->sin6_addr;
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (inet_ntop(family, bytes, text.data(), text.size()) == nullptr) continue;
    all.push_back({.interface = each->ifa_name,
                   .address = text.data(),
                   .isUp = (each->ifa_flags & IFF_UP) != 0,
                   .isPointToPoint = (each->ifa_flags & IFF_POINTOPOINT) != 0});
  }
  return all;
}

bool IsIpv6(const std::string& address) { return address.find(':') != std::string::npos; }

}  // namespace

std::vector<std::string> ChooseLanAddresses(const std::vector<InterfaceAddress>& all) {
  std::vector<std::pair<Reach, std::string>> found;
  for (const InterfaceAddress& each : all) {
    if (const auto reach = FindReach(each)) found.emplace_back(*reach, each.address);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> addresses;
  for (auto& [reach, address] : found) addresses.push_back(std::move(address));
  return addresses;
}

std::vector<std::string> FindLanAddresses(const std::string& bind) {
  if (bind != "0.0.0.0" && bind != "::") return ChooseLanAddresses({{.interface = "", .address = bind}});
  std::vector<std::string> addresses = ChooseLanAddresses(ListInterfaces());
  if (bind == "0.0.0.0") std::erase_if(addresses, IsIpv6);
  return addresses;
}

std::string MakePageUrl(const std::string& scheme, const std::string& address, unsigned port) {
  const bool isUsual = port == (scheme == "https" ? 443U : 80U);
  return scheme + "://" + (IsIpv6(address) ? "[" + address + "]" : address) +
         (isUsual ? "" : ":" + std::to_string(port)) + "/";
}

}  // namespace wobble::command
