#include "server/snapshots/snapshot_sender.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace wobble::server {
namespace {

// What a packet costs beside its payload: IPv4 20, UDP 8, ENet's header with time and checksum 8, its command 8.
constexpr double kPacketOverheadBytes = 44;

// Distance at which a body's priority grows half as fast as close by, metres, and the share that even the farthest
// keep.
constexpr float kHalfDistance = 8;
constexpr float kFarShare = 0.25F;  // the farthest is sent every fifth time that a near one is
// What moves at the first, m/s, comes twice as often as what hardly does; faster than that, no more often.
constexpr float kDoubleSpeed = 4;

// Metres from which on a body is sent at the next quality, and the one after: a ball of 1 m, seen at an angle of 60° on
// a thousand pixels, is 50 pixels high at the first, 20 at the second, and an error of 1 % a fraction of one.
constexpr float kCoarseDistances[] = {16, 40};
// While the machine is short of time, metres from which on a body is sent at the coarsest quality: it is encoded for
// those near it, at the second best, and for all others, instead of at all three.
constexpr float kCoarserDistance = 8;

// Snapshots in a row that leave bodies out until the quality falls, and that leave none out until it rises. A quality
// costs about 1.8 times the bytes of the next.
constexpr int kCrowdedPatience = 3;
constexpr int kEasyPatience = 30;
constexpr double kFinerCost = 1.9;

float FindGain(protocol::Vector3 from, const ShownBody& to) {
  const protocol::Vector3 way = to.centre - from;
  const float near = kFarShare + 1.0F / (1.0F + protocol::Dot(way, way) / (kHalfDistance * kHalfDistance));
  return near * (1.0F + std::min(to.speed / kDoubleSpeed, 1.0F));
}

// As many turns as are put in order first: more than a small share of the wire takes. Then twice as many each time.
constexpr std::size_t kFirstTurns = 16;

void AdaptCoarseness(bool leftOut, bool isEasy, Subscription& subscription) {
  subscription.crowdedSnapshots = leftOut ? subscription.crowdedSnapshots + 1 : 0;
  subscription.easySnapshots = isEasy ? subscription.easySnapshots + 1 : 0;
  if (subscription.crowdedSnapshots >= kCrowdedPatience && subscription.coarseness + 1 < kQualities) {
    ++subscription.coarseness;
    subscription.crowdedSnapshots = 0;
  }
  if (subscription.easySnapshots >= kEasyPatience && subscription.coarseness > 0) {
    --subscription.coarseness;
    subscription.easySnapshots = 0;
  }
}

}  // namespace

double SendCounts::BitsPerVertex() const {
  return vertices > 0 ? 8 * static_cast<double>(recordBytes) / static_cast<double>(vertices) : 0;
}

double SendCounts::ErrorPercentRms() const {
  return vertices > 0 ? 100 * std::sqrt(errorSquares / static_cast<double>(vertices)) : 0;
}

void SnapshotSender::RaisePriorities(std::span<const ShownBody> bodies, Share share, Subscription& subscription) {
  const ShownBody* own = FindBody(bodies, m_ownBody);
  m_viewpoint = own != nullptr ? own->centre : protocol::Vector3{};
  std::vector<Subscription::Interest>& interests = subscription.interests;
  FollowBodies(bodies, interests);
  m_turns.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const ShownBody& body = bodies[i];
    if (!share.Has(body.body)) continue;
    if (body.restTick != 0 && Subscription::IsSettled(interests[i], body.restTick, m_now)) continue;
    if (protocol::Length(body.centre - m_viewpoint) > m_viewDistance) {
      ++m_counts.bodiesOutOfView;
      continue;
    }
    float& priority = interests[i].priority;
    priority += FindGain(m_viewpoint, body);
    // Floats that are not negative are in order as integers too; of equal ones the first comes first.
    const Turn rank = &body == own ? Turn{0xFFFFFFFF} : Turn{std::bit_cast<std::uint32_t>(priority)};
    m_turns.push_back(rank << 32 | ~static_cast<std::uint32_t>(i));
  }
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

