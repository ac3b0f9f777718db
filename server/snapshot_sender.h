// Which bodies a client gets this time, within its share of the wire.
//
// Each body's priority grows with every snapshot, faster when near, until it is sent: near bodies come every time, far
// ones take turns, none starves (Fiedler, "State Synchronization"). The own body goes first.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/acknowledgement.h"
#include "protocol/snapshot.h"
#include "protocol/transport/transport.h"
#include "server/encoder.h"

namespace wobble::server {

// A client's view of the sending.
struct Subscription {
  struct Interest {
    std::uint32_t body = 0;
    float priority = 0;
  };
  std::vector<Interest> interests;  // by ascending body, as the encoded ones
  protocol::SentWindow sent;
  double credit = 0;  // bytes that may be sent; below zero after a record that just went over
};

struct SendCounts {
  std::uint64_t packets = 0;
  std::uint64_t bytes = 0;          // payloads
  std::uint64_t bodiesLeftOut = 0;  // for want of budget, to come later
};

class SnapshotSender {
 public:
  explicit SnapshotSender(transport::Transport& transport) : m_transport(transport) {}

  // ownBody: 0 for a spectator, who looks from the origin. head: sequence is filled in here. creditBytes: what the
  // client's budget grew by since the last snapshot.
  void Send(std::span<const EncodedBody> bodies, std::uint32_t ownBody, protocol::SnapshotHead head, double creditBytes,
            double now, transport::ConnectionId connection, Subscription& subscription);

  [[nodiscard]] const SendCounts& Counts() const { return m_counts; }

 private:
  void RaisePriorities(std::span<const EncodedBody> bodies, std::uint32_t ownBody, Subscription& subscription) const;
  void SendPacket(protocol::SnapshotHead head, double now, transport::ConnectionId connection,
                  Subscription& subscription);

  transport::Transport& m_transport;
  protocol::PacketBuilder m_packet;
  std::vector<std::size_t> m_order;  // scratch: indices of bodies by falling priority
  SendCounts m_counts;
};

}  // namespace wobble::server
