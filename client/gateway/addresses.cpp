#include "client/gateway/addresses.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <string>

namespace wobble::gateway {
namespace {

std::string SpellIpv6(const in6_addr& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  return inet_ntop(AF_INET6, &address, text.data(), text.size());
}

std::string_view TrimSpace(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  return begin == std::string_view::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

}  // namespace

std::string SpellAddress(std::string_view text) {
  const std::string copy(text);
  in_addr ipv4{};
  if (inet_pton(AF_INET, copy.c_str(), &ipv4) == 1) return copy;  // it has one spelling
  in6_addr ipv6{};
  if (inet_pton(AF_INET6, copy.c_str(), &ipv6) != 1) return "";
  const std::string spelt = SpellIpv6(ipv6);
  constexpr std::string_view kMapped = "::ffff:";
  return IN6_IS_ADDR_V4MAPPED(&ipv6) ? spelt.substr(kMapped.size()) : spelt;
}

bool IsLoopback(const std::string& address) { return address == "::1" || address.starts_with("127."); }

bool IsLoopbackHost(std::string_view host) {
  const std::size_t colon = host.find_last_of(":]");
  if (colon != std::string_view::npos && host[colon] == ':') host = host.substr(0, colon);
  return host == "localhost" || host == "[::1]" || IsLoopback(SpellAddress(host));
}

bool IsTrusted(const std::string& address, const std::vector<std::string>& trusted) {
  return std::find(trusted.begin(), trusted.end(), address) != trusted.end();
}

std::string FindBrowserAddress(const std::string& peer, std::string_view forwardedFor,
                               const std::vector<std::string>& trusted) {
  std::string nearest = peer;
  while (IsTrusted(nearest, trusted) && !TrimSpace(forwardedFor).empty()) {
    const std::size_t comma = forwardedFor.rfind(',');
    const bool isFirst = comma == std::string_view::npos;
    std::string next = SpellAddress(TrimSpace(isFirst ? forwardedFor : forwardedFor.substr(comma + 1)));
    if (next.empty()) return nearest;
    nearest = std::move(next);
    forwardedFor = isFirst ? "" : forwardedFor.substr(0, comma);
  }
  return nearest;
}

std::string FindHousehold(const std::string& address) {
  in6_addr ipv6{};
  if (inet_pton(AF_INET6, address.c_str(), &ipv6) != 1) return address;
  std::fill(ipv6.s6_addr + 8, ipv6.s6_addr + 16, static_cast<unsigned char>(0));
  return SpellIpv6(ipv6) + "/64";
}

}  // namespace wobble::gateway
