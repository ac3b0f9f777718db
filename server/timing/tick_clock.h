// When ticks are due. World time follows wall time at a fixed tick; when the machine cannot keep up, world time falls
// behind instead of a tick growing longer. Slow motion is the same tick less often, and a jump in time the same tick
// more often.
#pragma once

#include <cstdint>

namespace wobble::server {

class TickClock {
 public:
  // tickDuration in seconds; the first tick is due at `now`.
  TickClock(double tickDuration, double now) : m_tickDuration(tickDuration), m_nextTick(now), m_lastCall(now) {}

  // Ticks to take now: at most kMaxCatchUp; what is owed beyond that is dropped from world time for good.
  int TakeDueTicks(double now);
  // Of a jump, ticks to take beside those that are due: a few a call, until all have been taken.
  int TakeJumpTicks();

  // The time since the last call is none of the world's: the next tick is due now, and nothing has been dropped.
  void StandStill(double now);

  // Seconds of the world a second, above 0 and at most 1: as players want it, and at most what there is time for.
  void SetRate(double rate) { m_rate = rate; }
  [[nodiscard]] double Rate() const { return m_rate; }
  void SetLimit(double limit) { m_limit = limit; }
  // So many seconds of the world more, as fast as may be. Another jump begins where the last one ends.
  void Jump(double seconds);

  [[nodiscard]] double NextTick() const { return m_nextTick; }
  // World time per wall time, smoothed over a second; exactly the rate, or its limit, while nothing has been dropped.
  [[nodiscard]] double TimeRatio() const { return Pace() * m_kept; }
  [[nodiscard]] std::uint64_t DroppedTicks() const { return m_droppedTicks; }
  // That were never due because the limit is below the rate.
  [[nodiscard]] double SlowedTicks() const { return m_slowedTicks; }

 private:
  [[nodiscard]] double Pace() const { return m_rate < m_limit ? m_rate : m_limit; }

  static constexpr int kMaxCatchUp = 3;
  // A machine that has its hands full with one tick a call would stand still for longer with more.
  static constexpr int kJumpTicks = 4;
  static constexpr int kMostJumpTicks = 3600;

  double m_tickDuration;
  double m_nextTick;
  double m_lastCall;
  double m_rate = 1;
  double m_limit = 1;
  double m_kept = 1;  // of the ticks that were due, smoothed
  int m_jumpTicks = 0;
  std::uint64_t m_droppedTicks = 0;
  double m_slowedTicks = 0;
};

}  // namespace wobble::server
