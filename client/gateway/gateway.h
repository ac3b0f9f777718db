// The gateway for browsers: serves the page, and relays each browser's WebSocket to a server over a connection of its
// own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/command/address.h"
#include "client/command/command.h"
#include "client/command/show_page.h"
#include "client/gateway/certificate.h"
#include "client/gateway/page_files.h"
#include "protocol/transport/vestibule/keys.h"

namespace wobble::gateway {

// A server and its name on the page; a server without a name is the only one.
struct World {
  std::string name;  // letters, digits, - and _; or empty
  command::Address server;
};

struct GatewayOptions {
  std::string bindAddress = "0.0.0.0";      // numeric, IPv4 or IPv6
  std::uint16_t port = command::kPagePort;  // 0: the system picks a free one
  std::vector<World> worlds;                // at least one; names differ
  std::string recordings;                   // folder of those that may be watched; empty: none
  std::size_t maxConnections = 64;          // browsers that play at once
  std::size_t maxPerAddress = 0;            // of one IP address; 0: maxConnections
  std::vector<std::string> proxies;         // whose X-Forwarded-For is believed; as SpellAddress has them
  // With it servers that have the same key are told the browsers' addresses.
  std::optional<transport::vestibule::Key> gatewayKey;
  std::vector<std::string> origins;  // origins whose pages may play, besides the gateway's own page
  double statusEvery = 0;            // seconds between status lines; 0: none
  TlsFiles tls;                      // read again when they change
  std::string list;                  // file of worlds elsewhere, read again when it changes; empty: none
};

// Runs until isStopAsked returns true. Returns the exit code: 0, or 2 with one line on standard error when the port
// cannot be bound, a server's name cannot be resolved or a file cannot be used. The first line on standard output names
// the address to open, once it can be opened.
[[nodiscard]] int RunGateway(const GatewayOptions& options, const Page& page, const command::IsStopAsked& isStopAsked);

}  // namespace wobble::gateway
