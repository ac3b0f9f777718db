// An address of the internet: IPv6, or IPv4 written as ::ffff:a.b.c.d.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace wobble::transport::vestibule {

struct NetAddress {
  std::array<std::uint8_t, 16> ip{};
  std::uint16_t port = 0;

  bool operator==(const NetAddress&) const = default;

  [[nodiscard]] bool IsIpv4() const {
    constexpr std::array<std::uint8_t, 12> kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
    return std::equal(kMapped.begin(), kMapped.end(), ip.begin());
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

}  // namespace wobble::transport::vestibule
