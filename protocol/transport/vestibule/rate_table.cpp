#include "protocol/transport/vestibule/rate_table.h"

#include <sodium.h>

namespace wobble::transport::vestibule {
namespace {

constexpr std::size_t kBuckets = 4096;

}  // namespace

RateTable::RateTable(double rate, double burst, const Key& hashKey)
    : m_rate(rate), m_burst(burst), m_hashKey(hashKey), m_buckets(kBuckets) {}

bool RateTable::Take(const Subnet& subnet, double now) { return FindBucket(subnet).Take(m_rate, m_burst, now); }

TokenBucket& RateTable::FindBucket(const Subnet& subnet) {
  static_assert(sizeof(Key) >= crypto_shorthash_KEYBYTES);
  std::array<std::uint8_t, crypto_shorthash_BYTES> hash;
  crypto_shorthash(hash.data(), subnet.data(), subnet.size(), m_hashKey.data());
  const std::size_t place = (hash[0] | std::size_t{hash[1]} << 8U) % kBuckets;
  return m_buckets[place];
}

}  // namespace wobble::transport::vestibule
