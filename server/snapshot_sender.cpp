#include "server/snapshot_sender.h"

#include <algorithm>
#include <limits>

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

// Null when there is none.
const EncodedBody* FindEncoded(std::span<const EncodedBody> bodies, std::uint32_t body) {
  const auto found = std::lower_bound(bodies.begin(), bodies.end(), body,
                                      [](const EncodedBody& other, std::uint32_t id) { return other.body < id; });
  return found != bodies.end() && found->body == body ? &*found : nullptr;
}

}  // namespace

void SnapshotSender::RaisePriorities(std::span<const EncodedBody> bodies, std::uint32_t ownBody,
                                     Subscription& subscription) const {
  const EncodedBody* own = FindEncoded(bodies, ownBody);
  const protocol::Vector3 viewpoint = own != nullptr ? own->centre : protocol::Vector3{};
  std::vector<Subscription::Interest>& interests = subscription.interests;
  std::erase_if(interests,
                [&](const Subscription::Interest& interest) { return FindEncoded(bodies, interest.body) == nullptr; });
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i == interests.size()) interests.push_back({bodies[i].body});
    float& priority = interests[i].priority;
    priority = bodies[i].body == ownBody ? std::numeric_limits<float>::max()
                                         : priority + FindGain(viewpoint, bodies[i].centre);
  }
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

void SnapshotSender::Send(std::span<const EncodedBody> bodies, std::uint32_t ownBody, protocol::SnapshotHead head,
                          double creditBytes, double now, transport::ConnectionId connection,
                          Subscription& subscription) {
  RaisePriorities(bodies, ownBody, subscription);
  m_order.resize(bodies.size());
  for (std::size_t i = 0; i < m_order.size(); ++i) m_order[i] = i;
  std::sort(m_order.begin(), m_order.end(), [&](std::size_t a, std::size_t b) {
    const float pa = subscription.interests[a].priority;
    const float pb = subscription.interests[b].priority;
    return pa != pb ? pa > pb : a < b;
  });

  // One snapshot's credit may be saved up for a busier one, no more: a quiet minute buys no burst.
  subscription.credit = std::min(subscription.credit + creditBytes, 2 * creditBytes);
  std::size_t next = 0;
  for (; next < m_order.size() && subscription.credit > 0; ++next) {
    const std::size_t index = m_order[next];
    for (const std::span<const std::uint8_t> record : bodies[index].records) {
      if (!m_packet.Add(record)) {
        SendPacket(head, now, connection, subscription);
        [[maybe_unused]] const bool fits = m_packet.Add(record);  // a record is always smaller than a packet
      }
      subscription.credit -= static_cast<double>(record.size());
    }
    subscription.interests[index].priority = 0;
  }
  m_counts.bodiesLeftOut += m_order.size() - next;
  // An empty world is told as well: the head alone keeps clock, time ratio and acknowledgements going. A client that
  // has overdrawn waits in silence instead: heads alone could eat a small share up and leave nothing for bodies.
  const bool isEmptyWorld = bodies.empty() && subscription.credit > 0;
  if (!m_packet.Empty() || isEmptyWorld) SendPacket(head, now, connection, subscription);
}

}  // namespace wobble::server
