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
  const bool isBracketed = address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']';
  if (isBracketed) address.host = address.host.substr(1, address.host.size() - 2);
  return address;
}

std::string Describe(const Address& address) {
  const bool isIpv6 = address.host.find(':') != std::string::npos;
  return (isIpv6 ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
}

}  // namespace wobble::command
