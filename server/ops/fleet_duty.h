// Decides which calls a server owes to its fleet manager, and when: the state of a turn of the loop goes in, calls come
// out.
//
// It stands apart from agones.h so that the rules can be tested without a socket. A loop that is stuck makes no health
// calls, and that is how the fleet notices it.
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

// The state of the server in one turn of its loop.
struct FleetView {
  double now = 0;  // s, never backwards
  bool acceptsJoins = false;
  bool isMatchOver = false;                     // by the rules of the game
  bool isClosing = false;                       // goodbye has been said to all clients
  std::span<const std::uint32_t> players = {};  // ids of the clients that have joined, each once, in any order
};

class FleetDuty {
 public:
  // The calls to make now; call it once a turn. In this order: health every 2 s; ready when joins are accepted for the
  // first time; allocate with the first player; a call for each player who has left or joined; and shutdown, once, when
  // the match is over, when all players have been gone for 10 s, or when the server closes. After that only health
  // continues: the cluster ends the server, and one that ended by itself would be started again.
  [[nodiscard]] std::vector<FleetCall> Follow(const FleetView& view);

 private:
  // kStarting  -> kReady      joins are accepted for the first time: ready is called
  // kReady     -> kAllocated  the first player has joined: allocate is called
  // any        -> kOver       match over, closing, or deserted while allocated: shutdown is called
  enum class Stage : std::uint8_t { kStarting, kReady, kAllocated, kOver };

  void CountPlayers(std::span<const std::uint32_t> players, std::vector<FleetCall>& calls);
  [[nodiscard]] bool IsDeserted(double now) const;

  double m_nextHealth = -std::numeric_limits<double>::infinity();
  double m_lastCompany = 0;  // when a player was there last, s
  Stage m_stage = Stage::kStarting;
  std::vector<std::uint32_t> m_players;  // whose joining has been called, sorted
  std::vector<std::uint32_t> m_present;  // scratch: the players of this turn, sorted
};

}  // namespace wobble::ops
