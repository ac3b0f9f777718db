// The options of a load test and the parsers of their values on the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/bots/summary.h"
#include "client/command/address.h"
#include "client/rejoin.h"
#include "protocol/limits.h"
#include "protocol/transport/enet_transport.h"
#include "protocol/transport/link_conditions.h"

namespace wobble::bots {

// Path of the file that --script names. A name for which no file exists here may be that of a shipped script, with or
// without .lua.
[[nodiscard]] std::string FindScriptFile(const std::string& name);

// `part` of every `whole` bots decode snapshots in full. The first bot is one of them unless the share is 0.
struct DecodeShare {
  unsigned part = 1;
  unsigned whole = 32;

  // Whether the bot with this index (counted from 0) decodes.
  [[nodiscard]] bool Includes(unsigned index) const;
};
// Parses 'A/B' with A <= B, or 0 or 1. On failure nullopt, with one line in `error`.
[[nodiscard]] std::optional<DecodeShare> ParseDecodeShare(const std::string& text, std::string& error);

inline constexpr unsigned kMaxBots = 10'000;

// Over `seconds`, the number of bots changes linearly from its previous value to `bots`.
struct Stage {
  double seconds = 0;
  unsigned bots = 0;
};
// Parses 'DURATION:BOTS' with DURATION above 0 and BOTS in 0..kMaxBots. On failure nullopt, with one line in `error`.
[[nodiscard]] std::optional<Stage> ParseStage(const std::string& text, std::string& error);

struct LoadTestOptions {
  command::Address server;
  transport::ConnectOptions access;  // password and the server's key
  std::string scriptFile;
  unsigned count = 1;
  double ramp = 0;            // seconds over which the joins are spread evenly
  double duration = 0;        // seconds from the first join, including the ramp; 0: until stopped
  std::vector<Stage> stages;  // begin from 0 bots; empty: one stage made of ramp and count
  std::uint64_t seed = 1;
  std::vector<Threshold> thresholds;
  DecodeShare decodeShare;
  std::optional<transport::LinkSpec> link;  // a relay between bots and server; nullopt: direct connection
  client::RejoinOptions rejoin;             // of bots that were cut off; each bot has a seed of its own
  bool keepsBases = false;                  // begins with kept bases, as players who return do
  std::string summaryFile;                  // empty: no file
  std::optional<double> statusEvery;        // seconds, 0: never; nullopt: 1 on a terminal, else never
  std::uint16_t protocolVersion = protocol::kProtocolVersion;  // sent in hello
};

// The stages given, or else those that --count and --ramp stand for. Never empty.
[[nodiscard]] std::vector<Stage> ListStages(const LoadTestOptions& options);
// Seconds of the whole run; 0: until stopped.
[[nodiscard]] double FindDuration(const LoadTestOptions& options);
// Number of bots wanted `seconds` after the start; after the last stage, its final number.
[[nodiscard]] unsigned CountBotsAt(const std::vector<Stage>& stages, double seconds);
// Index (from 0) of the stage at that moment; after the last stage, the last.
[[nodiscard]] std::size_t FindStageAt(const std::vector<Stage>& stages, double seconds);
// Number of bots started over the whole run. A bot dismissed by a falling stage does not return; a later rise starts
// new ones.
[[nodiscard]] unsigned CountStarts(const std::vector<Stage>& stages);

}  // namespace wobble::bots
