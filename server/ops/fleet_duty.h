// Decides what a server wishes its fleet manager to know: the state of a turn of the loop goes in, the wish comes out.
//
// The wish is absolute ("allocated, with these players"), never a change: fleet_reconciler.h compares it with what the
// manager says and makes the calls, as often as it takes. A loop that is stuck makes no heartbeats, and that is how the
// fleet notices it.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace wobble::ops {

struct FleetWish {
  // kStarting   no joins yet: nothing is wished
  // kReady      may be given to players
  // kAllocated  players have come: scaling down is not to remove the world
  // kShutdown   the world is over: the cluster is to remove it
  // Only forwards.
  enum class State : std::uint8_t { kStarting, kReady, kAllocated, kShutdown };

  State state = State::kStarting;
  std::vector<std::uint32_t> players = {};  // ids of the clients that have joined, ascending
  std::uint64_t heartbeats = 0;             // so many signs of life have been due; only the last one matters

  bool operator==(const FleetWish&) const = default;
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
  // The wish of this turn; call it once a turn. A heartbeat is due every 2 s; ready when joins are accepted for the
  // first time; allocated with the first player; and shutdown when the match is over, when all players have been gone
  // for 10 s, or when the server closes. After that only heartbeats go on: the cluster ends the server, and one that
  // ended by itself would count as crashed.
  [[nodiscard]] const FleetWish& Follow(const FleetView& view);

 private:
  [[nodiscard]] bool IsDeserted(double now) const;

  double m_nextHeartbeat = -std::numeric_limits<double>::infinity();
  double m_lastCompany = 0;  // when a player was there last, s
  FleetWish m_wish;
};

}  // namespace wobble::ops
