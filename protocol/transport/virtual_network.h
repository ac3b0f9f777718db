// A network inside the process, on virtual time: one server endpoint and any number of client endpoints, for tests.
//
// What it does to messages follows from the seed and the calls alone, on every machine and with every standard library.
// It models datagrams that are lost, late, out of order and twice there, and a reliable channel that pays for each loss
// with a retransmission. It does not model bandwidth, and no connection dies of silence: the session layer sees to
// that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/limits.h"
#include "protocol/transport/transport.h"

namespace wobble::transport {

// One direction of every link. Shares are 0..1, times seconds, 0..10.
struct LinkConditions {
  double loss = 0;             // share of datagrams that never arrive
  double delay = 0;            // one way
  double jitter = 0;           // added to the delay, uniform in 0..jitter
  double duplicate = 0;        // share of datagrams that arrive twice, each with its own jitter
  double reorder = 0;          // share held back by reorderDelay, on top of what jitter reorders
  double reorderDelay = 0.05;  // a frame and a half at 30 Hz
};

// One line for each field out of its range, with value and range; empty when all are good.
[[nodiscard]] std::vector<std::string> ValidateLinkConditions(const LinkConditions& conditions);

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
  double connectTimeout = 5;  // seconds from a client's first Poll
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

  // From now on, for all links; what is on its way keeps its fate. The conditions must be valid.
  void SetConditions(const LinkConditions& bothWays);
  void SetConditions(const LinkConditions& toServer, const LinkConditions& toClients);
  // While black, nothing that is sent passes, either way.
  void SetBlackout(bool isBlack);

  [[nodiscard]] LinkCounts CountsToServer() const;
  [[nodiscard]] LinkCounts CountsToClients() const;

  struct State;

 private:
  std::shared_ptr<State> m_state;
};

}  // namespace wobble::transport
