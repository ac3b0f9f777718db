// The addresses of this machine by which others in the same network reach it.
#pragma once

#include <string>
#include <vector>

namespace wobble::command {

// An address of one of this machine's network interfaces.
struct InterfaceAddress {
  std::string interface;  // its name, such as "eth0"
  std::string address;    // numeric, without a zone
  bool isUp = true;
  bool isPointToPoint = false;  // a tunnel, such as a VPN's
};

// Those that friends can reach, the likeliest first: private IPv4 addresses, then other IPv4 ones, then IPv6, and
// tunnels after all. Neither loopback nor link-local addresses, nor the bridges of containers and virtual machines.
[[nodiscard]] std::vector<std::string> ChooseLanAddresses(const std::vector<InterfaceAddress>& all);

// Those of this machine at which a program that listens at `bind` is reached. bind: numeric; 0.0.0.0 and :: are all of
// IPv4, and all. Empty when only this machine reaches it.
[[nodiscard]] std::vector<std::string> FindLanAddresses(const std::string& bind);

// As a URL has it: http://192.168.1.5:8080/, an IPv6 address in brackets, without the scheme's own port.
// scheme: http or https.
[[nodiscard]] std::string MakePageUrl(const std::string& scheme, const std::string& address, unsigned port);

}  // namespace wobble::command
