// What a player asks for beyond moving about, once the wire's words have become the engine's (session.h).
#pragma once

#include <cstdint>
#include <variant>

#include "server/physics/step/body.h"

namespace wobble::server {

using ClientId = std::uint32_t;

// The vertices round one of a body's, drawn to where that one is to be, m. grip: another number for each time that the
// hand closes, never 0.
struct HandCommand {
  physics::BodyId body = 0;
  std::uint16_t vertex = 0;
  std::uint16_t grip = 0;
  physics::Vector3d target = physics::Vector3d::Zero();
};

struct ShoveCommand {
  physics::BodyId body = 0;
  std::uint16_t vertex = 0;
  physics::Vector3d direction = physics::Vector3d::Zero();  // of any length
};

// Of the springs of a body that pass through a triangle, m.
struct CutCommand {
  physics::BodyId body = 0;
  physics::Vector3d eye, from, to;
};

struct InspectCommand {
  physics::BodyId body = 0;  // 0: none
};

struct TuneCommand {
  enum class Kind { kGravity, kStiffness, kTimeRate, kJump };
  Kind kind = Kind::kGravity;
  physics::Vector3d value = physics::Vector3d::Zero();  // m/s²; of the others the first: a factor, a rate, s
};

// Of the workshop's body. a, b: numbers of particles or springs. Which fields count is said in messages.fbs.
struct BuildCommand {
  enum class Kind { kAddParticle, kAddSpring, kSetParticle, kSetSpring, kRemoveParticle, kRemoveSpring };
  Kind kind = Kind::kAddParticle;
  std::uint16_t a = 0;
  std::uint16_t b = 0;
  physics::Vector3d at = physics::Vector3d::Zero();  // m
  double mass = 1;                                   // kg
  bool fixed = false;
  double stiffness = 100;  // N/m
  double damping = 1;      // N·s/m
  double restLength = 0;   // m; 0: as far as its ends are apart
};

using Command = std::variant<ShoveCommand, CutCommand, InspectCommand, TuneCommand, BuildCommand>;

}  // namespace wobble::server
