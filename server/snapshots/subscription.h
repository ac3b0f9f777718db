// A client's view of the sending: how long each body has waited, what is known of those that lie still, and how much
// may be sent.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/acknowledgement.h"

namespace wobble::server {

class Subscription {
 public:
  struct Interest {
    std::uint32_t body = 0;
    float priority = 0;
    // Of a rest (ShownBody::restTick) that has arrived there, and of one that is on its way; 0: none.
    std::uint32_t restKnown = 0;
    std::uint32_t restSent = 0;
    double restSentAt = 0;
  };

  // The client has what packets up to `newest` brought, and bit i of history: packet newest - 1 - i. False, and nothing
  // changed, when it acknowledges what was never sent.
  [[nodiscard]] bool TakeAcknowledgement(std::uint32_t newest, std::uint64_t history, double now,
                                         protocol::SentWindow::Report& report);
  // Packets first to last brought all records of the body of this interest, which lies still since restTick.
  void NoteRestSent(Interest& interest, std::uint32_t restTick, std::uint32_t first, std::uint32_t last, double now);
  // Whether to send it again would be for nothing: it is there, or on its way.
  [[nodiscard]] static bool IsSettled(const Interest& interest, std::uint32_t restTick, double now);

  std::vector<Interest> interests;  // by ascending body, as those shown
  protocol::SentWindow sent;
  double credit = 0;           // bytes that may be sent; below zero after a record that just went over
  std::size_t coarseness = 0;  // added to the quality of all bodies
  int crowdedSnapshots = 0;    // in a row that left bodies out
  int easySnapshots = 0;       // in a row that left none out, and finer ones would not have

 private:
  struct Delivery {
    std::uint32_t body = 0;
    std::uint32_t restTick = 0;
    std::uint32_t first = 0;
    std::uint32_t last = 0;
  };
  enum class Fate : std::uint8_t { kUnknown, kArrived, kLost };
  [[nodiscard]] static Fate FindFate(const Delivery& delivery, std::uint32_t newest, std::uint64_t history);

  std::vector<Delivery> m_deliveries;  // that nothing is known of yet
};

}  // namespace wobble::server
