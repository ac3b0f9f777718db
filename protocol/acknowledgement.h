// Which snapshot packets have arrived: the receiver's window, and the sender's record of what it sent.
//
// Packets are never sent again. An acknowledgement is the newest sequence and one bit for each of the kAckHistory
// packets before it, so a lost acknowledgement costs nothing: the next one repeats it.
#pragma once

#include <array>
#include <cstdint>

#include "protocol/limits.h"

namespace wobble::protocol {

// The client's side.
class ReceivedWindow {
 public:
  enum class Arrival {
    kNew,
    kDuplicate,
    kTooOld,  // more than kAckHistory behind the newest: whether it came before is not known
  };
  // Notes the packet of this sequence, 1 or more.
  Arrival Record(std::uint32_t sequence);
  // 0 before the first packet.
  [[nodiscard]] std::uint32_t Newest() const { return m_newest; }
  // Bit i: packet Newest() - 1 - i has arrived.
  [[nodiscard]] std::uint64_t History() const { return m_history; }

 private:
  std::uint32_t m_newest = 0;
  std::uint64_t m_history = 0;
};

// The server's side, one for each client.
class SentWindow {
 public:
  // Returns the sequence for a packet that leaves at `now`, seconds: 1, 2, 3 ...
  std::uint32_t RecordSent(double now);

  struct Report {
    unsigned acknowledged = 0;  // packets acknowledged for the first time
    double roundTrip = -1;      // seconds, of packet `newest`; -1: it was acknowledged before
  };
  // Takes an acknowledgement. False, with nothing changed, when it names packets that were never sent.
  [[nodiscard]] bool RecordAcknowledgement(std::uint32_t newest, std::uint64_t history, double now, Report& report);

  // Share of packets lost, 0..1, among those old enough to be known; smoothed over about 128 packets. Of a run of
  // losses only the first kCountedInRow count: a full link loses single packets, a link that loses all of them is black
  // for a while and as good as before afterwards.
  [[nodiscard]] double LossShare() const { return m_lossShare; }
  // Packets that were never acknowledged, among those old enough to be known.
  [[nodiscard]] std::uint64_t Lost() const { return m_lost; }
  [[nodiscard]] std::uint32_t Newest() const { return m_newest; }

 private:
  static constexpr std::size_t kRemembered = 2 * (kAckHistory + 1);
  static constexpr unsigned kCountedInRow = 8;
  struct Slot {
    std::uint32_t sequence = 0;
    bool acknowledged = false;
    double sentAt = 0;
  };
  Slot& SlotOf(std::uint32_t sequence) { return m_slots[sequence % kRemembered]; }

  std::array<Slot, kRemembered> m_slots{};
  std::uint32_t m_newest = 0;
  unsigned m_lostInRow = 0;
  std::uint64_t m_lost = 0;
  double m_lossShare = 0;
};

}  // namespace wobble::protocol
