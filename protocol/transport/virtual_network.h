// A network inside the process, on virtual time: one server endpoint and any number of client endpoints, for tests.
//
// What it does to messages follows from the seed and the calls alone, on every machine and with every standard library.
// It models datagrams that are lost, late, out of order and twice there, and a reliable channel that pays for each loss
// with a retransmission. A limited rate holds for unreliable messages alone, and no connection dies of silence: the
// session layer sees to that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "protocol/limits.h"
#include "protocol/transport/link_conditions.h"
#include "protocol/transport/transport.h"

namespace wobble::transport {

// What happened to unreliable messages in one direction, all links together.
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

// Endpoints may outlive the network object and one another; whose far end has gone hears of it a trip later.
class VirtualNetwork {
 public:
  explicit VirtualNetwork(const VirtualNetworkOptions& options = {});
  ~VirtualNetwork();

  // Once.
  [[nodiscard]] std::unique_ptr<Transport> MakeServer();
  // A client that asks for its connection (id 1) with its first Poll. An endpoint sends at the `now` of its last Poll.
  [[nodiscard]] std::unique_ptr<Transport> MakeClient();

  // From now on, for all links; what is on its way keeps its fate. The conditions must be valid. The period of a
  // black-out counts from time 0.
  void SetConditions(const LinkConditions& bothWays);
  void SetConditions(const LinkConditions& toServer, const LinkConditions& toClients);
  // While black, nothing that is sent passes, either way; what is on its way does.
  void SetBlackout(bool isBlack);

  [[nodiscard]] LinkCounts CountsToServer() const;
  [[nodiscard]] LinkCounts CountsToClients() const;

  struct State;

 private:
  std::shared_ptr<State> m_state;
};

}  // namespace wobble::transport
