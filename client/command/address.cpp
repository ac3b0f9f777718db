#include "client/command/address.h"

#include <charconv>

namespace wobble::command {

std::optional<Address> ParseAddress(const std::string& text, std::string& error) {
  const std::size_t colon = text.rfind(':');
  Address address;
  const char* end = text.data() + text.size();
  const char* begin = colon == std::string::npos ? end : text.data() + colon + 1;
  const auto [stop, result] = std::from_chars(begin, end, address.port);
  const bool isPort = result == std::errc{} && stop == end && address.port != 0;
  address.host = text.substr(0, colon == std::string::npos ? 0 : colon);
  const bool isBracketed = address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']';
  // Without brackets nobody knows where an IPv6 address ends.
  const bool isHost = !address.host.empty() && (isBracketed || address.host.find(':') == std::string::npos);
  if (!isHost || !isPort) {
    error = "'" + text + "' is no HOST:PORT with a port of 1 to 65535";
    return std::nullopt;
  }
  if (isBracketed) address.host = address.host.substr(1, address.host.size() - 2);
  return address;
}

std::string Describe(const Address& address) {
  const bool isIpv6 = address.host.find(':') != std::string::npos;
  return (isIpv6 ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
}

}  // namespace wobble::command
