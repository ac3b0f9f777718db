// The state of one client's snapshots: how long each body has waited, which bodies at rest the client has, and how many
// bytes may be sent.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/acknowledgement.h"
#include "server/snapshots/coarseness.h"
#include "server/snapshots/link_room.h"

namespace wobble::server {

class Subscription {
 public:
  // One client's interest in one body. A rest is named by the tick at which the body fell asleep (ShownBody::restTick);
  // towards a client it is in one of three states:
  //   unsent   restKnown and restSent are other ticks
  //   sent     restSent is its tick: NoteRestSent; back to unsent when a packet is lost or nothing is heard for 0.5 s
  //   known    restKnown is its tick: all packets that brought it were acknowledged, or it has no records
  // Two ticks and not one enum: a body may wake and rest anew while the acknowledgement of its last rest is on its way.
  struct Interest {
    std::uint32_t body = 0;
    float priority = 0;           // grows with every snapshot that leaves the body out
    std::uint32_t restKnown = 0;  // 0: none
    std::uint32_t restSent = 0;   // 0: none
    double restSentAt = 0;        // s
  };

  // Takes an acknowledgement: packet `newest` has arrived, and packet newest - 1 - i where bit i of history is set.
  // Returns false and changes nothing when it names a packet that was never sent. report: see SentWindow.
  [[nodiscard]] bool TakeAcknowledgement(std::uint32_t newest, std::uint64_t history, double now,
                                         protocol::SentWindow::Report& report);
  // Notes that packets first to last carry all records of the interest's body, which rests since restTick.
  void NoteRestSent(Interest& interest, std::uint32_t restTick, std::uint32_t first, std::uint32_t last, double now);
  // Whether this rest need not be sent: the client has it, or it was sent less than 0.5 s ago and is not known lost.
  [[nodiscard]] static bool IsSettled(const Interest& interest, std::uint32_t restTick, double now);

  // Another scene begins: its bodies have none of this, under whatever numbers. Packets are counted on.
  void ForgetScene();

  std::vector<Interest> interests;  // one per shown body, by ascending id
  protocol::SentWindow sent;
  std::uint64_t lossesCounted = 0;  // of sent.Lost(), in SendCounts::packetsLost
  LinkRoom room;
  bool isShort = false;   // in the last turn the budget left bodies out or made them coarser
  double credit = 0;      // bytes that may be sent; below zero after a record that just went over
  double nearCredit = 0;  // of these, for near bodies before all others
  Coarseness coarseness;
  Coarseness::Turn turn;  // the one under way

 private:
  // A rest under way.
  struct Delivery {
    std::uint32_t body = 0;
    std::uint32_t restTick = 0;
    std::uint32_t first = 0;  // packets
    std::uint32_t last = 0;
  };
  enum class Fate : std::uint8_t { kUnknown, kArrived, kLost };
  [[nodiscard]] static Fate FindFate(const Delivery& delivery, std::uint32_t newest, std::uint64_t history);

  std::vector<Delivery> m_deliveries;  // whose fate is unknown
};

}  // namespace wobble::server
