// The hands of players: what they hold and shove, turned into forces on vertices.
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

// A player, with the body that the hands belong to.
struct Actor {
  ClientId client = 0;
  physics::BodyId body = 0;  // 0: a spectator, without hands
};

class Hands {
 public:
  // Holds `vertices` until it slips; without vertices it is open.
  struct Grip {
    HandCommand command;
    physics::BodyId own = 0;
    std::vector<std::uint16_t> vertices;     // ascending
    std::vector<physics::Vector3d> offsets;  // of each vertex from the gripped one when the hand closed, m
  };
  struct Shove {
    ShoveCommand command;
    physics::BodyId own = 0;
    std::vector<std::uint16_t> vertices;
    int ticksLeft = 0;    // in which it acts
    int ticksToRest = 0;  // until the next one may begin
  };

  // All that they remember, to be stored.
  struct Memory {
    std::map<ClientId, Grip> grips;
    std::map<ClientId, Shove> shoves;
  };

  // tickDuration: s.
  Hands(const scenes::HandRules& rules, double tickDuration) : m_rules(rules), m_tickDuration(tickDuration) {}

  // Sets what the player holds from now on; nullopt: nothing. Call it every tick. A grip that the scene forbids or that
  // is out of reach holds nothing, and one that was refused or has slipped stays open until the hand closes anew
  // (HandCommand::grip).
  void Hold(const Actor& actor, const std::optional<HandCommand>& command, const physics::World& world);
  // Starts a shove that acts for 0.1 s; ignored within 0.3 s of the player's last one. Returns the reason of a refusal,
  // to be shown to the player; empty when there is nothing to say, as for commands that no honest client sends.
  [[nodiscard]] std::string StartShove(const Actor& actor, const ShoveCommand& command, const physics::World& world);
  // The blade of a cut that the player may make; nullopt otherwise, with a reason in `refusal` as above.
  [[nodiscard]] std::optional<physics::Blade> FindBlade(const Actor& actor, const CutCommand& command,
                                                        const physics::World& world, std::string& refusal) const;

  // Drops the hands of a client that has left.
  void Forget(ClientId client);
  // What the client's hand holds is drawn to its rest shape, upright.
  void Right(ClientId client, const physics::World& world);
  // Opens a client's hand, until it closes anew.
  void Open(ClientId client);
  // Ends all grips and shoves on a body whose vertices have been renumbered.
  void LetGo(physics::BodyId body);

  [[nodiscard]] const Memory& Read() const { return m_memory; }
  // Goes on with what hands in this world remembered. Any memory is safe; returns false for one that cannot be of this
  // world.
  [[nodiscard]] bool Write(const Memory& memory, const physics::World& world);

  // Gives the world the forces of the next step. Call it once a tick, before World::Step.
  void Act(physics::World& world);

 private:
  // Whether the place is within `reach`, m, of the centre of the body `own`. A reach of 0 is unlimited.
  [[nodiscard]] static bool IsWithin(double reach, physics::BodyId own, const physics::Vector3d& place,
                                     const physics::World& world);
  // Chooses the vertices of a grip.
  void Close(const Actor& actor, Grip& grip, const physics::World& world) const;
  void Drag(Grip& grip, physics::World& world);
  void Deal(Shove& shove, physics::World& world);
  // Applies the reaction to the owner of the hand.
  void PushBack(physics::BodyId own, const physics::Vector3d& force, physics::World& world);

  scenes::HandRules m_rules;
  double m_tickDuration;
  Memory m_memory;
  std::vector<physics::VertexForce<double>> m_forces;  // scratch
};

}  // namespace wobble::server
