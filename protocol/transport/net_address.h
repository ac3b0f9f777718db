// An address of the internet: IPv6, or IPv4 written as ::ffff:a.b.c.d.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace wobble::transport {

struct NetAddress {
  std::array<std::uint8_t, 16> ip{};
  std::uint16_t port = 0;

  bool operator==(const NetAddress&) const = default;

  [[nodiscard]] bool IsIpv4() const {
    constexpr std::array<std::uint8_t, 12> kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
    return std::equal(kMapped.begin(), kMapped.end(), ip.begin());
  }
  // Of this machine itself: 127.0.0.0/8 or ::1.
  [[nodiscard]] bool IsLoopback() const {
    constexpr std::array<std::uint8_t, 16> kSelf{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    return IsIpv4() ? ip[12] == 127 : ip == kSelf;
  }
};

// The part of an address that one household or one rented machine shares: the /24 of an IPv4 address, the /64 of an
// IPv6 address. Whoever has one address of it usually has them all.
using Subnet = std::array<std::uint8_t, 16>;
[[nodiscard]] inline Subnet FindSubnet(const NetAddress& address) {
  Subnet subnet = address.ip;
  const std::ptrdiff_t kept = address.IsIpv4() ? 15 : 8;
  std::fill(subnet.begin() + kept, subnet.end(), std::uint8_t{0});
  return subnet;
}

// "192.0.2.1" or "2001:db8::1".
[[nodiscard]] std::string FormatIp(const NetAddress& address);
// "192.0.2.1:7777" or "[2001:db8::1]:7777".
[[nodiscard]] std::string Describe(const NetAddress& address);
// What FormatIp writes, with port 0; nullopt for anything else.
[[nodiscard]] std::optional<NetAddress> ParseIp(const std::string& text);

}  // namespace wobble::transport
