// A body at rest is sent until its client has it. What was sent is taken for lost as soon as later packets have come
// without it, as TCP's fast retransmit does (RFC 5681, section 3.2), so it is sent twice, not at every snapshot of a
// round trip.
#include "server/snapshots/subscription.h"

#include "server/snapshots/capture.h"

namespace wobble::server {
namespace {

// Packets that may overtake one that is not lost.
constexpr std::uint32_t kMostOvertaking = 3;
// s after which it is sent again though nothing was heard at all.
constexpr double kPatience = 0.5;
// Deliveries that are remembered. A client that never acknowledges any would have the list grow for ever.
constexpr std::size_t kMostDeliveries = 4096;

}  // namespace

Subscription::Fate Subscription::FindFate(const Delivery& delivery, std::uint32_t newest, std::uint64_t history) {
  if (newest < delivery.last) return Fate::kUnknown;
  if (newest - delivery.first > protocol::kAckHistory) return Fate::kLost;  // nobody will tell any more
  for (std::uint32_t sequence = delivery.first; sequence <= delivery.last; ++sequence) {
    const bool arrived = sequence == newest || (history >> (newest - sequence - 1) & 1) != 0;
    if (!arrived) return newest > delivery.last + kMostOvertaking ? Fate::kLost : Fate::kUnknown;
  }
  return Fate::kArrived;
}

bool Subscription::TakeAcknowledgement(std::uint32_t newest, std::uint64_t history, double now,
                                       protocol::SentWindow::Report& report) {
  if (!sent.RecordAcknowledgement(newest, history, now, report)) return false;
  std::erase_if(m_deliveries, [&](const Delivery& delivery) {
    const Fate fate = FindFate(delivery, newest, history);
    if (fate == Fate::kUnknown) return false;
    if (Interest* interest = FindBody(std::span(interests), delivery.body); interest != nullptr) {
      if (fate == Fate::kArrived) interest->restKnown = delivery.restTick;
      if (fate == Fate::kLost && interest->restSent == delivery.restTick) interest->restSent = 0;
    }
    return true;
  });
  return true;
}

void Subscription::NoteRestSent(Interest& interest, std::uint32_t restTick, std::uint32_t first, std::uint32_t last,
                                double now) {
  interest.restSent = restTick;
  interest.restSentAt = now;
  if (m_deliveries.size() == kMostDeliveries) m_deliveries.erase(m_deliveries.begin());
  m_deliveries.push_back({interest.body, restTick, first, last});
}

bool Subscription::IsSettled(const Interest& interest, std::uint32_t restTick, double now) {
  return interest.restKnown == restTick || (interest.restSent == restTick && now < interest.restSentAt + kPatience);
}

}  // namespace wobble::server
