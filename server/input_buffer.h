// Buffers a player's inputs between the wire and the world, and decides which one acts at which tick.
#pragma once

#include <array>
#include <cstdint>

#include "protocol/messages.h"

namespace wobble::server {

class InputBuffer {
 public:
  // Whether the frame is at most as far ahead of the world as an honest client's clock can be.
  [[nodiscard]] static bool IsNear(const protocol::wire::InputFrame& frame, std::uint32_t currentTick) {
    return frame.tick() <= currentTick + protocol::kMaxInputLeadTicks;
  }

  // Keeps a frame that is newer than the last one used. The frame is near (IsNear). A frame for a tick that has passed,
  // however long ago, acts at the next tick.
  void Add(const protocol::wire::InputFrame& frame, std::uint32_t currentTick);

  // Takes the input for `tick`: the newest frame that is due, with every button that was pressed in any frame that
  // became due with it, so that a short press between two ticks is not lost. Without a new frame the last one is held
  // for holdTicks, or as long as the longest gap that ended lately, up to kMostHolds times holdTicks; after that the
  // input is neutral. Call it once a tick.
  [[nodiscard]] protocol::wire::InputFrame Take(std::uint32_t tick, std::uint32_t holdTicks);

  // Over TCP a lost segment holds inputs back for a round trip and more: players would stop and go.
  static constexpr double kMostHolds = 2.5;

  // Ticks on which the input was neutral because no frame had come.
  [[nodiscard]] std::uint64_t CountStarved() const { return m_starved; }

  // The tick of the newest frame that has been used; 0: none.
  [[nodiscard]] std::uint32_t NewestUsed() const { return m_current.tick(); }

 private:
  void NoteGap(std::uint32_t tick, std::uint32_t holdTicks);

  std::array<protocol::wire::InputFrame, 2 * protocol::kMaxInputLeadTicks> m_waiting{};  // by tick modulo the size
  protocol::wire::InputFrame m_current{};
  std::uint32_t m_newestWaiting = 0;
  std::uint32_t m_usedAt = 0;  // the tick at which m_current came into use
  std::uint32_t m_gap = 0;     // the longest that has ended lately, ticks
  std::uint32_t m_gapAt = 0;   // the tick at which it ended
  std::uint64_t m_starved = 0;
};

}  // namespace wobble::server
