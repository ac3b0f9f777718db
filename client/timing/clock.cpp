// A minimum filter over arrivals, followed at a bounded rate.
//
// Queues only delay packets, so the earliest arrival carries the most information: offset = local time of arrival minus
// world time, the smallest of the last two seconds (as NTP's clock filter takes the sample of least delay, RFC 5905
// section 10). A mean or a line through all arrivals was rejected: both move with every burst of jitter. Two seconds
// are short enough to follow crystals (100 ppm: 0.2 ms) and a changed route.
//
// An overloaded server lets world time fall behind and says so in every packet. Local time is therefore scaled by the
// published ratio before it is compared; otherwise offsets would grow steadily. The published ratio is a mean over the
// last second and so comes late; while it is below 1 only the last half second of arrivals counts.
#include "client/timing/clock.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wobble::client {
namespace {

constexpr double kBucketSeconds = 0.125;
constexpr std::int64_t kBucketsWhenSlow = 4;
// Half of the window in which lateness is measured: crystals drift apart by at most 3 ms in it (100 ppm).
constexpr double kFastestSeconds = 16;
constexpr double kSlowBelow = 0.99;
// For so many seconds after the first arrival a smaller offset is taken at once: nothing has been shown moving yet.
constexpr double kStartUp = 1.0;
// Seconds of correction per second, and the error above which the estimate jumps instead of being wrong for long.
constexpr double kMaxSlew = 0.1;
constexpr double kJumpAbove = 0.25;

std::int64_t BucketIndex(double now) { return static_cast<std::int64_t>(std::floor(now / kBucketSeconds)); }
std::int64_t HalfIndex(double now) { return static_cast<std::int64_t>(std::floor(now / kFastestSeconds)); }

}  // namespace

void RecentMinimum::Record(double value, double now) {
  m_newest = HalfIndex(now);
  Half& half = m_halves[static_cast<std::uint64_t>(m_newest) % 2];
  half.value = half.index == m_newest ? std::min(half.value, value) : value;
  half.index = m_newest;
}

double RecentMinimum::Read() const {
  const Half& half = m_halves[static_cast<std::uint64_t>(m_newest) % 2];
  const Half& before = m_halves[static_cast<std::uint64_t>(m_newest + 1) % 2];
  if (half.index != m_newest) return 0;
  return before.index == m_newest - 1 ? std::min(before.value, half.value) : half.value;
}

void Clock::AddArrival(double worldTime, double timeRatio, double now) {
  assert(!m_started || now >= m_updated);
  if (!m_started) {
    m_started = true;
    m_startedAt = m_updated = now;
    m_newestWorldTime = worldTime;
    m_offset = m_target = -worldTime;
  }
  m_offset = Offset(now);
  m_scaled = Scaled(now);
  m_updated = now;
  if (worldTime >= m_newestWorldTime) {
    m_newestWorldTime = worldTime;
    m_timeRatio = std::clamp(timeRatio, 0.0, 1.0);
  }

  Record(m_scaled - worldTime, now);
  m_target = FindSmallest(now);
  m_fastest.Record(m_scaled - worldTime, now);
  m_lateness = m_scaled - worldTime - m_fastest.Read();
  const bool startingUp = now - m_startedAt < kStartUp && m_target < m_offset;
  if (startingUp || std::fabs(m_target - m_offset) > kJumpAbove) m_offset = m_target;
}

double Clock::ServerTime(double now) const { return m_started ? Scaled(now) - Offset(now) : 0.0; }

double Clock::Offset(double now) const {
  const double reach = kMaxSlew * std::max(now - m_updated, 0.0);
  return m_offset + std::clamp(m_target - m_offset, -reach, reach);
}

void Clock::Record(double offset, double now) {
  const std::int64_t index = BucketIndex(now);
  Bucket& bucket = m_buckets[static_cast<std::uint64_t>(index) % kBuckets];
  bucket.offset = bucket.index == index ? std::min(bucket.offset, offset) : offset;
  bucket.index = index;
}

double Clock::FindSmallest(double now) const {
  const std::int64_t newest = BucketIndex(now);
  const std::int64_t span = m_timeRatio < kSlowBelow ? kBucketsWhenSlow : std::int64_t{kBuckets};
  double smallest = m_scaled - m_newestWorldTime;  // replaced below: the arrival just recorded is always there
  bool found = false;
  for (const Bucket& bucket : m_buckets) {
    if (bucket.index <= newest - span || bucket.index > newest) continue;
    smallest = found ? std::min(smallest, bucket.offset) : bucket.offset;
    found = true;
  }
  assert(found);
  return smallest;
}

}  // namespace wobble::client
