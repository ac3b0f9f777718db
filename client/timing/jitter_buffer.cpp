// Delay = lateness + two snapshot intervals. Lateness is the 98th percentile of the last seconds, and no more than the
// greatest of the last second and a margin.
//
// Catmull-Rom between two samples needs the sample after them as well, so even on a perfect link the shown moment lies
// up to two intervals behind the newest sample. The link adds how much later than the fastest packet the others come. A
// percentile, not mean plus deviations: delays are one-sided and long-tailed. The histogram forgets with a half-life
// instead of a window, so it costs the same at 30 packets a second and at 3,000.
//
// Lateness counts by news, not by packet. Over TCP a lost segment holds back all that follow: then they come at once,
// and only the newest of them says how old the picture has to be. To count all of them took the delay to its cap after
// every black-out of a quarter of a second. A packet of a snapshot older than the newest tells nothing at all.
//
// Too short a delay is visible at once (a held body), so it grows at once. It shrinks slowly while the link is uneven,
// since what was late a second ago may be late again; but once nothing of a second was, the line is good again, and the
// delay has no reason any more. The shown moment follows by running up to a tenth slower or faster, which players do
// not notice, and up to half faster to catch up, which they notice less than two seconds of an old picture.
#include "client/timing/jitter_buffer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wobble::client {
namespace {

constexpr double kBinSeconds = 0.001;
constexpr double kHalfLife = 2.0;
constexpr double kPercentile = 0.98;
constexpr double kIntervals = 2.0;
constexpr double kShrinkPerSecond = 0.02;
// How much longer than the greatest recent lateness the delay may be, and the length of a bucket of it, seconds.
constexpr double kRecentMargin = 0.03;
constexpr double kRecentSeconds = 0.25;
// Packets that come closer to each other than this share of an interval are one burst.
constexpr double kBurstGap = 0.25;
constexpr double kMaxRateChange = 0.1;
// Catching up: rate for each second of delay that is too much, and the highest.
constexpr double kCatchUpGain = 5;
constexpr double kFastestCatchUp = 0.5;
// The rate change is full from this error on, seconds, and proportional below, so that it settles smoothly.
constexpr double kFullChangeAt = 0.025;
// Half-lives after which the weights are scaled back, far from where a double overflows.
constexpr double kRescaleAfter = 64.0;

}  // namespace

void JitterBuffer::AddArrival(const Arrival& arrival) {
  if (arrival.worldTime < m_newestTime) return;
  m_newestTime = arrival.worldTime;
  // The packets of large snapshots come in one stream without an end.
  const bool isOver = m_pending && (arrival.now - m_pending->now > kBurstGap * arrival.interval ||
                                    arrival.now - m_burstAt > arrival.interval);
  if (isOver) CountPending();
  if (!m_pending) m_burstAt = arrival.now;
  m_pending = arrival;
}

void JitterBuffer::CountPending() {
  const Arrival arrival = *m_pending;
  m_pending.reset();
  if (arrival.now >= m_countFrom) {
    AddToHistogram(arrival.lateness, arrival.now);
    AddToRecent(arrival.lateness, arrival.now);
  }
  const double least = kIntervals * arrival.interval;
  const double usual = std::clamp(FindSpread() + least, kMinDelay, kMaxDelay);
  const double recent = std::clamp(FindRecent(arrival.now) + kRecentMargin + least, kMinDelay, kMaxDelay);
  const double shrink = kShrinkPerSecond * std::max(arrival.now - m_targetAt, 0.0);
  m_target = std::min(m_hasTarget ? std::max(usual, m_target - shrink) : usual, recent);
  m_targetAt = arrival.now;
  m_hasTarget = true;
}

void JitterBuffer::AddToRecent(double lateness, double now) {
  const auto index = static_cast<std::int64_t>(std::floor(now / kRecentSeconds));
  Bucket& bucket = m_recent[static_cast<std::uint64_t>(index) % kRecentBuckets];
  bucket.lateness = bucket.index == index ? std::max(bucket.lateness, lateness) : lateness;
  bucket.index = index;
}

double JitterBuffer::FindRecent(double now) const {
  const auto newest = static_cast<std::int64_t>(std::floor(now / kRecentSeconds));
  double greatest = 0;
  for (const Bucket& bucket : m_recent) {
    if (bucket.index > newest - std::int64_t{kRecentBuckets}) greatest = std::max(greatest, bucket.lateness);
  }
  return greatest;
}

void JitterBuffer::AddToHistogram(double lateness, double now) {
  double age = (now - m_weightEpoch) / kHalfLife;
  if (m_total == 0.0 || age > kRescaleAfter) {
    const double scale = m_total == 0.0 ? 0.0 : std::exp2(-age);
    for (double& bin : m_bins) bin *= scale;
    m_total *= scale;
    m_weightEpoch = now;
    age = 0;
  }
  const double bin = std::clamp(lateness / kBinSeconds, 0.0, static_cast<double>(kBins - 1));
  const double weight = std::exp2(age);
  m_bins[static_cast<std::size_t>(bin)] += weight;
  m_total += weight;
}

double JitterBuffer::FindSpread() const {
  double above = 0;
  for (std::size_t i = kBins; i-- > 0;) {
    above += m_bins[i];
    if (above > (1.0 - kPercentile) * m_total) return static_cast<double>(i + 1) * kBinSeconds;
  }
  return 0;
}

double JitterBuffer::Advance(double serverTime, double timeRatio, double now) {
  if (m_pending && (!m_hasTarget || now - m_pending->now > kBurstGap * m_pending->interval)) CountPending();
  const double wanted = serverTime - m_target;
  if (!m_started) {
    m_started = true;
    m_playback = wanted;
  } else if (now > m_advancedAt) {
    const double nominal = timeRatio * (now - m_advancedAt);
    const double error = wanted - (m_playback + nominal);
    if (error > kMaxDelay) {
      m_playback = wanted;
    } else if (error > -kMaxDelay) {
      const double rate = std::clamp(kCatchUpGain * error, kMaxRateChange, kFastestCatchUp);
      const double limit = rate * nominal * std::min(std::fabs(error) / kFullChangeAt, 1.0);
      m_playback += nominal + std::clamp(error, -limit, limit);
    }
  }
  m_advancedAt = std::max(now, m_advancedAt);
  m_delay = serverTime - m_playback;
  return m_playback;
}

}  // namespace wobble::client
