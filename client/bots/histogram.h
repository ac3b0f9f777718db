// Percentiles of any number of values in a fixed 17 KiB.
//
// There are 64 buckets per doubling of the value. A percentile from kSmallest to kLargest is therefore within
// kRelativeError of a value that really occurred at that rank; below kSmallest it is within kSmallest, and values above
// kLargest count as kLargest. The histogram has no unit: percentiles have the unit of the values added.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace wobble::bots {

class Histogram {
 public:
  static constexpr double kSmallest = 1.0 / 1024;
  static constexpr int kDoublings = 32;
  static constexpr int kBucketsPerDoubling = 64;
  static constexpr double kLargest = kSmallest * 4294967296.0;  // 2^kDoublings
  // Half of a bucket's width, divided by the bucket's lower edge.
  static constexpr double kRelativeError = 0.5 / kBucketsPerDoubling;

  // Adds one value in constant time. Negative values count as 0, NaN is not counted.
  void Add(double value);

  // The value that a share (0..1) of all values does not exceed (nearest rank); nullopt when no value was added. Costs
  // a pass over the 2,049 buckets.
  [[nodiscard]] std::optional<double> FindPercentile(double share) const;

  [[nodiscard]] std::uint64_t Count() const { return m_count; }

 private:
  static constexpr std::size_t kBuckets = 1 + kDoublings * kBucketsPerDoubling;

  std::array<std::uint64_t, kBuckets> m_buckets{};
  std::uint64_t m_count = 0;
  double m_least = 0;
  double m_greatest = 0;
};

}  // namespace wobble::bots
