// Percentiles of any number of values in a fixed 17 KiB.
//
// Buckets grow with the value, 64 to a doubling, so a percentile is within kRelativeError of a value that really
// occurred at that rank, from kSmallest to kLargest; below kSmallest it is within kSmallest, and what lies above
// kLargest is counted as kLargest. No unit of its own: what goes in comes out.
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
  // Half a bucket's width over its lower edge.
  static constexpr double kRelativeError = 0.5 / kBucketsPerDoubling;

  // Negative values count as 0; a value that is no number is not counted.
  void Add(double value);

  // The value that the share 0..1 of all values does not exceed (nearest rank); nullopt when nothing was added.
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
