// A network inside the process, on virtual time: one server endpoint and any number of client endpoints, for tests.
//
// Its behaviour follows from the seed and the calls alone, on every machine and with every standard library. It models
// datagrams that are lost, late, reordered and duplicated, and a reliable channel that pays for each loss with a
// retransmission. A limited rate holds for unreliable messages alone. Silence ends no connection; that is the session
// layer's task.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "protocol/limits.h"
#include "protocol/transport/link_conditions.h"
#include "protocol/transport/transport.h"

namespace wobble::transport {

// Counts of unreliable messages in one direction, all links together.
struct LinkCounts {
  std::uint64_t sent = 0;
  std::uint64_t lost = 0;  // black-outs included
  std::uint64_t duplicated = 0;
  std::uint64_t heldBack = 0;
};

struct VirtualNetworkOptions {
  std::uint64_t seed = 1;
  std::size_t maxConnections = 4096;
  double connectTimeout = protocol::kConnectTimeout;  // seconds from a client's first Poll
};

// Endpoints may outlive the network object and one another. An endpoint whose far end is destroyed is told a trip
// later.
class VirtualNetwork {
 public:
  explicit VirtualNetwork(const VirtualNetworkOptions& options = {});
  ~VirtualNetwork();

  // The server's endpoint; to be called once. An endpoint sends at the `now` of its last Poll.
  [[nodiscard]] std::unique_ptr<Transport> MakeServer();
  // A client's endpoint. It asks for its connection (id 1) with its first Poll.
  [[nodiscard]] std::unique_ptr<Transport> MakeClient();

  // Holds from now on for all links; messages on their way keep their fate. The conditions must be valid. The period of
  // a black-out counts from time 0.
  void SetConditions(const LinkConditions& bothWays);
  void SetConditions(const LinkConditions& toServer, const LinkConditions& toClients);
  // While black, nothing that is sent in either direction passes; messages on their way do.
  void SetBlackout(bool isBlack);

  [[nodiscard]] LinkCounts CountsToServer() const;
  [[nodiscard]] LinkCounts CountsToClients() const;

  struct State;

 private:
  std::shared_ptr<State> m_state;
};

}  // namespace wobble::transport
