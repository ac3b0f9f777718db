#include "server/ops/address.h"

#include <charconv>

namespace wobble::ops {

bool ParseAddress(const std::string& text, Address& address, std::string& error) {
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  std::string host = colon == std::string::npos ? address.host : text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  std::uint16_t port = 0;
  const auto [end, result] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (result != std::errc{} || end != digits.data() + digits.size() || host.empty()) {
    error = "'" + text + "': must be HOST:PORT or PORT, with a PORT of 0 to 65535";
    return false;
  }
  address = {host, port};
  return true;
}

bool IsThisMachine(const Address& address) {
  return address.host == "localhost" || address.host.starts_with("127.") || address.host == "::1";
}

}  // namespace wobble::ops
