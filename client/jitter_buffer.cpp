// Delay = 98th percentile of lateness + two snapshot intervals.
//
// Catmull-Rom between two samples needs the sample after them as well, so even on a perfect link the shown moment lies
// up to two intervals behind the newest sample. The link adds how much later than the fastest packet the others come. A
// percentile, not mean plus deviations: delays are one-sided and long-tailed. The histogram forgets with a half-life
// instead of a window, so it costs the same at 30 packets a second and at 3,000.
//
// Too short a delay is visible at once (a held body), too long a delay hardly: so it grows at once and shrinks slowly.
// The shown moment follows by running up to a tenth slower or faster, which players do not notice.
#include "client/jitter_buffer.h"

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
constexpr double kMaxRateChange = 0.1;
// The rate change is full from this error on, seconds, and proportional below, so that it settles smoothly.
constexpr double kFullChangeAt = 0.025;
// Half-lives after which the weights are scaled back, far from where a double overflows.
constexpr double kRescaleAfter = 64.0;

}  // namespace

void JitterBuffer::AddArrival(double lateness, double interval, double now) {
  AddToHistogram(lateness, now);
  const double wanted = std::clamp(FindSpread() + kIntervals * interval, kMinDelay, kMaxDelay);
  const double shrink = m_hasArrival ? kShrinkPerSecond * std::max(now - m_targetAt, 0.0) : 0.0;
  m_target = m_hasArrival ? std::max(wanted, m_target - shrink) : wanted;
  m_targetAt = now;
  m_hasArrival = true;
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
      const double limit = kMaxRateChange * nominal * std::min(std::fabs(error) / kFullChangeAt, 1.0);
      m_playback += nominal + std::clamp(error, -limit, limit);
    }
  }
  m_advancedAt = std::max(now, m_advancedAt);
  m_delay = serverTime - m_playback;
  return m_playback;
}

}  // namespace wobble::client
