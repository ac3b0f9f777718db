// Decides how far behind the server bodies are shown, and so the moment that is shown.
#pragma once

#include <array>
#include <cstddef>

namespace wobble::client {

// Bounds of the delay, seconds. Below the first a single frame of the display matters more; above the second a delay
// disturbs players more than held bodies do.
inline constexpr double kMinDelay = 0.040;
inline constexpr double kMaxDelay = 0.500;

class JitterBuffer {
 public:
  // A packet came `lateness` seconds later than the fastest would have (negative counts as 0). interval: between
  // snapshots, seconds of world time.
  void AddArrival(double lateness, double interval, double now);

  // Moves the shown moment on to `now`, which never goes backwards, and returns it, seconds of world time. serverTime
  // and timeRatio: of the clock. The moment's rate stays within 10 % of timeRatio. Only when it is off by more than
  // kMaxDelay, that is when the clock itself has jumped, it stands still or leaps ahead. It never goes backwards.
  double Advance(double serverTime, double timeRatio, double now);

  [[nodiscard]] bool Started() const { return m_started; }
  [[nodiscard]] double Playback() const { return m_playback; }
  // The delay that is aimed for, and the present one, which approaches it at a tenth of real time.
  [[nodiscard]] double TargetDelay() const { return m_target; }
  [[nodiscard]] double Delay() const { return m_delay; }
  // 98th percentile of recent lateness, seconds.
  [[nodiscard]] double FindSpread() const;

 private:
  static constexpr std::size_t kBins = 512;

  void AddToHistogram(double lateness, double now);

  // A histogram of lateness in bins of a millisecond. The weight of new entries doubles every half-life, which equals
  // halving all older ones.
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
