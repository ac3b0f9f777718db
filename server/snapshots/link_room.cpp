#include "server/snapshots/link_room.h"

#include <algorithm>
#include <utility>

namespace wobble::server {
namespace {

constexpr double kInterval = 0.25;  // between decisions, s
constexpr double kSampled = 0.1;    // before a decision, in which it looks at round trips, s
// The queue, s, from which on a link is full, and below which it has room. A server's tick, a client's frame and the
// time between two snapshots spread the least round trip of an interval by less.
constexpr double kFullQueue = 0.04;
constexpr double kShortQueue = 0.02;
// The share of packets lost from which on it is full though nothing queues, and below which it has room. Radio links
// lose some per cent whatever they carry, and snapshots bear that.
constexpr double kFullLoss = 0.1;
constexpr double kLittleLoss = 0.05;
constexpr double kLossPackets = 128;  // over which the loss is smoothed: a short black-out stays below kFullLoss
// Growth of the rate in an interval, and what a full link leaves of the rate that it was given.
constexpr double kSeekingGrowth = 1.25;
constexpr double kFollowingGrowth = 1.05;
constexpr double kBackOff = 0.85;
constexpr double kLeastArrived = 0.5;  // of what was sent: a stall delays packets, and does not make the link narrow
// A rate of which less is used does not grow. Qualities get finer at a third to two fifths less than the budget
// (coarseness.cpp), so they do it first.
constexpr double kUsedShare = 0.5;
constexpr double kLeastAge = 30;  // of half of the memory for the least round trip, s

}  // namespace

double LinkRoom::Interval::FindUsed(double now) const { return 8 * sentBytes / std::max(now - begin, kInterval); }

double LinkRoom::Interval::FindArrived(double now) const {
  return sentPackets == 0 ? 0 : FindUsed(now) * arrivedPackets / sentPackets;
}

double LinkRoom::Rate(double ceiling) const { return std::min(m_rate, ceiling); }

void LinkRoom::NoteSent(double bytes) {
  m_interval.sentBytes += bytes;
  ++m_interval.sentPackets;
}

void LinkRoom::NoteAcknowledgement(const protocol::SentWindow::Report& report, double now) {
  m_interval.arrivedPackets += report.acknowledged;
  if (report.roundTrip < 0) return;
  if (now - m_leastSince > kLeastAge) {
    m_leastBefore = std::exchange(m_least, kUnknown);
    m_leastSince = now;
  }
  m_least = std::min(m_least, report.roundTrip);
  if (now > m_decision - kSampled) m_interval.roundTrip = std::min(m_interval.roundTrip, report.roundTrip);
}

void LinkRoom::Follow(protocol::SentWindow& sent, bool isShort, double ceiling, double now) {
  if (now < m_decision || m_interval.roundTrip == kUnknown) return;  // a black-out says nothing about the rate
  FollowLoss(sent.Judge());
  m_decision = now + kInterval;
  switch (ReadSign()) {
    case Sign::kFull:
      BackOff(now);
      m_decision += m_interval.roundTrip;  // what has been sent is still on its way, and tells nothing new
      break;
    case Sign::kRoom:
      if (isShort && m_interval.FindUsed(now) > kUsedShare * m_rate) Grow(ceiling);
      break;
    case Sign::kUnclear:
      break;
  }
  m_interval = {.begin = now};
}

void LinkRoom::FollowLoss(const protocol::SentWindow::Tally& tally) {
  const unsigned judged = tally.arrived + tally.lost;
  if (judged == 0) return;
  const double share = static_cast<double>(tally.lost) / judged;
  m_loss += (share - m_loss) * std::min(1.0, judged / kLossPackets);
}

LinkRoom::Sign LinkRoom::ReadSign() const {
  const double queue = m_interval.roundTrip - std::min(m_least, m_leastBefore);
  if (queue > kFullQueue || m_loss > kFullLoss) return Sign::kFull;
  return queue < kShortQueue && m_loss < kLittleLoss ? Sign::kRoom : Sign::kUnclear;
}

void LinkRoom::Grow(double ceiling) {
  m_rate = std::min(m_rate * (m_state == State::kSeeking ? kSeekingGrowth : kFollowingGrowth), ceiling);
}

void LinkRoom::BackOff(double now) {
  m_state = State::kFollowing;
  // What waits although hardly anything is sent is not this client's: others fill the link, or its way has changed.
  if (m_rate <= kLeastRoom) m_least = m_leastBefore = m_interval.roundTrip;
  const double carried = std::max(m_interval.FindArrived(now), kLeastArrived * m_interval.FindUsed(now));
  m_rate = std::max(std::min(m_rate, kLeastRoom), kBackOff * std::min(m_rate, carried));
}

}  // namespace wobble::server
