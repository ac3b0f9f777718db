#include "client/command/address.h"

#include <charconv>

namespace wobble::command {

std::optional<Address> ParseAddress(const std::string& text, std::string& error) {
  const std::size_t colon = text.rfind(':');
  Address address;
  const char* end = text.data() + text.size();
  const char* begin = colon == std::string::npos ? end : text.data() + colon + 1;
  const auto [stop, result] = std::from_chars(begin, end, address.port);
  if (colon == std::string::npos || colon == 0 || result != std::errc{} || stop != end || address.port == 0) {
    error = "'" + text + "' is no HOST:PORT with a port of 1 to 65535";
    return std::nullopt;
  }
  address.host = text.substr(0, colon);
  return address;
}

std::string Describe(const Address& address) { return address.host + ":" + std::to_string(address.port); }

}  // namespace wobble::command
