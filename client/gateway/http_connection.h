// The connections of a gateway: files for those that ask for them, a relay to the server for those that play.
//
// Includes Asio alone, so that code without HTTP and WebSockets compiles without Beast.
#pragma once

#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/gateway/certificate.h"
#include "client/gateway/films.h"
#include "client/gateway/gateway.h"
#include "client/gateway/key_doubts.h"
#include "client/gateway/lobby.h"
#include "client/gateway/places.h"
#include "client/gateway/rate_limit.h"
#include "client/gateway/server_link.h"

namespace wobble::gateway {

struct GatewayCounts {
  std::uint64_t requests = 0;
  std::uint64_t requestsRefused = 0;  // answered with 4xx
  std::uint64_t socketsRefused = 0;   // opened more often than an address may
  std::uint64_t browsers = 0;
  std::uint64_t browsersRefused = 0;  // no place left, or opened more often than an address may
  std::uint64_t browsersCutOff = 0;   // for what they sent, or for not reading
  std::uint64_t snapshotsDropped = 0;
  std::uint64_t bytesUp = 0;  // messages of browsers, channel bytes included
  std::uint64_t bytesDown = 0;
};

class Browser;

// Connections a second that an address may open, and how many at once: a browser opens up to six for files, a school
// has many browsers, and some proxies open one for each file. Of WebSockets for playing, each of which costs the server
// a handshake.
inline constexpr double kOpensPerSecond = 100, kOpensAtOnce = 1000;
inline constexpr double kPlaysPerSecond = 8, kPlaysAtOnce = 32;

// Shared by all connections. It must outlive the context that their sockets belong to; `browsers` must be cleared
// before that context ends.
struct Shared {
  const GatewayOptions& options;
  const Page& page;
  const std::string worlds;      // their names, as JSON
  std::unique_ptr<Films> films;  // null: no recordings may be watched
  Lobby visitors;                // connections that ask for files
  Lobby greeting;                // WebSockets that have not said hello
  Places players;
  AddressRates opens = {kOpensPerSecond, kOpensAtOnce};
  AddressRates plays = {kPlaysPerSecond, kPlaysAtOnce};
  KeyDoubts keyDoubts = {};
  TlsContext tls = {};     // of connections from now on; null: plain HTTP
  std::string list = {};   // of worlds elsewhere, as it is published; empty: none
  std::string pages = {};  // of these, the pages, as a JSON array
  GatewayCounts counts = {};
  std::vector<std::unique_ptr<ServerLink>> leaving = {};  // links of browsers that have gone; polled until they end
  std::vector<std::shared_ptr<Browser>> browsers = {};
};

// Serves a connection that has been accepted; it lives by its own handlers. peer: its address, as SpellAddress has it.
void Greet(Shared& shared, boost::asio::ip::tcp::socket socket, const std::string& peer);

// Relays for all browsers and drops those that have ended. To be called several hundred times a second.
void TurnBrowsers(Shared& shared, double now);

// Tells all browsers that the gateway is closing.
void CloseBrowsers(Shared& shared);

}  // namespace wobble::gateway
