// Players' hands on bodies: what they hold and what they shove, as forces on vertices.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/physics/world.h"
#include "server/play/command.h"
#include "server/scenes/play_rules.h"

namespace wobble::server {

// A player as others need him here.
struct Actor {
  ClientId client = 0;
  physics::BodyId body = 0;  // 0: a spectator, who has no hands
};

class Hands {
 public:
  // tickDuration: s.
  Hands(const scenes::HandRules& rules, double tickDuration) : m_rules(rules), m_tickDuration(tickDuration) {}

  // What the player holds from now on; nullopt: nothing. What he may not hold, or cannot reach, he does not. A grip
  // that was refused or has slipped stays so until the hand closes anew.
  void Hold(const Actor& actor, const std::optional<HandCommand>& command, const physics::World& world);
  // Why nothing was done, for people; empty when it was, or when an honest client would not have asked.
  [[nodiscard]] std::string StartShove(const Actor& actor, const ShoveCommand& command, const physics::World& world);
  // What the player may cut of the body with. nullopt, with a reason as above, when nothing.
  [[nodiscard]] std::optional<physics::Blade> FindBlade(const Actor& actor, const CutCommand& command,
                                                        const physics::World& world, std::string& refusal) const;

  void Forget(ClientId client);
  // Its vertices are others now: whoever holds it lets go.
  void LetGo(physics::BodyId body);

  // The forces of the next tick. Before World::Step, once a tick.
  void Act(physics::World& world);

 private:
  struct Grip {
    HandCommand command;
    physics::BodyId own = 0;
    std::vector<std::uint16_t> vertices;     // empty: refused, or it has slipped
    std::vector<physics::Vector3d> offsets;  // of each from the one that was gripped, when it was, m
  };
  struct Shove {
    ShoveCommand command;
    physics::BodyId own = 0;
    std::vector<std::uint16_t> vertices;
    int ticksLeft = 0;
    int ticksToRest = 0;  // until the next may come
  };

  // Of the body `own` to this place; a reach of 0 is any.
  [[nodiscard]] static bool IsWithin(double reach, physics::BodyId own, const physics::Vector3d& place,
                                     const physics::World& world);
  void Close(const Actor& actor, Grip& grip, const physics::World& world) const;
  void Drag(Grip& grip, physics::World& world);
  void Deal(Shove& shove, physics::World& world);
  void PushBack(physics::BodyId own, const physics::Vector3d& force, physics::World& world);

  scenes::HandRules m_rules;
  double m_tickDuration;
  std::map<ClientId, Grip> m_grips;
  std::map<ClientId, Shove> m_shoves;
  std::vector<physics::VertexForce<double>> m_forces;  // scratch
};

}  // namespace wobble::server
