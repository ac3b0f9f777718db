// Ranks the bodies of one snapshot, takes them by falling rank while there is credit, and packs their records. The last
// record may overdraw the credit; the debt is paid by the next snapshots, so the budget holds over time.
#include "server/snapshots/snapshot_budget.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "server/snapshots/body_priority.h"

namespace wobble::server {
namespace {

// Bytes of a packet beside its payload: IPv4 20, UDP 8, ENet's header with time and checksum 8, its command 8.
constexpr double kPacketOverheadBytes = 44;

// Ranks that are sorted first: more than a small budget takes. Then as many again as have been sorted.
constexpr std::size_t kFirstRanks = 16;

// The own body ranks above all others. Priorities are less: floats that are not negative leave the first bit free.
constexpr std::uint32_t kOwnRank = 0xFFFFFFFF;

}  // namespace

double SendCounts::BitsPerVertex() const {
  return vertices > 0 ? 8 * static_cast<double>(recordBytes) / static_cast<double>(vertices) : 0;
}

double SendCounts::ErrorPercentRms() const {
  return vertices > 0 ? 100 * std::sqrt(errorSquares / static_cast<double>(vertices)) : 0;
}

void SnapshotBudget::Begin(std::span<const ShownBody> bodies, const SnapshotTask& task, Subscription& subscription) {
  m_task = task;
  m_counts.budgetBytes += task.creditBytes;
  RankBodies(bodies, subscription);
  // The credit of one snapshot may be saved for a busier one, and no more: a quiet minute buys no burst.
  subscription.credit = std::min(subscription.credit + task.creditBytes, 2 * task.creditBytes);
  const double nearBytes = kNearShare * task.creditBytes;
  subscription.nearCredit = std::min(subscription.nearCredit + nearBytes, 2 * nearBytes);
  subscription.turn.credit += task.creditBytes;
}

void SnapshotBudget::RankBodies(std::span<const ShownBody> bodies, Subscription& subscription) {
  const ShownBody* own = FindBody(bodies, m_task.ownBody);
  m_viewpoint = own != nullptr ? own->centre : protocol::Vector3{};
  const float nearRadius = FindNearRadius(bodies, m_viewpoint, m_distances);
  std::vector<Subscription::Interest>& interests = subscription.interests;
  FollowBodies(bodies, interests);
  m_ranks.clear();
  m_near = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const ShownBody& body = bodies[i];
    if (!m_task.subset.Has(body.body)) continue;
    if (m_task.download->Find(body.blueprint) == Download::Stage::kUnsent) continue;
    if (body.restTick != 0 && Subscription::IsSettled(interests[i], body.restTick, m_task.now)) continue;
    const float distance = protocol::Length(body.centre - m_viewpoint);
    if (distance > m_viewDistance) {
      ++m_counts.bodiesOutOfView;
      continue;
    }
    float& priority = interests[i].priority;
    priority += FindGain(FindApparentDistance(distance, body.size), body.speed);
    // The bits of floats that are not negative sort like the floats. Of equal priorities the lower index goes first.
    const Rank high = &body == own ? kOwnRank : std::bit_cast<std::uint32_t>(priority);
    m_ranks.push_back(high << 32 | ~static_cast<std::uint32_t>(i));
    if (distance <= nearRadius) std::swap(m_ranks[m_near++], m_ranks.back());
  }
  std::sort(m_ranks.begin(), m_ranks.begin() + static_cast<std::ptrdiff_t>(m_near), std::greater<>());
  m_sorted = m_near;
  m_taken = 0;
}

std::optional<SnapshotBudget::Pick> SnapshotBudget::PickNext(std::span<const ShownBody> bodies,
                                                             Subscription& subscription) {
  // Bodies fall unevenly into the snapshots of a turn: near ones may overdraw one snapshot by what the next one gets.
  const bool isNear = m_taken < m_near && subscription.nearCredit > 0 && subscription.credit > -m_task.creditBytes;
  if (!isNear && m_taken < m_near) {
    subscription.turn.nearLeft += m_near - m_taken;
    m_sorted = m_near = m_taken;  // they wait with the others
  }
  if (m_taken == m_ranks.size() || (!isNear && subscription.credit <= 0)) return std::nullopt;
  const std::size_t index = TakeHighest();
  const std::size_t quality = FindQuality(bodies[index], isNear, subscription);
  m_counts.bodiesCoarsened += quality > 0 ? 1 : 0;
  return Pick{.index = index, .quality = quality, .isNear = isNear};
}

