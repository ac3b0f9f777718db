// The room server/play holds the rules of what players do beyond moving: hands, tuning, the workshop, games. This file
// holds their commands in the engine's types; session.cpp makes them from messages.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "server/physics/step/body.h"

namespace wobble::server {

using ClientId = std::uint32_t;

// Holds the vertices round one vertex of a body and draws them towards a target.
struct HandCommand {
  physics::BodyId body = 0;
  std::uint16_t vertex = 0;
  std::uint16_t grip = 0;                                // never 0; another number each time that the hand closes
  physics::Vector3d target = physics::Vector3d::Zero();  // where the vertex is to be, m

  bool operator==(const HandCommand&) const = default;
};

// Shoves a body at a vertex; the wire's Push.
struct ShoveCommand {
  physics::BodyId body = 0;
  std::uint16_t vertex = 0;
  physics::Vector3d direction = physics::Vector3d::Zero();  // of any length
};

// Cuts the springs of a body that pass through a triangle.
struct CutCommand {
  physics::BodyId body = 0;
  physics::Vector3d eye, from, to;  // corners of the triangle, m
};

// Asks for the forces on a body.
struct InspectCommand {
  physics::BodyId body = 0;  // 0: none
};

// Changes a quantity that all players feel, or jumps in time.
struct TuneCommand {
  enum class Kind { kGravity, kStiffness, kTimeRate, kJump };
  Kind kind = Kind::kGravity;
  // kGravity: m/s². The others use x alone. kStiffness: a factor. kTimeRate: world seconds per second. kJump: s.
  physics::Vector3d value = physics::Vector3d::Zero();
};

// Changes the workshop's body. Which fields a kind uses is described in messages.fbs.
struct BuildCommand {
  enum class Kind { kAddParticle, kAddSpring, kSetParticle, kSetSpring, kRemoveParticle, kRemoveSpring };
  Kind kind = Kind::kAddParticle;
  std::uint16_t a = 0;  // numbers of particles or springs
  std::uint16_t b = 0;
  physics::Vector3d at = physics::Vector3d::Zero();  // m
  double mass = 1;                                   // kg
  bool fixed = false;
  double stiffness = 100;  // N/m
  double damping = 1;      // N·s/m
  double restLength = 0;   // m; 0: the present distance of its ends
};

// A line to the administration (server/admin).
struct OrderCommand {
  std::string line;
};

// A line for everybody who is in.
struct SayCommand {
  std::string text;
};

// A sign over the player's body, of those that the wire's EmoteKind names.
struct EmoteCommand {
  std::uint8_t kind = 0;
};

// Another name.
struct RenameCommand {
  std::string name;
};

// What players tell one another; the world does not feel it.
using TalkCommand = std::variant<SayCommand, EmoteCommand, RenameCommand>;

using Command =
    std::variant<ShoveCommand, CutCommand, InspectCommand, TuneCommand, BuildCommand, OrderCommand, TalkCommand>;

}  // namespace wobble::server
