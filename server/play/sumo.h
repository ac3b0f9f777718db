// The rules of sumo: push the others off. Who falls gives a point to the player who touched him last; the first with
// enough of them, or the one with most when the time is up, has won the round. Knows players by number and nothing of
// how they move.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "server/play/command.h"
#include "server/scenes/play_rules.h"

namespace wobble::server {

class Sumo {
 public:
  enum class Phase { kPlaying, kWon };
  struct Standing {
    ClientId client = 0;
    int points = 0;  // in this round
    int rounds = 0;  // won
  };

  explicit Sumo(const scenes::GameRules& rules) : m_rules(rules), m_secondsLeft(rules.roundSeconds) {}

  void Enter(ClientId client);
  void Leave(ClientId client);
  // They touch one another now.
  void NoteTouch(ClientId a, ClientId b);
  // Who gets the point; 0: nobody has touched him lately, or no round is being played.
  ClientId NoteFall(ClientId fallen);
  // Time goes on, s. A round begins when there are two to play it.
  void Advance(double seconds);

  [[nodiscard]] Phase ReadPhase() const { return m_phase; }
  [[nodiscard]] int Round() const { return m_round; }  // from 1
  [[nodiscard]] double SecondsLeft() const { return m_secondsLeft; }
  [[nodiscard]] ClientId Winner() const { return m_winner; }  // of the last round; 0: a draw, or none has ended
  [[nodiscard]] std::vector<Standing> Standings() const;      // the best first
  // Grows whenever any of these changes, but for the time.
  [[nodiscard]] std::uint64_t Revision() const { return m_revision; }

 private:
  struct Wrestler {
    Standing standing;
    ClientId touchedBy = 0;
    double touchedAt = 0;  // s of m_now
  };
  void EndRound();
  void BeginRound();

  scenes::GameRules m_rules;
  std::map<ClientId, Wrestler> m_wrestlers;
  Phase m_phase = Phase::kPlaying;
  int m_round = 1;
  double m_secondsLeft;
  double m_now = 0;  // s since the game began
  ClientId m_winner = 0;
  std::uint64_t m_revision = 0;
};

}  // namespace wobble::server
