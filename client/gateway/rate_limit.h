// A token bucket for what one browser may send.
//
// A page sends 60 inputs a second and a few commands. After its link has stalled, everything written meanwhile comes at
// once, which is not its fault: so a burst may hold as many seconds as the server waits for a silent client.
#pragma once

#include <algorithm>
#include <cstddef>

#include "protocol/limits.h"

namespace wobble::gateway {

inline constexpr double kMessagesPerSecond = 120;
inline constexpr double kBytesPerSecond = 32 * 1024;  // an input is under 200 bytes
inline constexpr double kBurstSeconds = protocol::kSilenceTimeout;

class RateLimit {
 public:
  // Takes one message of so many bytes; `now` in seconds, never backwards. False when it is over the limit.
  [[nodiscard]] bool Allow(std::size_t bytes, double now) {
    const double passed = m_hasBegun ? now - m_now : 0;
    m_hasBegun = true;
    m_now = now;
    m_messages = std::min(m_messages + passed * kMessagesPerSecond, kBurstSeconds * kMessagesPerSecond) - 1;
    m_bytes =
        std::min(m_bytes + passed * kBytesPerSecond, kBurstSeconds * kBytesPerSecond) - static_cast<double>(bytes);
    return m_messages >= 0 && m_bytes >= 0;
  }

 private:
  bool m_hasBegun = false;
  double m_now = 0;
  // Still allowed at m_now.
  double m_messages = kBurstSeconds * kMessagesPerSecond;
  double m_bytes = kBurstSeconds * kBytesPerSecond;
};

}  // namespace wobble::gateway
