// Ranks the bodies of one snapshot, takes them by falling rank while there is credit, and packs their records. The last
// record may overdraw the credit; the debt is paid by the next snapshots, so the budget holds over time.
#include "server/snapshots/snapshot_sender.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace wobble::server {
namespace {

// Bytes of a packet beside its payload: IPv4 20, UDP 8, ENet's header with time and checksum 8, its command 8.
constexpr double kPacketOverheadBytes = 44;

// A body's priority grows by kFarShare + 1 / (1 + (d / kHalfDistance)²) a snapshot, d metres away, so that the farthest
// is sent every fifth time that a near one is.
constexpr float kHalfDistance = 8;
constexpr float kFarShare = 0.25F;
// A body this fast, m/s, is sent twice as often as one that hardly moves; a faster one no more often.
constexpr float kDoubleSpeed = 4;

// Distances, m, from which on a body is sent one quality coarser, and two. A ball of 1 m, seen at an angle of 60° on a
// thousand pixels, is 50 pixels high at the first distance and 20 at the second, and an error of 1 % a fraction of one.
constexpr float kCoarseDistances[] = {16, 40};
// While the machine is short of time: the distance, m, from which on a body is sent at the coarsest quality. A body is
// then encoded at two qualities, the second best for clients near it and the coarsest for all others, instead of three.
constexpr float kCoarserDistance = 8;

// Snapshots in a row that leave bodies out before the quality falls, and that leave none out before it rises. A quality
// costs about 1.8 times the bytes of the next coarser one; kFinerCost leaves a margin.
constexpr int kCrowdedPatience = 3;
constexpr int kEasyPatience = 30;
constexpr double kFinerCost = 1.9;

// Ranks that are sorted first: more than a small budget takes. Then as many again as have been sorted.
constexpr std::size_t kFirstRanks = 16;

// The growth of a body's priority in one snapshot.
float FindGain(protocol::Vector3 from, const ShownBody& to) {
  const protocol::Vector3 way = to.centre - from;
  const float near = kFarShare + 1.0F / (1.0F + protocol::Dot(way, way) / (kHalfDistance * kHalfDistance));
  return near * (1.0F + std::min(to.speed / kDoubleSpeed, 1.0F));
}

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

void SnapshotSender::Begin(std::span<const ShownBody> bodies, const SnapshotTask& task, Subscription& subscription) {
  m_task = task;
  RankBodies(bodies, subscription);
  // The credit of one snapshot may be saved for a busier one, and no more: a quiet minute buys no burst.
  subscription.credit = std::min(subscription.credit + task.creditBytes, 2 * task.creditBytes);
  m_creditBefore = subscription.credit;
}

void SnapshotSender::RankBodies(std::span<const ShownBody> bodies, Subscription& subscription) {
  const ShownBody* own = FindBody(bodies, m_task.ownBody);
  m_viewpoint = own != nullptr ? own->centre : protocol::Vector3{};
  std::vector<Subscription::Interest>& interests = subscription.interests;
  FollowBodies(bodies, interests);
  m_ranks.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const ShownBody& body = bodies[i];
    if (!m_task.subset.Has(body.body)) continue;
    if (m_task.download->Find(body.blueprint) == Download::Stage::kUnsent) continue;
    if (body.restTick != 0 && Subscription::IsSettled(interests[i], body.restTick, m_task.now)) continue;
    if (protocol::Length(body.centre - m_viewpoint) > m_viewDistance) {
      ++m_counts.bodiesOutOfView;
      continue;
    }
    float& priority = interests[i].priority;
    priority += FindGain(m_viewpoint, body);
    // The bits of floats that are not negative sort like the floats. Of equal priorities the lower index goes first.
    const Rank high = &body == own ? Rank{0xFFFFFFFF} : Rank{std::bit_cast<std::uint32_t>(priority)};
    m_ranks.push_back(high << 32 | ~static_cast<std::uint32_t>(i));
  }
  m_sorted = 0;
  m_taken = 0;
}

