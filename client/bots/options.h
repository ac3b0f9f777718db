// What a load test is asked to do, and how its words on the command line are read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/bots/summary.h"
#include "client/command/address.h"
#include "protocol/limits.h"
#include "protocol/transport/link_conditions.h"

namespace wobble::bots {

// The file that --script means: a name that no file here has may be a shipped script's, with or without .lua.
[[nodiscard]] std::string FindScriptFile(const std::string& name);

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

// A number with ms, s, m or h behind it, or bare for seconds, of 0 to tool::kMaxDuration. Seconds; nullopt with one
// line in `error`.
[[nodiscard]] std::optional<double> ParseDuration(const std::string& text, std::string& error);

// For so long, the number of bots goes linearly from what it was to this.
struct Stage {
  double seconds = 0;
  unsigned bots = 0;
};
// 'DURATION:BOTS' with a DURATION above 0 and BOTS of 0 to kMaxBots. nullopt with one line in `error`.
[[nodiscard]] std::optional<Stage> ParseStage(const std::string& text, std::string& error);

struct LoadTestOptions {
  tool::Address server;
  std::string scriptFile;
  unsigned count = 1;
  double ramp = 0;            // seconds over which the joins are spread evenly
  double duration = 0;        // seconds from the first join, the ramp included; 0: until stopped
  std::vector<Stage> stages;  // from no bots at all; empty: one of ramp and count
  std::uint64_t seed = 1;
  std::vector<Threshold> thresholds;
  DecodeShare decodeShare;
  std::optional<transport::LinkSpec> link;  // a relay in between; nullopt: straight to the server
  std::string summaryFile;                  // empty: none
  std::optional<double> statusEvery;        // seconds, 0: never; nullopt: 1 on a terminal, else never
  std::uint16_t protocolVersion = protocol::kProtocolVersion;  // said in hello
};

// The stages, with those that --count and --ramp stand for. Not empty.
[[nodiscard]] std::vector<Stage> ListStages(const LoadTestOptions& options);
// Seconds of the whole run; 0: until stopped.
[[nodiscard]] double FindDuration(const LoadTestOptions& options);
// How many bots there should be `seconds` after the start; past the end as at the end.
[[nodiscard]] unsigned CountBotsAt(const std::vector<Stage>& stages, double seconds);
// The stage that runs then, counted from 0; past the end the last.
[[nodiscard]] std::size_t FindStageAt(const std::vector<Stage>& stages, double seconds);
// How many have to be started over all: who has left does not come back, others come instead.
[[nodiscard]] unsigned CountStarts(const std::vector<Stage>& stages);

}  // namespace wobble::bots
