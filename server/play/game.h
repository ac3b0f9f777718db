// The game of a scene: a match (match.h) and its rules, joined to the world in which it is played.
#pragma once

#include <map>
#include <optional>
#include <variant>
#include <vector>

#include "server/physics/world.h"
#include "server/play/crown.h"
#include "server/play/goals.h"
#include "server/play/hands.h"
#include "server/play/match.h"
#include "server/play/sumo.h"
#include "server/scenes/scene.h"

namespace wobble::server {

// What clients are to be told of.
struct Happening {
  enum class Kind : std::uint8_t {
    kFall,     // of a player's body, in a game
    kRespawn,  // of any body
    kGoal,     // of the ball
    kCrown,    // of the crown
  };
  Kind kind = Kind::kRespawn;
  physics::BodyId body = 0;
  ClientId by = 0;  // kFall, kGoal: who gets the point; 0: nobody. kCrown: who wears it now
};

class Game {
 public:
  // object: the ball or the crown; 0: the game has none.
  Game(const scenes::GameRules& rules, physics::BodyId object);

  using Rules = std::variant<Sumo, Goals, Crown>;
  struct Memory {
    Match::Memory match;
    Rules rules;
  };
  [[nodiscard]] Memory Read() const { return {m_match.Read(), m_laws}; }
  // Any memory is safe; returns false for one that cannot be of this game.
  [[nodiscard]] bool Write(const Memory& memory);

  [[nodiscard]] const Match& ReadMatch() const { return m_match; }
  [[nodiscard]] physics::BodyId Object() const { return m_object; }
  // Who wears the crown; 0: nobody, or there is none.
  [[nodiscard]] ClientId Bearer() const;

  void Enter(ClientId client, bool isBot) { m_match.Enter(client, isBot); }
  void Leave(ClientId client);
  void SetReady(ClientId client, bool isReady) { m_match.SetReady(client, isReady); }
  void SetRounds(int rounds) { m_match.SetRounds(rounds); }
  // The world begins anew, with all bodies at their places.
  void BeginAnew();

  // What a player's body and hand are to do in the next tick, and where it starts.
  [[nodiscard]] physics::Control FindControl(const physics::Control& control) const;
  [[nodiscard]] physics::ControlLimits FindLimits(ClientId client, const physics::ControlLimits& limits) const;
  [[nodiscard]] std::optional<HandCommand> FindHand(const Actor& actor, const std::optional<HandCommand>& hand,
                                                    const physics::World& world) const;
  [[nodiscard]] scenes::PlayerRules FindPlaces(ClientId client, const scenes::PlayerRules& player) const;

  // A player has fallen. Returns who gets a point for it; 0: nobody.
  ClientId NoteFall(ClientId client);
  // Follows a tick. Adds what is to be told. Returns whether all bodies of players and the object are to be put back.
  [[nodiscard]] bool Follow(const physics::World& world, const std::map<physics::BodyId, ClientId>& players,
                            Hands& hands, std::vector<Happening>& happenings);

 private:
  using Players = std::map<physics::BodyId, ClientId>;
  void FollowSumo(Sumo& sumo, const physics::World& world, const Players& players);
  void FollowGoals(Goals& goals, const physics::World& world, const Players& players, const Hands& hands,
                   std::vector<Happening>& happenings);
  void FollowCrown(Crown& crown, const physics::World& world, const Players& players, Hands& hands,
                   std::vector<Happening>& happenings);

  scenes::GameRules m_rules;
  physics::BodyId m_object;
  Match m_match;
  Rules m_laws;
};

}  // namespace wobble::server
