// Which bodies a client gets this time, and how exactly, within its share of the wire.
//
// Each body's priority grows with every snapshot, faster when it is near or fast, until it is sent: near bodies come
// every time, far ones take turns, none starves (Fiedler, "State Synchronization"). The own body goes first. What lies
// still is sent until the client has it, what is out of view never. Where bodies are left out all the same, all are
// sent less exactly, before they are sent less often: the own one too, or each player's body would be encoded twice,
// once for him and once for all others, and 1 % of a ball of 1 m is less than a pixel from where its player looks on.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "protocol/snapshot.h"
#include "protocol/transport/transport.h"
#include "server/snapshots/encoder.h"
#include "server/snapshots/subscription.h"
#include "server/timing/bins.h"

namespace wobble::server {

// Shares of a body's size: of the error of a body as it was sent.
inline constexpr std::array<double, 9> kErrorBounds{0.0005, 0.001, 0.0015, 0.002, 0.0025, 0.005, 0.01, 0.02, 0.05};

struct SendCounts {
  std::uint64_t packets = 0;
  std::uint64_t packetsLost = 0;      // that clients do not have, as far as their acknowledgements tell
  std::uint64_t bytes = 0;            // payloads
  std::uint64_t bodiesLeftOut = 0;    // for want of budget, to come later
  std::uint64_t bodiesCoarsened = 0;  // sent at less than the best quality
  std::uint64_t bodiesOutOfView = 0;  // too far away
  // Of all records that went out:
  std::uint64_t vertices = 0;
  std::uint64_t recordBytes = 0;
  double errorSquares = 0;  // EncodedBody
  Bins<kErrorBounds> errors;

  [[nodiscard]] double BitsPerVertex() const;    // 0 when there was none
  [[nodiscard]] double ErrorPercentRms() const;  // of the body's size
};

// Whose turn it is: bodies whose number leaves `group` when it is divided by `groups`.
struct Share {
  std::uint32_t group = 0;
  std::uint32_t groups = 1;

  [[nodiscard]] bool Has(std::uint32_t body) const { return body % groups == group; }
};

class SnapshotSender {
 public:
  // viewDistance: m; bodies further from a player's own, or from a spectator's origin, are not sent.
  SnapshotSender(transport::Transport& transport, double viewDistance)
      : m_transport(transport), m_viewDistance(static_cast<float>(viewDistance)) {}

  // Of the body at an index of those shown; asked for those alone that are sent. quality: of kSnapshotErrorShares.
  using ReadBody = std::function<const EncodedBody&(std::size_t index, std::size_t quality)>;

  // ownBody: 0 for a spectator, who looks from the origin. head: sequence is filled in here. share: of the bodies.
  // creditBytes: what the client's budget grew by since the last call.
  void Send(std::span<const ShownBody> bodies, const ReadBody& readBody, std::uint32_t ownBody,
            protocol::SnapshotHead head, Share share, double creditBytes, double now,
            transport::ConnectionId connection, Subscription& subscription);

  // While the machine is short of time: nothing is sent at the best quality, and what is not close by at the coarsest.
  void SetCoarser(bool isCoarser) { m_isCoarser = isCoarser; }

  [[nodiscard]] const SendCounts& Counts() const { return m_counts; }

 private:
  // Each body's turn by its priority: index and priority in one number, which orders faster than a look into two lists.
  using Turn = std::uint64_t;

  void RaisePriorities(std::span<const ShownBody> bodies, Share share, Subscription& subscription);
  [[nodiscard]] std::size_t TakeNext(std::size_t taken);
  [[nodiscard]] std::size_t FindQuality(const ShownBody& body, const Subscription& subscription) const;
  void SendBody(const ShownBody& shown, const EncodedBody& body, Subscription& subscription,
                Subscription::Interest& interest);
  void SendPacket(Subscription& subscription);

  transport::Transport& m_transport;
  float m_viewDistance;
  bool m_isCoarser = false;
  protocol::PacketBuilder m_packet;
  // Of the client who is being sent to:
  protocol::SnapshotHead m_head;
  transport::ConnectionId m_connection = 0;
  double m_now = 0;
  std::uint32_t m_ownBody = 0;
  protocol::Vector3 m_viewpoint;
  std::vector<Turn> m_turns;  // by falling priority up to m_sorted
  std::size_t m_sorted = 0;
  SendCounts m_counts;
};

}  // namespace wobble::server
