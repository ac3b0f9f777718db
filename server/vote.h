// A vote of the players on one question, such as whether the world begins anew: who has voted, and whether that is
// enough. It knows clients by number only, and is told the time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/play/command.h"

namespace wobble::server {

inline constexpr double kVoteSeconds = 60;  // from the first voice until a vote fails
inline constexpr double kVotePause = 60;    // from a vote that passed until the next may begin, s

class Vote {
 public:
  // kIdle -> kOpen with the first voice; kOpen -> kResting when it passes, -> kIdle when it fails;
  // kResting -> kIdle after kVotePause.
  enum class Stage : std::uint8_t { kIdle, kOpen, kResting };
  enum class Voice : std::uint8_t { kTaken, kRepeated, kTooEarly };
  enum class Outcome : std::uint8_t { kNone, kPassed, kFailed };

  // Adds the voice of a client who is entitled to vote; the first opens the vote. now, here and below: s, never
  // backwards by more than a moment.
  [[nodiscard]] Voice Cast(ClientId client, double now);
  // Drops the voices of those who are not entitled any more, and ends an open vote: more than half of the entitled have
  // voted, no voice is left, or it is too old. entitled: each once. Call it after each Cast and while time passes.
  [[nodiscard]] Outcome Follow(std::span<const ClientId> entitled, double now);

  [[nodiscard]] bool IsOpen() const { return m_stage == Stage::kOpen; }
  // As of the last Cast or Follow.
  [[nodiscard]] std::size_t Voices() const { return m_voices.size(); }
  // How long until the stage ends by time, s; 0 or less: at the next call, or never.
  [[nodiscard]] double SecondsLeft(double now) const;

 private:
  void Enter(Stage stage, double now);

  Stage m_stage = Stage::kIdle;
  double m_since = 0;  // when the stage began, s
  std::vector<ClientId> m_voices;
};

// The fewest voices that are more than half.
[[nodiscard]] constexpr std::size_t FindMajority(std::size_t entitled) { return entitled / 2 + 1; }

}  // namespace wobble::server