std::size_t SnapshotSender::FindQuality(const ShownBody& body, const Subscription& subscription) const {
  std::size_t quality = std::max<std::size_t>(subscription.coarseness, m_isCoarser ? 1 : 0);
  if (body.body == m_ownBody) return quality;
  const float distance = protocol::Length(body.centre - m_viewpoint);
  if (m_isCoarser && distance > kCoarserDistance) return kQualities - 1;
  for (const float limit : kCoarseDistances) quality += distance > limit ? 1 : 0;
  return std::min(quality, kQualities - 1);
}

void SnapshotSender::SendPacket(Subscription& subscription) {
  const std::uint64_t lost = subscription.sent.Lost();
  m_head.sequence = subscription.sent.RecordSent(m_now);
  m_counts.packetsLost += subscription.sent.Lost() - lost;
  const std::span<const std::uint8_t> packet = m_packet.Finish(m_head);
  if (m_transport.Send(m_connection, transport::Channel::kSnapshot, packet) == transport::SendResult::kQueued) {
    ++m_counts.packets;
    m_counts.bytes += packet.size();
  }
  subscription.credit -= static_cast<double>(protocol::kSnapshotHeadBytes) + kPacketOverheadBytes;
  m_packet.Clear();
}

void SnapshotSender::SendBody(const ShownBody& shown, const EncodedBody& body, Subscription& subscription,
                              Subscription::Interest& interest) {
  std::uint32_t first = 0;
  for (const std::span<const std::uint8_t> record : body.records) {
    if (!m_packet.Add(record)) {
      SendPacket(subscription);
      [[maybe_unused]] const bool fits = m_packet.Add(record);  // a record is always smaller than a packet
    }
    if (first == 0) first = subscription.sent.Newest() + 1;
    subscription.credit -= static_cast<double>(record.size());
    m_counts.recordBytes += record.size();
  }
  m_counts.vertices += body.vertices;
  m_counts.errorSquares += body.errorSquares;
  m_counts.errors.Record(body.error);
  interest.priority = 0;
  if (shown.restTick == 0) return;
  // The packet that is being filled is the next one. What has no record will have none while it lies there.
  const std::uint32_t last = subscription.sent.Newest() + 1;
  if (first == 0) {
    interest.restKnown = shown.restTick;
  } else {
    subscription.NoteRestSent(interest, shown.restTick, first, last, m_now);
  }
}

void SnapshotSender::Send(std::span<const ShownBody> bodies, const ReadBody& readBody, std::uint32_t ownBody,
                          protocol::SnapshotHead head, Share share, double creditBytes, double now,
                          transport::ConnectionId connection, Subscription& subscription) {
  m_head = head;
  m_connection = connection;
  m_now = now;
  m_ownBody = ownBody;
  RaisePriorities(bodies, share, subscription);
  // One snapshot's credit may be saved up for a busier one, no more: a quiet minute buys no burst.
  subscription.credit = std::min(subscription.credit + creditBytes, 2 * creditBytes);
  const double creditBefore = subscription.credit;
  std::size_t taken = 0;
  for (; taken < m_turns.size() && subscription.credit > 0; ++taken) {
    const std::size_t index = TakeNext(taken);
    const std::size_t quality = FindQuality(bodies[index], subscription);
    m_counts.bodiesCoarsened += quality > 0 ? 1 : 0;
    SendBody(bodies[index], readBody(index, quality), subscription, subscription.interests[index]);
  }
  const std::size_t leftOut = m_turns.size() - taken;
  m_counts.bodiesLeftOut += leftOut;
  // A world of which there is nothing to tell is told as well: the head alone keeps clock, time ratio and
  // acknowledgements going. A client that has overdrawn waits in silence instead: heads alone could eat a small share
  // up and leave nothing for bodies.
  const bool isNothingNew = m_turns.empty() && share.group == 0 && subscription.credit > 0;
  if (!m_packet.Empty() || isNothingNew) SendPacket(subscription);
  const bool isEasy = leftOut == 0 && kFinerCost * (creditBefore - subscription.credit) < creditBytes;
  AdaptCoarseness(leftOut > 0, isEasy, subscription);
}

}  // namespace wobble::server
