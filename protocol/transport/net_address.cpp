#include "protocol/transport/net_address.h"

#include <arpa/inet.h>

namespace wobble::transport {

std::string FormatIp(const NetAddress& address) {
  char text[INET6_ADDRSTRLEN] = "?";
  const bool isIpv4 = address.IsIpv4();
  inet_ntop(isIpv4 ? AF_INET : AF_INET6, address.ip.data() + (isIpv4 ? 12 : 0), text, sizeof text);
  return text;
}

std::string Describe(const NetAddress& address) {
  const std::string ip = FormatIp(address);
  return (address.IsIpv4() ? ip : "[" + ip + "]") + ":" + std::to_string(address.port);
}

std::optional<NetAddress> ParseIp(const std::string& text) {
  NetAddress address;
  if (inet_pton(AF_INET6, text.c_str(), address.ip.data()) == 1) return address;
  address.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
  if (inet_pton(AF_INET, text.c_str(), address.ip.data() + 12) == 1) return address;
  return {};
}

}  // namespace wobble::transport
