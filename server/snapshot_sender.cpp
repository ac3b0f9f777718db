#include "server/snapshot_sender.h"

#include <algorithm>
#include <bit>
#include <functional>

namespace wobble::server {
namespace {

// What a packet costs beside its payload: IPv4 20, UDP 8, ENet's header with time and checksum 8, its command 8.
constexpr double kPacketOverheadBytes = 44;

// Distance at which a body's priority grows half as fast as close by, metres, and the share that even the farthest
// keep.
constexpr float kHalfDistance = 8;
constexpr float kFarShare = 0.25F;  // the farthest is sent every fifth time that a near one is

float FindGain(protocol::Vector3 from, protocol::Vector3 to) {
  const protocol::Vector3 way = to - from;
  return kFarShare + 1.0F / (1.0F + protocol::Dot(way, way) / (kHalfDistance * kHalfDistance));
}

// As many turns as are put in order first: more than a small share of the wire takes. Then twice as many each time.
constexpr std::size_t kFirstTurns = 16;

// Null when there is none.
const ShownBody* FindShown(std::span<const ShownBody> bodies, std::uint32_t body) {
  const auto found = std::lower_bound(bodies.begin(), bodies.end(), body,
                                      [](const ShownBody& other, std::uint32_t id) { return other.body < id; });
  return found != bodies.end() && found->body == body ? &*found : nullptr;
}

}  // namespace

void SnapshotSender::RaisePriorities(std::span<const ShownBody> bodies, std::uint32_t ownBody,
                                     Subscription& subscription) {
  const ShownBody* own = FindShown(bodies, ownBody);
  const protocol::Vector3 viewpoint = own != nullptr ? own->centre : protocol::Vector3{};
  std::vector<Subscription::Interest>& interests = subscription.interests;
  FollowBodies(bodies, interests);
  m_turns.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    float& priority = interests[i].priority;
    priority += FindGain(viewpoint, bodies[i].centre);
    // Floats that are not negative are in order as integers too; of equal ones the first comes first.
    m_turns[i] = Turn{std::bit_cast<std::uint32_t>(priority)} << 32 | ~static_cast<std::uint32_t>(i);
  }
  if (own != nullptr) m_turns[static_cast<std::size_t>(own - bodies.data())] |= Turn{0xFFFFFFFF} << 32;
  m_sorted = 0;
}

// The index of the body whose turn it is after so many. A client's share is a few of many bodies: only as many as that
// are put in order.
std::size_t SnapshotSender::TakeNext(std::size_t taken) {
  if (taken == m_sorted) {
    const std::size_t more = std::min(std::max(kFirstTurns, m_sorted), m_turns.size() - m_sorted);
    const auto begin = m_turns.begin() + static_cast<std::ptrdiff_t>(m_sorted);
    std::partial_sort(begin, begin + static_cast<std::ptrdiff_t>(more), m_turns.end(), std::greater<>());
    m_sorted += more;
  }
  return ~static_cast<std::uint32_t>(m_turns[taken]);
}

void SnapshotSender::SendPacket(protocol::SnapshotHead head, double now, transport::ConnectionId connection,
                                Subscription& subscription) {
  head.sequence = subscription.sent.RecordSent(now);
  const std::span<const std::uint8_t> packet = m_packet.Finish(head);
  if (m_transport.Send(connection, transport::Channel::kSnapshot, packet) == transport::SendResult::kQueued) {
    ++m_counts.packets;
    m_counts.bytes += packet.size();
  }
  subscription.credit -= static_cast<double>(protocol::kSnapshotHeadBytes) + kPacketOverheadBytes;
  m_packet.Clear();
}

void SnapshotSender::Send(std::span<const ShownBody> bodies, const ReadRecords& readRecords, std::uint32_t ownBody,
                          protocol::SnapshotHead head, double creditBytes, double now,
                          transport::ConnectionId connection, Subscription& subscription) {
  RaisePriorities(bodies, ownBody, subscription);
  // One snapshot's credit may be saved up for a busier one, no more: a quiet minute buys no burst.
  subscription.credit = std::min(subscription.credit + creditBytes, 2 * creditBytes);
  std::size_t taken = 0;
  for (; taken < bodies.size() && subscription.credit > 0; ++taken) {
    const std::size_t index = TakeNext(taken);
    for (const std::span<const std::uint8_t> record : readRecords(index)) {
      if (!m_packet.Add(record)) {
        SendPacket(head, now, connection, subscription);
        [[maybe_unused]] const bool fits = m_packet.Add(record);  // a record is always smaller than a packet
      }
      subscription.credit -= static_cast<double>(record.size());
    }
    subscription.interests[index].priority = 0;
  }
  m_counts.bodiesLeftOut += bodies.size() - taken;
  // An empty world is told as well: the head alone keeps clock, time ratio and acknowledgements going. A client that
  // has overdrawn waits in silence instead: heads alone could eat a small share up and leave nothing for bodies.
  const bool isEmptyWorld = bodies.empty() && subscription.credit > 0;
  if (!m_packet.Empty() || isEmptyWorld) SendPacket(head, now, connection, subscription);
}

}  // namespace wobble::server
