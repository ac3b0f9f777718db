// The address of a server, in text form.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace wobble::command {

struct Address {
  std::string host;
  std::uint16_t port = 0;
};
// Reads 'HOST:PORT', port 1..65535; an IPv6 address stands in brackets: [::1]:7777. nullopt with one line in `error`.
[[nodiscard]] std::optional<Address> ParseAddress(const std::string& text, std::string& error);
// As ParseAddress reads it.
[[nodiscard]] std::string Describe(const Address& address);

}  // namespace wobble::command
