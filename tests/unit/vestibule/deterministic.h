// Randomness that repeats, and addresses, for tests of the vestibule.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "protocol/transport/vestibule/caller.h"
#include "protocol/transport/vestibule/door.h"

namespace wobble::transport::vestibule {

using Bytes = std::vector<std::uint8_t>;

inline RandomSource MakeRandom(std::uint64_t seed) {
  return [random = std::mt19937_64(seed)](std::span<std::uint8_t> bytes) mutable {
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  };
}

inline NetAddress MakeAddress(std::uint8_t a, std::uint8_t b, std::uint8_t c, std::uint8_t d, std::uint16_t port) {
  return {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, a, b, c, d}, port};
}

// ENet's datagrams of a client, as far as the door looks at them. number: of the connection.
inline Bytes MakeConnect(std::uint32_t number) {
  Bytes bytes{0x8F, 0xFF, 0, 1, 0, 0, 0, 0, 0x82, 0xFF, 0, 1};
  bytes.resize(8 + 48);
  for (int i = 0; i < 4; ++i)
    bytes[static_cast<std::size_t>(8 + 40 + i)] = static_cast<std::uint8_t>(number >> (24 - 8 * i));
  return bytes;
}
// A reliable message of `size` bytes on a channel.
inline Bytes MakeReliable(std::uint16_t number, std::size_t size, std::uint8_t channel = 0) {
  Bytes bytes{0,
              0,
              0,
              0,
              0,
              0,
              0x86,
              channel,
              static_cast<std::uint8_t>(number >> 8U),
              static_cast<std::uint8_t>(number),
              static_cast<std::uint8_t>(size >> 8U),
              static_cast<std::uint8_t>(size)};
  bytes.resize(bytes.size() + size);
  return bytes;
}

inline KeyPair MakeIdentity() {
  Key secret{};
  secret[3] = 7;
  return MakeKeyPair(secret);
}

}  // namespace wobble::transport::vestibule
