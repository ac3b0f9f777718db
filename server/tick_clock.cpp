#include "server/tick_clock.h"

#include <algorithm>
#include <cmath>

namespace wobble::server {

int TickClock::TakeDueTicks(double now) {
  const double owed = now < m_nextTick ? 0 : std::floor((now - m_nextTick) / m_tickDuration) + 1;
  const int taken = static_cast<int>(std::min<double>(owed, kMaxCatchUp));
  const double dropped = owed - taken;
  m_nextTick += owed * m_tickDuration;
  m_droppedTicks += static_cast<std::uint64_t>(dropped);

  const double elapsed = now - m_lastCall;
  m_lastCall = now;
  if (elapsed > 0) {
    const double ratio = std::clamp(1 - dropped * m_tickDuration / elapsed, 0.0, 1.0);
    m_timeRatio += (ratio - m_timeRatio) * (1 - std::exp(-elapsed));
    if (m_timeRatio > 0.9995) m_timeRatio = 1;
  }
  return taken;
}

void TickClock::StandStill(double now) {
  m_nextTick = std::max(m_nextTick, now);
  m_lastCall = now;
}

}  // namespace wobble::server
