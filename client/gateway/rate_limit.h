// Token buckets: for what one browser may send, and for how often an address may do something.
//
// A page sends 60 inputs a second and a few commands. After its link has stalled, everything written meanwhile comes at
// once, which is not its fault: so a burst may hold as many seconds as the server waits for a silent client.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <unordered_map>

#include "protocol/limits.h"

namespace wobble::gateway {

inline constexpr double kMessagesPerSecond = 120;
inline constexpr double kBytesPerSecond = 32 * 1024;  // an input is under 200 bytes
inline constexpr double kBurstSeconds = protocol::kSilenceTimeout;

class RateLimit {
 public:
  // Takes one message of so many bytes; `now` in seconds, never backwards. False when it is over the limit.
  [[nodiscard]] bool Allow(std::size_t bytes, double now) {
    const double passed = m_hasBegun ? now - m_now : 0;
    m_hasBegun = true;
    m_now = now;
    m_messages = std::min(m_messages + passed * kMessagesPerSecond, kBurstSeconds * kMessagesPerSecond) - 1;
    m_bytes =
        std::min(m_bytes + passed * kBytesPerSecond, kBurstSeconds * kBytesPerSecond) - static_cast<double>(bytes);
    return m_messages >= 0 && m_bytes >= 0;
  }

 private:
  bool m_hasBegun = false;
  double m_now = 0;
  // Still allowed at m_now.
  double m_messages = kBurstSeconds * kMessagesPerSecond;
  double m_bytes = kBurstSeconds * kBytesPerSecond;
};

// How often each address may do something.
class AddressRates {
 public:
  AddressRates(double perSecond, double burst) : m_perSecond(perSecond), m_burst(burst) {}

  // Takes one; `now` in seconds, never backwards. False when it is over the limit.
  [[nodiscard]] bool Allow(const std::string& address, double now) {
    if (m_buckets.size() >= kMostAddresses) Forget(now);
    Bucket& bucket = m_buckets.try_emplace(address, Bucket{m_burst, now}).first->second;
    bucket.left = FindLeft(bucket, now);
    bucket.now = now;
    if (bucket.left < 1) return false;
    bucket.left -= 1;
    return true;
  }

 private:
  // Bytes of memory for each: some 150.
  static constexpr std::size_t kMostAddresses = 4096;
  struct Bucket {
    double left;
    double now;
  };

  [[nodiscard]] double FindLeft(const Bucket& bucket, double now) const {
    return std::min(m_burst, bucket.left + (now - bucket.now) * m_perSecond);
  }
  // Those who have not come for a while; everybody where there are none, since a limit for each address does nothing
  // against so many.
  void Forget(double now) {
    const auto isFull = [&](const auto& each) { return FindLeft(each.second, now) >= m_burst; };
    if (std::erase_if(m_buckets, isFull) == 0) m_buckets.clear();
  }

  double m_perSecond;
  double m_burst;
  std::unordered_map<std::string, Bucket> m_buckets;
};

}  // namespace wobble::gateway
