// A player's inputs between the wire and the world: which one counts at which tick.
#pragma once

#include <array>
#include <cstdint>

#include "protocol/messages.h"

namespace wobble::server {

class InputBuffer {
 public:
  // Not further ahead than an honest client's clock can be.
  [[nodiscard]] static bool IsNear(const protocol::wire::InputFrame& frame, std::uint32_t currentTick) {
    return frame.tick() <= currentTick + protocol::kMaxInputLeadTicks;
  }

  // Keeps a near frame that is newer than what the world has used. One meant for a tick that has passed, however long
  // ago, is used at the next.
  void Add(const protocol::wire::InputFrame& frame, std::uint32_t currentTick);

  // The input for `tick`: the newest frame that is due, with every button pressed in frames that became due with it,
  // so that a short press between two ticks is not lost. Without a new one the last is held for holdTicks, then
  // neutral. Call it once a tick.
  [[nodiscard]] protocol::wire::InputFrame Take(std::uint32_t tick, std::uint32_t holdTicks);

  // Stamp of the newest frame that has been used; 0: none.
  [[nodiscard]] std::uint32_t NewestUsed() const { return m_current.tick(); }

 private:
  std::array<protocol::wire::InputFrame, 2 * protocol::kMaxInputLeadTicks> m_waiting{};  // by stamp modulo the size
  protocol::wire::InputFrame m_current{};
  std::uint32_t m_newestWaiting = 0;
  std::uint32_t m_usedAt = 0;
};

}  // namespace wobble::server
