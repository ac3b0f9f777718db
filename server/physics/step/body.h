// A body of the world: its state, and what a player asks of it.
//
// The room step/ plays one tick of bodies: what acts on them, how many substeps the tick takes, the integration in
// plain code (that in lanes is in packs/), whether the result is sound, and which bodies may sleep. Which bodies are
// stepped together is for World to decide.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>

#include "server/physics/methods/substeps_for_error.h"
#include "server/physics/model/state.h"

namespace wobble::physics {

// Counts from 1 in order of creation; never reused. 0: no body.
using BodyId = std::uint32_t;

// What a player asks of a body. Holds until the next World::SetControl. (moveX, moveY): direction in the horizontal
// plane; its length, at most 1, is the share of ControlLimits::speed that is asked for.
struct Control {
  double moveX = 0;
  double moveY = 0;
  bool jump = false;     // acts once, in the tick in which it turns true, if the body touches something
  bool puff = false;     // more gas, by ControlLimits::puffFactor
  bool stiffen = false;  // stiffer springs, by ControlLimits::stiffenFactor

  bool operator==(const Control&) const = default;

  // What a world bears; the length of a unit vector may be rounded above 1.
  [[nodiscard]] bool IsPossible() const { return moveX * moveX + moveY * moveY <= 1.0001; }
};

// How far a control may go; the scene says.
struct ControlLimits {
  double acceleration = 25;  // of moving, at most, m/s²
  double speed = 6;          // of the body's centre that moving alone reaches, m/s
  double jumpSpeed = 6;      // upward, added to every vertex, m/s
  double puffFactor = 1.6;   // times the gas while the body puffs
  double stiffenFactor = 2;  // times springs and dashpots while the body stiffens

  bool operator==(const ControlLimits&) const = default;
};

// The factor on the springs of a body: the player's times the world's. The world's factor may not raise the product
// above `bound`; the player's factor alone may, since the scene sets it.
struct StiffnessRule {
  double ofWorld = 1;
  double bound = 1;  // at least 1

  // stiffened: the player's factor, 1 or ControlLimits::stiffenFactor.
  [[nodiscard]] double Find(double stiffened) const {
    return std::min(stiffened * ofWorld, std::max(stiffened, bound));
  }
};

struct Body {
  BodyId id = 0;
  std::uint8_t blueprint = 0;  // index in World::Blueprints()
  std::variant<State<float>, State<double>> state;
  Control control;
  ControlLimits limits;
  bool jumpHeld = false;       // control.jump of the last tick
  bool touchesBody = false;    // another one, at the end of the last tick
  double gasFactor = 1;        // follows the control within a few ticks
  double stiffnessFactor = 1;  // likewise
  StepHistory steps;
  // How much nearer to one another any two parts that meet may come before they can touch, m, as far as is known, and
  // Survey::agitation at the last look. A body whose state was set has 0.
  double selfRoom = 0;
  double selfAgitation = 0;
  bool asleep = false;    // neither stepped nor searched for contacts until something wakes it
  int quietTicks = 0;     // in a row so far (sleep.h)
  int invertedTicks = 0;  // in a row so far that ended with the body inside out
  int lostTicks = 0;      // in a row so far that began with its shape lost; while above 0, each tick looks again
  int tornTicks = 0;      // since a spring tore that its blueprint still has; 0: none has
};

// Calls visit(index, position) for every vertex of the body, in order; position: in the world, m.
template <class Visit>
void VisitVertices(const Body& body, Visit&& visit) {
  std::visit(
      [&](const auto& state) {
        for (std::size_t i = 0; i < state.positions.size(); ++i) {
          visit(i, Vector3d(state.origin + state.positions[i].template cast<double>()));
        }
      },
      body.state);
}

}  // namespace wobble::physics
