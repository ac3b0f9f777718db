// A rate for each subnet, in a table of fixed size: however many subnets there are, it neither grows nor is emptied.
//
// Subnets share an entry when their keyed hashes agree, which nobody can bring about who does not know the key. With
// 4,096 entries a flood from everywhere costs an honest subnet only its share of the flood.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/transport/net_address.h"
#include "protocol/transport/vestibule/keys.h"

namespace wobble::transport::vestibule {

// Tokens that refill at a rate.
struct TokenBucket {
  double tokens = 0;
  double filledAt = 0;  // s

  // Takes one token if there is one. rate: tokens a second; burst: the most that it holds, and has at the beginning.
  [[nodiscard]] bool Take(double rate, double burst, double now) {
    tokens = filledAt == 0 ? burst : std::min(burst, tokens + rate * (now - filledAt));
    filledAt = now;
    if (tokens < 1) return false;
    --tokens;
    return true;
  }
};

class RateTable {
 public:
  RateTable(double rate, double burst, const Key& hashKey);
  // Whether one more of this subnet is within the rate. now: s, above 0.
  [[nodiscard]] bool Take(const Subnet& subnet, double now);
  // Gives one back that was taken.
  void Return(const Subnet& subnet) { ++FindBucket(subnet).tokens; }

 private:
  [[nodiscard]] TokenBucket& FindBucket(const Subnet& subnet);

  double m_rate;
  double m_burst;
  Key m_hashKey;
  std::vector<TokenBucket> m_buckets;
};

}  // namespace wobble::transport::vestibule
