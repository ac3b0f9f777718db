// The rules of sumo: push the others off. A player who falls gives a point to the player who touched them last. The
// first with enough points, or the one with the most when the time is up, wins the round. The class knows players by
// number only.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "server/play/command.h"
#include "server/scenes/play_rules.h"

namespace wobble::server {

class Sumo {
 public:
  // kPlaying -> kWon when a player has enough points or the time is up; kWon -> kPlaying, the next round, after 8 s.
  // While fewer than two play, the time of the round starts anew.
  enum class Phase : std::uint8_t { kPlaying, kWon };
  struct Standing {
    ClientId client = 0;
    int points = 0;  // in this round
    int rounds = 0;  // won
  };

  struct Wrestler {
    Standing standing;
    ClientId touchedBy = 0;  // last; 0: nobody
    double touchedAt = 0;    // as Memory::now, s
  };
  // All that it remembers, to be stored.
  struct Memory {
    std::map<ClientId, Wrestler> wrestlers;
    Phase phase = Phase::kPlaying;
    int round = 1;
    double secondsLeft = 0;
    double now = 0;  // s since the game began
    ClientId winner = 0;
    std::uint64_t revision = 0;
  };

  explicit Sumo(const scenes::GameRules& rules) : m_rules(rules) { m_memory.secondsLeft = rules.roundSeconds; }
  [[nodiscard]] const Memory& Read() const { return m_memory; }
  void Write(const Memory& memory) { m_memory = memory; }

  void Enter(ClientId client);
  void Leave(ClientId client);
  // Notes that two players touch now.
  void NoteTouch(ClientId a, ClientId b);
  // Scores a fall. Returns the player who gets the point; 0: no touch within the last 6 s, or no round is played.
  ClientId NoteFall(ClientId fallen);
  // Lets time pass, s.
  void Advance(double seconds);

  [[nodiscard]] Phase ReadPhase() const { return m_memory.phase; }
  [[nodiscard]] int Round() const { return m_memory.round; }  // from 1
  [[nodiscard]] double SecondsLeft() const { return m_memory.secondsLeft; }
  [[nodiscard]] ClientId Winner() const {
    return m_memory.winner;
  }                                                       // of the last round; 0: a draw, or no round has ended
  [[nodiscard]] std::vector<Standing> Standings() const;  // the best first
  // Grows whenever one of the above except the time changes.
  [[nodiscard]] std::uint64_t Revision() const { return m_memory.revision; }

 private:
  void EndRound();
  void BeginRound();

  scenes::GameRules m_rules;
  Memory m_memory;
};

}  // namespace wobble::server
