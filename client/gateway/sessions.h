// What a gateway does for one connection: its files, and once it asks to play, its way to the server.
//
// Of Asio alone, so that what is no HTTP and no WebSocket compiles without Beast.
#pragma once

#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/gateway/gateway.h"
#include "client/gateway/places.h"
#include "client/gateway/server_link.h"

namespace wobble::web {

struct GatewayCounts {
  std::uint64_t requests = 0;
  std::uint64_t requestsRefused = 0;  // answered with 4xx
  std::uint64_t socketsRefused = 0;   // too many
  std::uint64_t browsers = 0;
  std::uint64_t browsersRefused = 0;  // no place left
  std::uint64_t browsersCutOff = 0;   // for what they sent, or for not reading
  std::uint64_t snapshotsDropped = 0;
  std::uint64_t bytesUp = 0;  // messages of browsers
  std::uint64_t bytesDown = 0;
};

class Browser;

// What all connections have in common. It must outlive the context that their sockets belong to, but for the browsers,
// which must be gone before that.
struct Shared {
  const GatewayOptions& options;
  const Page& page;
  const std::string worlds;  // their names, as JSON
  Places sockets;
  Places players;
  GatewayCounts counts = {};
  std::vector<std::unique_ptr<ServerLink>> leaving = {};  // whose browsers have gone; to be polled until they end
  std::vector<std::shared_ptr<Browser>> browsers = {};
};

// A connection that has been accepted: from now on it lives by itself, and holds its place until it ends.
void Greet(Shared& shared, boost::asio::ip::tcp::socket socket, std::string address, Place place);

// To be called several hundred times a second: relays, and forgets those that have ended.
void TurnBrowsers(Shared& shared, double now);

// Tells all that the gateway is closing.
void CloseBrowsers(Shared& shared);

}  // namespace wobble::web
