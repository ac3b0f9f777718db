// When ticks are due. World time follows wall time at a fixed tick; when the machine cannot keep up, world time falls
// behind instead of a tick growing longer.
#pragma once

#include <cstdint>

namespace wobble::server {

class TickClock {
 public:
  // tickDuration in seconds; the first tick is due at `now`.
  TickClock(double tickDuration, double now) : m_tickDuration(tickDuration), m_nextTick(now), m_lastCall(now) {}

  // Ticks to take now: at most kMaxCatchUp; what is owed beyond that is dropped from world time for good.
  int TakeDueTicks(double now);

  // The time since the last call is none of the world's: the next tick is due now, and nothing has been dropped.
  void StandStill(double now);

  [[nodiscard]] double NextTick() const { return m_nextTick; }
  // World time per wall time, smoothed over a second; exactly 1 while nothing has been dropped.
  [[nodiscard]] double TimeRatio() const { return m_timeRatio; }
  [[nodiscard]] std::uint64_t DroppedTicks() const { return m_droppedTicks; }

 private:
  static constexpr int kMaxCatchUp = 3;

  double m_tickDuration;
  double m_nextTick;
  double m_lastCall;
  double m_timeRatio = 1;
  std::uint64_t m_droppedTicks = 0;
};

}  // namespace wobble::server
