// Estimates the world time of the server from the arrival times of snapshots alone.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace wobble::client {

// The smallest of the values of the last 16 to 32 s: a value that was too small, because a program was held up between
// reading its clock and its socket, does harm no longer than that.
class RecentMinimum {
 public:
  // now: s, never goes backwards.
  void Record(double value, double now);
  // 0 before the first value; of the last one, if nothing has been recorded since.
  [[nodiscard]] double Read() const;

 private:
  struct Half {
    std::int64_t index = std::numeric_limits<std::int64_t>::min();  // never filled
    double value = 0;
  };
  std::array<Half, 2> m_halves{};
  std::int64_t m_newest = 0;
};

// World time is tick / tickHz, seconds. The estimate is the world time of a snapshot that would arrive now over the
// fastest recent trip. It lags the server's own by that trip, which a client cannot measure (SnapshotArrival::age says
// what is taken for it). It is continuous except for jumps, and does not run backwards between jumps as long as the
// server's time ratio is 0.1 or more.
class Clock {
 public:
  // A snapshot of `worldTime` has arrived at `now`, which never goes backwards. timeRatio: as the server published it,
  // 0..1.
  void AddArrival(double worldTime, double timeRatio, double now);

  [[nodiscard]] bool Started() const { return m_started; }
  // 0 before the first arrival.
  [[nodiscard]] double ServerTime(double now) const;
  // How much later the last arrival came than the fastest of the last 16 to 32 s, seconds. ServerTime follows the
  // fastest of the last two seconds; this tells how long packets really took, also when all of them have been slow for
  // seconds (of a client that polls just before packets come, for instance).
  [[nodiscard]] double Lateness() const { return m_lateness; }
  // World seconds per second, as the newest snapshot has it.
  [[nodiscard]] double TimeRatio() const { return m_timeRatio; }

 private:
  // The smallest offset among the arrivals of one bucket of time.
  struct Bucket {
    std::int64_t index = std::numeric_limits<std::int64_t>::min();  // never filled
    double offset = 0;
  };
  static constexpr std::size_t kBuckets = 16;

  [[nodiscard]] double Scaled(double now) const { return m_scaled + m_timeRatio * (now - m_updated); }
  [[nodiscard]] double Offset(double now) const;
  void Record(double offset, double now);
  [[nodiscard]] double FindSmallest(double now) const;

  bool m_started = false;
  double m_startedAt = 0;
  double m_updated = 0;  // when the fields below were brought up to date
  double m_scaled = 0;   // the integral of the time ratio over local time
  double m_timeRatio = 1;
  double m_newestWorldTime = 0;
  double m_offset = 0;  // scaled local time minus world time, in use
  double m_target = 0;  // the offset that the window says, which m_offset approaches
  std::array<Bucket, kBuckets> m_buckets{};
  RecentMinimum m_fastest;  // offset, for the lateness
  double m_lateness = 0;
};

}  // namespace wobble::client