std::optional<SnapshotSender::Pick> SnapshotSender::PickNext(std::span<const ShownBody> bodies,
                                                             const Subscription& subscription) {
  if (m_taken == m_ranks.size() || subscription.credit <= 0) return std::nullopt;
  const std::size_t index = TakeHighest();
  const std::size_t quality = FindQuality(bodies[index], subscription);
  m_counts.bodiesCoarsened += quality > 0 ? 1 : 0;
  return Pick{.index = index, .quality = quality};
}

// The index of the body that ranks highest among those not taken yet. A budget takes a few of many bodies, so no more
// than these are sorted.
std::size_t SnapshotSender::TakeHighest() {
  if (m_taken == m_sorted) {
    const std::size_t more = std::min(std::max(kFirstRanks, m_sorted), m_ranks.size() - m_sorted);
    const auto begin = m_ranks.begin() + static_cast<std::ptrdiff_t>(m_sorted);
    std::partial_sort(begin, begin + static_cast<std::ptrdiff_t>(more), m_ranks.end(), std::greater<>());
    m_sorted += more;
  }
  return ~static_cast<std::uint32_t>(m_ranks[m_taken++]);
}

std::size_t SnapshotSender::FindQuality(const ShownBody& body, const Subscription& subscription) const {
  std::size_t quality = std::max<std::size_t>(subscription.coarseness, m_isCoarser ? 1 : 0);
  if (body.body == m_task.ownBody) return quality;
  const float distance = protocol::Length(body.centre - m_viewpoint);
  if (m_isCoarser && distance > kCoarserDistance) return kQualities - 1;
  for (const float limit : kCoarseDistances) quality += distance > limit ? 1 : 0;
  return std::min(quality, kQualities - 1);
}

void SnapshotSender::AddBody(const ShownBody& shown, const EncodedBody& body, Subscription& subscription,
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
  // A record that overtakes its blueprint is lost to the client, though its packet arrives.
  if (shown.restTick == 0 || m_task.download->Find(shown.blueprint) != Download::Stage::kArrived) return;
  // The packet that is being filled gets the next sequence number. A body without a record has nothing to send until it
  // wakes.
  const std::uint32_t last = subscription.sent.Newest() + 1;
  if (first == 0) {
    interest.restKnown = shown.restTick;
  } else {
    subscription.NoteRestSent(interest, shown.restTick, first, last, m_task.now);
  }
}

void SnapshotSender::SendPacket(Subscription& subscription) {
  const std::uint64_t lost = subscription.sent.Lost();
  m_task.head.sequence = subscription.sent.RecordSent(m_task.now);
  m_counts.packetsLost += subscription.sent.Lost() - lost;
  const std::span<const std::uint8_t> packet = m_packet.Finish(m_task.head);
  if (m_transport.Send(m_task.connection, transport::Channel::kSnapshot, packet) == transport::SendResult::kQueued) {
    ++m_counts.packets;
    m_counts.bytes += packet.size();
  }
  subscription.credit -= static_cast<double>(protocol::kSnapshotHeadBytes) + kPacketOverheadBytes;
  m_packet.Clear();
}

void SnapshotSender::Finish(Subscription& subscription) {
  const std::size_t leftOut = m_ranks.size() - m_taken;
  m_counts.bodiesLeftOut += leftOut;
  // When there is no body to send, the head goes alone: it keeps clock, time ratio and acknowledgements going. A client
  // that has overdrawn its credit waits in silence instead: heads could use up a small budget and leave no bodies.
  const bool isHeadAlone = m_ranks.empty() && m_task.subset.remainder == 0 && subscription.credit > 0;
  if (!m_packet.Empty() || isHeadAlone) SendPacket(subscription);
  const bool isEasy = leftOut == 0 && kFinerCost * (m_creditBefore - subscription.credit) < m_task.creditBytes;
  AdaptCoarseness(leftOut > 0, isEasy, subscription);
}

}  // namespace wobble::server
