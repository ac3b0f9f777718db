// Which bodies a client gets this time, within its share of the wire.
//
// Each body's priority grows with every snapshot, faster when near, until it is sent: near bodies come every time, far
// ones take turns, none starves (Fiedler, "State Synchronization"). The own body goes first.
#pragma once

#include <cstdint>
#include <functional>
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
  std::vector<Interest> interests;  // by ascending body, as those shown
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

  // Of the body at an index of those shown; asked for those alone that are sent.
  using ReadRecords = std::function<Records(std::size_t index)>;

  // ownBody: 0 for a spectator, who looks from the origin. head: sequence is filled in here. creditBytes: what the
  // client's budget grew by since the last snapshot.
  void Send(std::span<const ShownBody> bodies, const ReadRecords& readRecords, std::uint32_t ownBody,
            protocol::SnapshotHead head, double creditBytes, double now, transport::ConnectionId connection,
            Subscription& subscription);

  [[nodiscard]] const SendCounts& Counts() const { return m_counts; }

 private:
  // Each body's turn by its priority: index and priority in one number, which orders faster than a look into two lists.
  using Turn = std::uint64_t;

  void RaisePriorities(std::span<const ShownBody> bodies, std::uint32_t ownBody, Subscription& subscription);
  [[nodiscard]] std::size_t TakeNext(std::size_t taken);
  void SendPacket(protocol::SnapshotHead head, double now, transport::ConnectionId connection,
                  Subscription& subscription);

  transport::Transport& m_transport;
  protocol::PacketBuilder m_packet;
  std::vector<Turn> m_turns;  // scratch: by falling priority up to m_sorted
  std::size_t m_sorted = 0;
  SendCounts m_counts;
};

}  // namespace wobble::server
