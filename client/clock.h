// What time it is in the world on the server, judged only by when snapshots arrive.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace wobble::client {

// World time is tick / tickHz, seconds. The estimate is the world time of a snapshot that would arrive right now over
// the fastest trip seen lately; it lags the server's own by that trip, which a client cannot know (client.h says how it
// is guessed). Continuous and, unless it jumps, never backwards while the server's time runs at 0.1 or faster.
class Clock {
 public:
  // A snapshot of `worldTime` arrived at `now`, which never goes backwards. timeRatio: as the server published it,
  // 0..1.
  void AddArrival(double worldTime, double timeRatio, double now);

  [[nodiscard]] bool Started() const { return m_started; }
  // 0 before the first arrival.
  [[nodiscard]] double ServerTime(double now) const;
  // How much later the last arrival recorded came than the fastest of the last 16 to 32 s, seconds. The estimate above
  // follows what is fast lately; this tells how long packets really took, also when all of them have been slow for
  // seconds (a client that polls just before packets come, say).
  [[nodiscard]] double Lateness() const { return m_lateness; }
  // World seconds per second right now.
  [[nodiscard]] double TimeRatio() const { return m_timeRatio; }

 private:
  // Smallest offset of the arrivals within one bucket of the window.
  struct Bucket {
    std::int64_t index = std::numeric_limits<std::int64_t>::min();  // never filled
    double offset = 0;
  };
  static constexpr std::size_t kBuckets = 16;

  [[nodiscard]] double Scaled(double now) const { return m_scaled + m_timeRatio * (now - m_updated); }
  [[nodiscard]] double Offset(double now) const;
  void Record(double offset, double now);
  double RecordFastest(double offset, double now);
  [[nodiscard]] double FindSmallest(double now) const;

  bool m_started = false;
  double m_startedAt = 0;
  double m_updated = 0;  // when the fields below were brought up to date
  double m_scaled = 0;   // local time run at the server's rate: the integral of the time ratio
  double m_timeRatio = 1;
  double m_newestWorldTime = 0;
  double m_offset = 0;  // scaled local time minus world time, as in use
  double m_target = 0;  // and as the window would have it
  std::array<Bucket, kBuckets> m_buckets{};
  std::array<Bucket, 2> m_fastest{};  // the same over halves of the long window
  double m_lateness = 0;
};

}  // namespace wobble::client
