// Chooses which bodies a client gets in a snapshot, and how exactly, and spends the client's byte budget on them.
//
// The player's own body goes first, then the nearest bodies (body_priority.h). The priority of the others grows with
// every snapshot, faster when the body looks large or is fast, until it is sent: they take turns, and none starves
// (Fiedler, "State Synchronization"). A body at rest is sent until the client has it; a body out of view is not sent,
// nor one whose blueprint has not been sent.
//
// When the budget leaves bodies out, all bodies are coarsened before they are sent less often. That includes the own
// body: otherwise each player's body would be encoded twice, once for the player and once for everybody else, and an
// error of 1 % of a ball of 1 m is less than a pixel from where its player looks on.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/snapshot.h"
#include "protocol/transport/transport.h"
#include "server/snapshots/download.h"
#include "server/snapshots/snapshot_store.h"
#include "server/snapshots/subscription.h"
#include "server/timing/bins.h"

namespace wobble::server {

// Bounds of the histogram of record errors, as shares of the body's size.
inline constexpr std::array<double, 9> kErrorBounds{0.0005, 0.001, 0.0015, 0.002, 0.0025, 0.005, 0.01, 0.02, 0.05};

// Totals since the start, over all clients.
struct SendCounts {
  std::uint64_t packets = 0;
  std::uint64_t packetsLost = 0;      // never acknowledged, as far as acknowledgements tell
  std::uint64_t bytes = 0;            // payload of the packets
  double budgetBytes = 0;             // that links had room for and --client-kbit allowed, all headers counted
  std::uint64_t bodiesLeftOut = 0;    // bodies that did not fit a snapshot's budget and wait for a later one
  std::uint64_t bodiesCoarsened = 0;  // bodies sent at less than the best quality
  std::uint64_t bodiesOutOfView = 0;  // bodies beyond the view distance
  // Over all records sent:
  std::uint64_t vertices = 0;
  std::uint64_t recordBytes = 0;
  double errorSquares = 0;    // as EncodedBody::errorSquares
  Bins<kErrorBounds> errors;  // one per body, as EncodedBody::error

  [[nodiscard]] double BitsPerVertex() const;    // 0 when nothing was sent
  [[nodiscard]] double ErrorPercentRms() const;  // in % of the body's size; 0 when nothing was sent
};

// One snapshot to one client.
struct SnapshotTask {
  transport::ConnectionId connection = 0;
  std::uint32_t ownBody = 0;           // 0: a spectator, who looks from the origin
  protocol::SnapshotHead head;         // the sequence number is filled in when it is sent
  BodySubset subset;                   // the bodies that are due
  double creditBytes = 0;              // by which the client's budget has grown since its last snapshot; above 0
  double now = 0;                      // s
  const Download* download = nullptr;  // the client's
};

class SnapshotBudget {
 public:
  // transport: outlives this. viewDistance: m; bodies farther from the client's viewpoint are not sent.
  SnapshotBudget(transport::Transport& transport, double viewDistance)
      : m_transport(transport), m_viewDistance(static_cast<float>(viewDistance)) {}

  // Sends one client its snapshot, as much as its budget holds: asks the store for the records of the bodies that it
  // takes and of no others. Store: SnapshotStore, or a stand-in of a test with the same Bodies() and Read(index,
  // quality).
  template <class Store>
  void Spend(Store& store, const SnapshotTask& task, Subscription& subscription) {
    Begin(store.Bodies(), task, subscription);
    while (const auto pick = PickNext(store.Bodies(), subscription)) {
      const EncodedBody& body = store.Read(pick->index, pick->quality);
      AddBody(*pick, store.Bodies()[pick->index], body, subscription);
    }
    Finish(subscription);
  }

  // While the machine is short of time: no body is sent at the best quality, and those that are not close by at the
  // coarsest.
  void SetCoarser(bool isCoarser) { m_isCoarser = isCoarser; }

  [[nodiscard]] const SendCounts& Counts() const { return m_counts; }

 private:
  // A body's priority in the high half, its complemented index in the low half: one number sorts faster than a
  // comparison that looks into two lists.
  using Rank = std::uint64_t;
  struct Pick {
    std::size_t index = 0;
    std::size_t quality = 0;
    bool isNear = false;
  };

  void Begin(std::span<const ShownBody> bodies, const SnapshotTask& task, Subscription& subscription);
  [[nodiscard]] std::optional<Pick> PickNext(std::span<const ShownBody> bodies, Subscription& subscription);
  void AddBody(const Pick& pick, const ShownBody& shown, const EncodedBody& body, Subscription& subscription);
  void Finish(Subscription& subscription);

  void RankBodies(std::span<const ShownBody> bodies, Subscription& subscription);
  [[nodiscard]] std::size_t TakeHighest();
  [[nodiscard]] std::size_t FindQuality(const ShownBody& body, bool isNear, const Subscription& subscription) const;
  void SendPacket(Subscription& subscription);

  transport::Transport& m_transport;
  float m_viewDistance;
  bool m_isCoarser = false;
  SendCounts m_counts;
  // State of the snapshot that is being sent:
  SnapshotTask m_task;
  protocol::PacketBuilder m_packet;
  protocol::Vector3 m_viewpoint;
  std::vector<Rank> m_ranks;  // of the bodies that may be sent: near ones, then others; sorted up to m_sorted
  std::size_t m_near = 0;     // near ones; those that the budget does not hold stop being so
  std::size_t m_sorted = 0;
  std::size_t m_taken = 0;         // ranks that have been taken
  std::vector<float> m_distances;  // scratch of FindNearRadius
};

}  // namespace wobble::server
