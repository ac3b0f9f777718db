// Decides when ticks are due. World time follows wall time in ticks of fixed length. When the machine cannot keep up,
// world time falls behind; a tick never grows longer. Slow motion plays the same ticks less often, and a jump in time
// plays them more often.
#pragma once

#include <cstdint>

namespace wobble::server {

class TickClock {
 public:
  // tickDuration: s. now, here and below: s of wall time. The first tick is due at `now`.
  TickClock(double tickDuration, double now) : m_tickDuration(tickDuration), m_nextTick(now), m_lastCall(now) {}

  // The number of ticks to play now, at most kMaxCatchUp. Ticks owed beyond that are dropped: world time never makes up
  // for them.
  int TakeDueTicks(double now);
  // The number of ticks of a jump to play now, beside those that are due: at most kJumpTicks a call.
  int TakeJumpTicks();

  // Lets no world time pass since the last call: the next tick is due now, and none is dropped. For a paused world.
  void StandStill(double now);

  // World seconds per second, above 0 and at most 1: the rate that players ask for, and the limit that the load allows.
  void SetRate(double rate) { m_rate = rate; }
  [[nodiscard]] double Rate() const { return m_rate; }
  void SetLimit(double limit) { m_limit = limit; }
  // Adds world seconds that are played as fast as possible; at most kMostJumpTicks ticks wait. Jumps add up.
  void Jump(double seconds);

  [[nodiscard]] double NextTick() const { return m_nextTick; }
  // World time per wall time, smoothed over a second; exactly the rate or its limit while no tick is dropped.
  [[nodiscard]] double TimeRatio() const { return Pace() * m_kept; }
  [[nodiscard]] std::uint64_t DroppedTicks() const { return m_droppedTicks; }
  // Ticks, with fraction, that were never due because the limit is below the rate.
  [[nodiscard]] double SlowedTicks() const { return m_slowedTicks; }

 private:
  [[nodiscard]] double Pace() const { return m_rate < m_limit ? m_rate : m_limit; }

  static constexpr int kMaxCatchUp = 3;
  // Few, because a call lasts as long as all its ticks, and a slow machine would not answer meanwhile.
  static constexpr int kJumpTicks = 4;
  static constexpr int kMostJumpTicks = 3600;

  double m_tickDuration;
  double m_nextTick;
  double m_lastCall;
  double m_rate = 1;
  double m_limit = 1;
  double m_kept = 1;  // share of due ticks that were played, smoothed
  int m_jumpTicks = 0;
  std::uint64_t m_droppedTicks = 0;
  double m_slowedTicks = 0;
};

}  // namespace wobble::server
