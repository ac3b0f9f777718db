// Decides how far behind the server bodies are shown, and so the moment that is shown.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

namespace wobble::client {

// Bounds of the delay, seconds. Below the first a single frame of the display matters more; above the second a delay
// disturbs players more than held bodies do.
inline constexpr double kMinDelay = 0.040;
inline constexpr double kMaxDelay = 0.500;

class JitterBuffer {
 public:
  // One packet of a snapshot. Times in seconds.
  struct Arrival {
    double worldTime;  // of the snapshot
    double lateness;   // how much later than the fastest would have it came; negative counts as 0
    double interval;   // between snapshots, of world time
    double now;        // never goes backwards
  };
  void AddArrival(const Arrival& arrival);

  // From this moment on lateness counts; before, arrivals say only how far snapshots are apart. What comes while a
  // client downloads, and just after it, tells about the download.
  void CountFrom(double now) { m_countFrom = now; }

  // Moves the shown moment on to `now`, which never goes backwards, and returns it, seconds of world time. serverTime
  // and timeRatio: of the clock. The moment's rate stays within 10 % of timeRatio, or goes up to half above it while
  // the delay is more than a tenth of a second too long. Only when it is off by more than kMaxDelay, that is when the
  // clock itself has jumped, it stands still or leaps ahead. It never goes backwards.
  double Advance(double serverTime, double timeRatio, double now);

  [[nodiscard]] bool Started() const { return m_started; }
  [[nodiscard]] double Playback() const { return m_playback; }
  // The delay that is aimed for, and the present one, which approaches it.
  [[nodiscard]] double TargetDelay() const { return m_target; }
  [[nodiscard]] double Delay() const { return m_delay; }
  // 98th percentile of recent lateness, seconds.
  [[nodiscard]] double FindSpread() const;

 private:
  static constexpr std::size_t kBins = 512;
  static constexpr std::size_t kRecentBuckets = 4;

  // The greatest lateness of a span of time.
  struct Bucket {
    std::int64_t index = std::numeric_limits<std::int64_t>::min();  // never filled
    double lateness = 0;
  };

  void CountPending();
  void AddToHistogram(double lateness, double now);
  void AddToRecent(double lateness, double now);
  [[nodiscard]] double FindRecent(double now) const;

  double m_countFrom = 0;
  // The newest snapshot of the burst that is going on; it counts when the burst is over.
  std::optional<Arrival> m_pending;
  double m_burstAt = 0;                                            // when the burst began
  double m_newestTime = -std::numeric_limits<double>::infinity();  // world time of the newest snapshot

  // A histogram of lateness in bins of a millisecond. The weight of new entries doubles every half-life, which equals
  // halving all older ones.
  std::array<double, kBins> m_bins{};
  double m_total = 0;
  double m_weightEpoch = 0;
  std::array<Bucket, kRecentBuckets> m_recent{};

  double m_target = kMinDelay;
  double m_targetAt = 0;
  bool m_hasTarget = false;
  bool m_started = false;
  double m_playback = 0;
  double m_delay = 0;
  double m_advancedAt = 0;
};

}  // namespace wobble::client
