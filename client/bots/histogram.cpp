// Logarithmic buckets, as in HdrHistogram: a run of hours with hundreds of bots gives millions of values, and measuring
// must not slow the load test down. Adding a value costs a frexp and an increment.
//
// A reservoir sample was rejected: it is as small, but its error in the far percentiles, which are the ones asked for,
// is random.
#include "client/bots/histogram.h"

#include <algorithm>
#include <cmath>

namespace wobble::bots {

void Histogram::Add(double value) {
  if (std::isnan(value)) return;
  value = std::clamp(value, 0.0, kLargest);
  m_least = m_count == 0 ? value : std::min(m_least, value);
  m_greatest = m_count == 0 ? value : std::max(m_greatest, value);
  ++m_count;

  std::size_t bucket = 0;
  if (value >= kSmallest) {
    int exponent = 0;
    // mantissa in [0.5, 1), so value = kSmallest falls on 0.5, 1
    const double mantissa = std::frexp(value / kSmallest, &exponent);
    const auto within = static_cast<std::size_t>((2 * mantissa - 1) * kBucketsPerDoubling);
    bucket = 1 + static_cast<std::size_t>(exponent - 1) * kBucketsPerDoubling + within;
  }
  ++m_buckets[std::min(bucket, kBuckets - 1)];
}

std::optional<double> Histogram::FindPercentile(double share) const {
  if (m_count == 0) return std::nullopt;
  const double ranks = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(m_count));
  const auto wanted = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(ranks));
  if (wanted == 1) return m_least;  // the greatest and least value are exact
  if (wanted == m_count) return m_greatest;
  std::uint64_t passed = 0;
  std::size_t bucket = 0;
  while (bucket + 1 < kBuckets && passed + m_buckets[bucket] < wanted) passed += m_buckets[bucket++];

  double middle = 0;
  if (bucket > 0) {
    const auto position = static_cast<int>(bucket - 1);
    const double within = (position % kBucketsPerDoubling + 0.5) / kBucketsPerDoubling;
    middle = std::ldexp(kSmallest * (1 + within), position / kBucketsPerDoubling);
  }
  return std::clamp(middle, m_least, m_greatest);
}

}  // namespace wobble::bots