// The index of the body that ranks highest among those not taken yet, near ones before all others. A budget takes a few
// of many bodies, so no more than these are sorted.
std::size_t SnapshotBudget::TakeHighest() {
  if (m_taken == m_sorted) {
    const std::size_t more = std::min(std::max(kFirstRanks, m_sorted), m_ranks.size() - m_sorted);
    const auto begin = m_ranks.begin() + static_cast<std::ptrdiff_t>(m_sorted);
    std::partial_sort(begin, begin + static_cast<std::ptrdiff_t>(more), m_ranks.end(), std::greater<>());
    m_sorted += more;
  }
  return ~static_cast<std::uint32_t>(m_ranks[m_taken++]);
}

std::size_t SnapshotBudget::FindQuality(const ShownBody& body, bool isNear, const Subscription& subscription) const {
  const float distance = body.body == m_task.ownBody ? 0 : protocol::Length(body.centre - m_viewpoint);
  const std::size_t quality = subscription.coarseness.FindQuality(isNear, FindApparentDistance(distance, body.size));
  return m_isCoarser ? FindCoarserQuality(quality, distance) : quality;
}

void SnapshotBudget::AddBody(const Pick& pick, const ShownBody& shown, const EncodedBody& body,
                             Subscription& subscription) {
  Subscription::Interest& interest = subscription.interests[pick.index];
  std::uint32_t first = 0;
  double size = 0;
  for (const std::span<const std::uint8_t> record : body.records) {
    if (!m_packet.Add(record)) {
      SendPacket(subscription);
      [[maybe_unused]] const bool fits = m_packet.Add(record);  // a record is always smaller than a packet
    }
    if (first == 0) first = subscription.sent.Newest() + 1;
    size += static_cast<double>(record.size());
  }
  subscription.credit -= size;
  if (pick.isNear) subscription.nearCredit -= size;
  (pick.isNear ? subscription.turn.near : subscription.turn.far) += size;
  m_counts.recordBytes += static_cast<std::uint64_t>(size);
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

void SnapshotBudget::SendPacket(Subscription& subscription) {
  m_task.head.sequence = subscription.sent.RecordSent(m_task.now);
  m_counts.packetsLost += subscription.sent.Lost() - subscription.lossesCounted;
  subscription.lossesCounted = subscription.sent.Lost();
  const std::span<const std::uint8_t> packet = m_packet.Finish(m_task.head);
  subscription.room.NoteSent(static_cast<double>(packet.size()) + kPacketOverheadBytes);
  if (m_transport.Send(m_task.connection, transport::Channel::kSnapshot, packet) == transport::SendResult::kQueued) {
    ++m_counts.packets;
    m_counts.bytes += packet.size();
  }
  constexpr double kHeads = static_cast<double>(protocol::kSnapshotHeadBytes) + kPacketOverheadBytes;
  subscription.credit -= kHeads;
  subscription.turn.far += kHeads;
  m_packet.Clear();
}

void SnapshotBudget::Finish(Subscription& subscription) {
  const std::size_t leftOut = m_ranks.size() - m_taken;
  m_counts.bodiesLeftOut += leftOut;
  // When there is no body to send, the head goes alone: it keeps clock, time ratio and acknowledgements going. A client
  // that has overdrawn its credit waits in silence instead: heads could use up a small budget and leave no bodies.
  const bool isHeadAlone = m_ranks.empty() && m_task.subset.remainder == 0 && subscription.credit > 0;
  if (!m_packet.Empty() || isHeadAlone) SendPacket(subscription);
  subscription.turn.due += m_ranks.size();
  subscription.turn.leftOut += leftOut;
  if (m_task.subset.remainder + 1 < m_task.subset.divisor) return;
  subscription.coarseness.Adapt(subscription.turn);
  subscription.isShort = subscription.turn.leftOut > 0 || subscription.coarseness.IsCoarse();
  subscription.turn = {};
}

}  // namespace wobble::server
