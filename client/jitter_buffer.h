// How far behind the server bodies are shown, and the moment that is shown now.
#pragma once

#include <array>
#include <cstddef>

namespace wobble::client {

// Bounds of the delay, seconds. Below the first a single frame of the display would matter more; above the second
// players would rather see bodies held than play that late.
inline constexpr double kMinDelay = 0.040;
inline constexpr double kMaxDelay = 0.500;

class JitterBuffer {
 public:
  // A packet came `lateness` seconds after the fastest would have (negative counts as 0). interval: between snapshots,
  // seconds of world time.
  void AddArrival(double lateness, double interval, double now);

  // Moves the shown moment on to `now` (never backwards) and returns it, seconds of world time. serverTime and
  // timeRatio as the clock has them. Its rate stays within 10 % of timeRatio; it stands still, or leaps ahead, only
  // when it is off by more than kMaxDelay, that is when the clock itself has jumped. It never goes backwards.
  double Advance(double serverTime, double timeRatio, double now);

  [[nodiscard]] bool Started() const { return m_started; }
  [[nodiscard]] double Playback() const { return m_playback; }
  // What is aimed for, and what is: the second follows the first at a tenth of real time.
  [[nodiscard]] double TargetDelay() const { return m_target; }
  [[nodiscard]] double Delay() const { return m_delay; }
  // 98th percentile of recent lateness, seconds.
  [[nodiscard]] double FindSpread() const;

 private:
  static constexpr std::size_t kBins = 512;

  void AddToHistogram(double lateness, double now);

  // Lateness in bins of a millisecond; a weight doubles every half-life, which is the same as all older ones halving.
  std::array<double, kBins> m_bins{};
  double m_total = 0;
  double m_weightEpoch = 0;

  double m_target = kMinDelay;
  double m_targetAt = 0;
  bool m_hasArrival = false;
  bool m_started = false;
  double m_playback = 0;
  double m_delay = 0;
  double m_advancedAt = 0;
};

}  // namespace wobble::client
