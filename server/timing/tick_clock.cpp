// TakeDueTicks counts the whole intervals that have passed since the next tick was due, and moves the due time by as
// many: a late call does not shift the ticks after it. Ticks beyond kMaxCatchUp are dropped rather than played in one
// long call, which would make the next call late as well.
#include "server/timing/tick_clock.h"

#include <algorithm>
#include <cmath>

namespace wobble::server {

int TickClock::TakeDueTicks(double now) {
  const double interval = m_tickDuration / Pace();
  const double owed = now < m_nextTick ? 0 : std::floor((now - m_nextTick) / interval) + 1;
  const int taken = static_cast<int>(std::min<double>(owed, kMaxCatchUp));
  const double dropped = owed - taken;
  m_nextTick += owed * interval;
  m_droppedTicks += static_cast<std::uint64_t>(dropped);

  const double elapsed = now - m_lastCall;
  m_lastCall = now;
  if (elapsed > 0) {
    m_slowedTicks += elapsed * (m_rate - Pace()) / m_tickDuration;
    const double kept = std::clamp(1 - dropped * interval / elapsed, 0.0, 1.0);
    m_kept += (kept - m_kept) * (1 - std::exp(-elapsed));
    if (m_kept > 0.9995) m_kept = 1;
  }
  return taken;
}

int TickClock::TakeJumpTicks() {
  const int taken = std::min(m_jumpTicks, kJumpTicks);
  m_jumpTicks -= taken;
  return taken;
}

void TickClock::Jump(double seconds) {
  m_jumpTicks = std::min(m_jumpTicks + static_cast<int>(std::lround(seconds / m_tickDuration)), kMostJumpTicks);
}

void TickClock::StandStill(double now) {
  m_nextTick = std::max(m_nextTick, now);
  m_lastCall = now;
}

}  // namespace wobble::server
