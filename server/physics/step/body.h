// A body of the world: its state, and what a player asks of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>

#include "server/physics/methods/step_choice.h"
#include "server/physics/model/state.h"

namespace wobble::physics {

// From 1, in order of creation, never reused.
using BodyId = std::uint32_t;

// What a player asks of a body, held until the next SetControl. move: in the horizontal plane, x and y, length <= 1.
struct Control {
  double moveX = 0;
  double moveY = 0;
  bool jump = false;  // acts once, when it turns true while the body touches something
  bool puff = false;
  bool stiffen = false;

  bool operator==(const Control&) const = default;
};

// What the scene allows a control to do.
struct ControlLimits {
  double acceleration = 25;  // m/s²
  double speed = 6;          // of the body's centre that moving alone reaches, m/s
  double jumpSpeed = 6;      // m/s
  double puffFactor = 1.6;   // times the gas while puffed up
  double stiffenFactor = 2;  // times springs and dashpots while stiffened

  bool operator==(const ControlLimits&) const = default;
};

// What the springs of a body come to.
struct StiffnessRule {
  double ofWorld = 1;  // the world's factor
  double bound = 1;    // that this factor may take them to, and no further; what a player does is his scene's to say

  // stiffened: the player's factor.
  [[nodiscard]] double Find(double stiffened) const {
    return std::min(stiffened * ofWorld, std::max(stiffened, bound));
  }
};

struct Body {
  BodyId id = 0;
  std::uint8_t blueprint = 0;
  std::variant<State<float>, State<double>> state;
  Control control;
  ControlLimits limits;
  bool jumpHeld = false;
  bool touchesBody = false;  // at the end of the last tick
  double gasFactor = 1;      // follows the control within a few ticks
  double stiffnessFactor = 1;
  StepHistory steps;
  bool asleep = false;  // neither stepped nor looked at until something wakes it
  int quietTicks = 0;   // in a row
  int tornTicks = 0;    // since a spring tore that its blueprint still has; 0: none
};

// visit(index, position) for every vertex in the world, in double precision, m.
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
