// What a server owes to the one who runs a fleet of them, and when: the state of a turn of the loop in, calls out.
//
// Apart from agones.h, so that the rules need no socket to be tested. Who does not make these turns makes no health
// calls either: that is how a loop that is stuck comes to be noticed.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace wobble::ops {

struct FleetCall {
  enum class Kind { kHealth, kReady, kAllocate, kAddPlayer, kRemovePlayer, kShutdown };
  Kind kind = Kind::kHealth;
  std::uint32_t client = 0;  // of kAddPlayer and kRemovePlayer

  bool operator==(const FleetCall&) const = default;
};

// A server in this turn of its loop.
struct FleetView {
  double now = 0;  // s, never backwards
  bool acceptsJoins = false;
  bool isMatchOver = false;                     // by the game's own rules
  bool isClosing = false;                       // everybody has been told goodbye
  std::span<const std::uint32_t> players = {};  // numbers of the clients that have joined, each once, in any order
};

class FleetDuty {
 public:
  // Once a turn. What is to be called now, in this order: health every 2 s; ready when joins are accepted for the first
  // time; allocate with the first player; each who has left or come; and, once, shutdown: when the match is over, when
  // all have been gone for 10 s, or when the server closes. After that health alone goes on, for it is the cluster that
  // ends the server: one that left of its own accord would be started again.
  [[nodiscard]] std::vector<FleetCall> Follow(const FleetView& view);

 private:
  // kStarting  -> kReady      joins are accepted for the first time: ready is called
  // kReady     -> kAllocated  the first player has joined: allocate is called
  // any        -> kOver       match over, closing, or deserted while allocated: shutdown is called
  enum class Stage : std::uint8_t { kStarting, kReady, kAllocated, kOver };

  void CountPlayers(std::span<const std::uint32_t> players, std::vector<FleetCall>& calls);
  [[nodiscard]] bool IsDeserted(double now) const;

  double m_nextHealth = -std::numeric_limits<double>::infinity();
  double m_lastCompany = 0;
  Stage m_stage = Stage::kStarting;
  std::vector<std::uint32_t> m_players;  // as far as they have been called, sorted
  std::vector<std::uint32_t> m_present;  // of this turn, sorted; kept for its memory
};

}  // namespace wobble::ops
