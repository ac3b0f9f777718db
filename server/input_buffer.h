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
  // for holdTicks; after that the input is neutral. Call it once a tick.
  [[nodiscard]] protocol::wire::InputFrame Take(std::uint32_t tick, std::uint32_t holdTicks);

  // The tick of the newest frame that has been used; 0: none.
  [[nodiscard]] std::uint32_t NewestUsed() const { return m_current.tick(); }

 private:
  std::array<protocol::wire::InputFrame, 2 * protocol::kMaxInputLeadTicks> m_waiting{};  // by tick modulo the size
  protocol::wire::InputFrame m_current{};
  std::uint32_t m_newestWaiting = 0;
  std::uint32_t m_usedAt = 0;  // the tick at which m_current came into use
};

}  // namespace wobble::server
