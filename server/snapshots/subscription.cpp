// A body at rest is sent until the client has it. A packet counts as lost as soon as a few later ones have arrived
// without it, like TCP's fast retransmit (RFC 5681, section 3.2): so a rest that is lost once is sent twice, and not in
// every snapshot of a round trip.
#include "server/snapshots/subscription.h"

#include "server/snapshots/body_captures.h"

namespace wobble::server {
namespace {

// A packet may be overtaken by this many before it counts as lost.
constexpr std::uint32_t kMostOvertaking = 3;
// A rest is sent again after this time, s, if nothing was heard of it.
constexpr double kPatience = 0.5;
// Bound of the list of deliveries, for clients that never acknowledge; the oldest is forgotten.
constexpr std::size_t kMostDeliveries = 4096;

}  // namespace

Subscription::Fate Subscription::FindFate(const Delivery& delivery, std::uint32_t newest, std::uint64_t history) {
  if (newest < delivery.last) return Fate::kUnknown;
  if (newest - delivery.first > protocol::kAckHistory) return Fate::kLost;  // no acknowledgement reaches that far back
  for (std::uint32_t sequence = delivery.first; sequence <= delivery.last; ++sequence) {
    const bool arrived = sequence == newest || (history >> (newest - sequence - 1) & 1) != 0;
    if (!arrived) return newest > delivery.last + kMostOvertaking ? Fate::kLost : Fate::kUnknown;
  }
  return Fate::kArrived;
}

bool Subscription::TakeAcknowledgement(std::uint32_t newest, std::uint64_t history, double now,
                                       protocol::SentWindow::Report& report) {
  if (!sent.RecordAcknowledgement(newest, history, now, report)) return false;
  room.NoteAcknowledgement(report, now);
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
  m_deliveries.push_back({.body = interest.body, .restTick = restTick, .first = first, .last = last});
}

void Subscription::ForgetScene() {
  interests.clear();
  m_deliveries.clear();
  coarseness = {};
  turn = {};
}

bool Subscription::IsSettled(const Interest& interest, std::uint32_t restTick, double now) {
  return interest.restKnown == restTick || (interest.restSent == restTick && now < interest.restSentAt + kPatience);
}

}  // namespace wobble::server
