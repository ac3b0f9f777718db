// Where machines and administrators reach a server by TCP.
#pragma once

#include <cstdint>
#include <string>

namespace wobble::ops {

struct Address {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;  // 0: the system picks a free one
};
// Parses HOST:PORT, [IPv6]:PORT, or PORT alone for the loopback address. Returns false with one line in `error`.
[[nodiscard]] bool ParseAddress(const std::string& text, Address& address, std::string& error);

// Whether only programs of this machine reach it.
[[nodiscard]] bool IsThisMachine(const Address& address);

}  // namespace wobble::ops
