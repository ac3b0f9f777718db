// What a load test is asked to do, and how its words on the command line are read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/bots/summary.h"
#include "client/tool/address.h"
#include "protocol/limits.h"
#include "protocol/transport/link_conditions.h"

namespace wobble::bots {

// So many bots of so many decode in full; the first is one of them unless the share is none.
struct DecodeShare {
  unsigned part = 1;
  unsigned whole = 32;

  // index counts from 0.
  [[nodiscard]] bool Includes(unsigned index) const;
};
// 'A/B' with A <= B, or 0 or 1. nullopt with one line in `error`.
[[nodiscard]] std::optional<DecodeShare> ParseDecodeShare(const std::string& text, std::string& error);

inline constexpr unsigned kMaxBots = 10'000;
inline constexpr double kMaxDuration = 1e6;  // seconds, eleven days

struct LoadTestOptions {
  tool::Address server;
  std::string scriptFile;
  unsigned count = 1;
  double ramp = 0;      // seconds over which the joins are spread evenly
  double duration = 0;  // seconds from the first join, the ramp included; 0: until stopped
  std::uint64_t seed = 1;
  std::vector<Threshold> thresholds;
  DecodeShare decodeShare;
  std::optional<transport::LinkSpec> link;  // a relay in between; nullopt: straight to the server
  std::string summaryFile;                  // empty: none
  std::optional<double> statusEvery;        // seconds, 0: never; nullopt: 1 on a terminal, else never
  std::uint16_t protocolVersion = protocol::kProtocolVersion;  // said in hello
};

}  // namespace wobble::bots
