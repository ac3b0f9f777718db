// What all games have in common: players and sides, the lobby, rounds, points, and the final board. A match knows
// players by number only; sumo.h, goals.h and crown.h say when a point is scored.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "server/play/command.h"
#include "server/scenes/play_rules.h"

namespace wobble::server {

class Match {
 public:
  // kLobby:   players practise. -> kKickOff or kPlaying when all are ready, or the time is up; only in scenes with a
  //           lobby.
  // kKickOff: all are back at their places and may not move. -> kPlaying, kGolden.
  // kPlaying: points count. -> kWon, kOver when somebody has enough points or the time is up; -> kKickOff after a goal;
  //           -> kGolden, through kKickOff where there are sides, when the time is up and nobody leads.
  // kGolden:  the next point wins. -> kWon, kOver with it, or without a winner when the time is up.
  // kWon:     the round is over. -> kKickOff or kPlaying, the next round.
  // kOver:    the last round of the match is over, and this is the final board. -> kLobby, kKickOff or kPlaying.
  // With fewer players than the game needs kKickOff, kPlaying and kGolden go back to kLobby; without a lobby the time
  // of the round starts anew as long as that is so.
  enum class Phase : std::uint8_t { kLobby, kKickOff, kPlaying, kGolden, kWon, kOver };

  struct Standing {
    ClientId client = 0;
    int side = 0;    // 1 or 2; 0: the game has none
    int points = 0;  // in this round
    int rounds = 0;  // won
    bool isReady = false;
    bool isBot = false;
  };
  struct Side {
    int points = 0;  // in this round
    int rounds = 0;  // won
  };
  // All that it remembers, to be stored.
  struct Memory {
    std::map<ClientId, Standing> players;
    std::array<Side, 2> sides{};
    Phase phase = Phase::kPlaying;
    int round = 1;
    int rounds = 0;          // that make a match; 0: it never ends
    int matches = 0;         // that have been played to their end
    double secondsLeft = 0;  // of the phase
    double playLeft = 0;     // of the round's regular time, s
    double now = 0;          // s since the game began
    ClientId winner = 0;
    int winningSide = 0;
    bool places = false;
    std::uint64_t revision = 0;
  };

  explicit Match(const scenes::GameRules& rules);
  [[nodiscard]] const Memory& Read() const { return m_memory; }
  // Any memory is safe; returns false for one that cannot be of a game with these rules.
  [[nodiscard]] bool Write(const Memory& memory);

  // A player comes in, on the side that needs them more. The first person to come into a match of bots begins it anew:
  // what bots have won among themselves does not count.
  void Enter(ClientId client, bool isBot);
  void Leave(ClientId client);
  // False: there is no such player.
  bool SetReady(ClientId client, bool isReady);
  // rounds: as Memory::rounds.
  void SetRounds(int rounds) { m_memory.rounds = rounds; }
  // Back to the beginning, with the players who are in.
  void BeginAnew();
  // The same, and no match has been played yet.
  void Restart() {
    m_memory.matches = 0;
    BeginAnew();
  }
  // Lets time pass, s.
  void Advance(double seconds);

  // Whether points count now.
  [[nodiscard]] bool IsCounting() const {
    return m_memory.phase == Phase::kPlaying || m_memory.phase == Phase::kGolden;
  }
  [[nodiscard]] bool MayMove() const { return m_memory.phase != Phase::kKickOff; }
  // A point for a player, or for a side, whose player `client` has then scored it; client may be 0 there. Only while
  // IsCounting.
  void Score(ClientId client, int side = 0);
  // Whether all are to be put back to their places; true once each time.
  [[nodiscard]] bool TakePlacing();

  [[nodiscard]] Phase ReadPhase() const { return m_memory.phase; }
  [[nodiscard]] int Round() const { return m_memory.round; }  // from 1
  [[nodiscard]] double SecondsLeft() const { return m_memory.secondsLeft; }
  // Of the last round, in kOver of the match; 0: a draw, a side, or none has ended.
  [[nodiscard]] ClientId Winner() const { return m_memory.winner; }
  [[nodiscard]] int WinningSide() const { return m_memory.winningSide; }
  [[nodiscard]] std::vector<Standing> Standings() const;  // the best first
  // Null: is not in.
  [[nodiscard]] const Standing* Find(ClientId client) const;
  // Grows whenever one of the above except the time changes.
  [[nodiscard]] std::uint64_t Revision() const { return m_memory.revision; }

 private:
  [[nodiscard]] int CountOn(int side) const;
  [[nodiscard]] bool IsEnough() const;
  [[nodiscard]] bool AreAllReady() const;
  [[nodiscard]] bool IsDraw() const;
  void Balance();
  void Wait();
  void GoTo(Phase phase, double seconds);
  void BeginRound();
  void KickOff();
  void EndTime();
  void EndRound();
  void NameWinner(bool isOfMatch);

  scenes::GameRules m_rules;
  Memory m_memory;
};

}  // namespace wobble::server
