// The way into the world for browsers: serves the page, and relays the WebSocket of each to a connection of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "client/command/address.h"
#include "client/command/command.h"
#include "client/gateway/page_files.h"

namespace wobble::web {

// A server, and what the page calls it; without a name it is the only one.
struct World {
  std::string name;  // letters, digits, - and _, or empty
  tool::Address server;
};

struct GatewayOptions {
  std::string bindAddress = "0.0.0.0";  // numeric, IPv4 or IPv6
  std::uint16_t port = 8080;            // TCP; 0: any that is free
  std::vector<World> worlds;            // at least one; names differ
  std::size_t maxConnections = 64;      // browsers that play
  std::size_t maxPerAddress = 0;        // of one IP address; 0: as many as maxConnections
  std::vector<std::string> origins;     // whose pages may play beside our own
  double statusEvery = 0;               // seconds between status lines; 0: none
};

// Until isStopAsked. Returns the exit code: 0, or 2 with one line on standard error when the port cannot be had or
// nobody knows a server's name. The first line on standard output says what to open, once it can be opened.
[[nodiscard]] int RunGateway(const GatewayOptions& options, const Page& page, const tool::IsStopAsked& isStopAsked);

}  // namespace wobble::web
