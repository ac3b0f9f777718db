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

  // What became of packets. Of a run of losses only the first kCountedInRow count: a full link loses single packets, a
  // link that loses all of them is black for a while and as good as before afterwards.
  struct Tally {
    unsigned arrived = 0;
    unsigned lost = 0;
  };
  // Of the packets about which it has become clear since the last call: an acknowledged one left more than kOvertaking
  // after them.
  [[nodiscard]] Tally Judge();
  // Packets that were never acknowledged, among those that have been judged.
  [[nodiscard]] std::uint64_t Lost() const { return m_lost; }
  [[nodiscard]] std::uint32_t Newest() const { return m_newest; }

 private:
  static constexpr std::size_t kRemembered = 4 * (kAckHistory + 1);
  static constexpr unsigned kCountedInRow = 8;
  static constexpr double kOvertaking = 0.15;  // s; a packet that comes later than that is lost for all uses
  struct Slot {
    std::uint32_t sequence = 0;
    bool acknowledged = false;
    double sentAt = 0;
  };
  Slot& SlotOf(std::uint32_t sequence) { return m_slots[sequence % kRemembered]; }

  void JudgeNext();

  std::array<Slot, kRemembered> m_slots{};
  std::uint32_t m_newest = 0;
  std::uint32_t m_judged = 0;  // all up to this one are
  double m_acknowledged = 0;   // when the newest acknowledged packet had left, s
  unsigned m_lostInRow = 0;
  std::uint64_t m_lost = 0;
  Tally m_tally;
};

}  // namespace wobble::protocol
