// What enters a playground: everything beside the scene that decides its next ticks.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/play/command.h"

namespace wobble::server {

// Of a client that is in: gives it this name.
struct JoinEntry {
  ClientId client = 0;
  bool isSpectator = false;  // has no body
  std::string name;
  bool isBot = false;
};

struct LeaveEntry {
  ClientId client = 0;
};

// What a player asks of their body and hand, from the next tick until the next such entry.
struct MoveEntry {
  ClientId client = 0;
  physics::Control control;
  std::optional<HandCommand> hand;
};

// Whether the world can bear it; a hand is within 10⁵ m.
[[nodiscard]] inline bool IsPossible(const MoveEntry& move) {
  constexpr double kFarthestHand = 1e5;  // m
  if (!move.control.IsPossible()) return false;
  if (!move.hand) return true;
  const physics::Vector3d& target = move.hand->target;
  return target.allFinite() && target.cwiseAbs().maxCoeff() <= kFarthestHand;
}

// A single act of a player. A TuneCommand is of gravity or stiffness: the pace of time is not the world's.
struct ActEntry {
  ClientId client = 0;
  bool isHost = false;        // owns the server
  bool mayChangeAll = false;  // in the workshop, whatever is protected
  std::variant<ShoveCommand, CutCommand, TuneCommand, BuildCommand> command;
};

// Whether players may change what others built.
struct ProtectEntry {
  bool isProtected = false;
};

// Puts the scene's bodies back to their places, the workshop to what the scene has, and tuning to usual. What is torn
// stays torn.
struct ResetEntry {};

// Begins anew from the scene: bodies are whole and at their places, the workshop and the game as at the start. Players
// stay in, and their bodies appear anew. What ProtectEntry said stays: a vote must not lift a moderator's protection.
struct RestartEntry {};

// Puts a body's vertices there, with these velocities: how the laboratory kicks bodies. No client can.
struct MotionEntry {
  physics::BodyId body = 0;
  std::vector<physics::Vector3d> positions;   // world, m
  std::vector<physics::Vector3d> velocities;  // m/s
};

// Whether a player waits for the match to begin.
struct ReadyEntry {
  ClientId client = 0;
  bool isReady = true;
};

// How many rounds make a match, instead of what the scene says.
struct MatchEntry {
  int rounds = 0;  // 0: it never ends
};

using Entry = std::variant<JoinEntry, LeaveEntry, MoveEntry, ActEntry, ProtectEntry, ResetEntry, RestartEntry,
                           MotionEntry, ReadyEntry, MatchEntry>;

}  // namespace wobble::server
