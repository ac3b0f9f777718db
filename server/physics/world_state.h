// All of a world that its next ticks depend on and that its scene and settings do not say, as plain data: what is
// stored, sent on, and gone back to.
//
// Beside positions and velocities the next tick depends on what contacts remember (anchors, slips, sides), on the
// substeps that a body has learnt to take, on what is left of its room to meet itself, on torn springs and the
// blueprints that came of them, and on how a sleeping body lay when it was looked at last. World::Capture and
// World::Restore keep all of it to the bit.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "server/physics/body_pair.h"
#include "server/physics/world.h"

namespace wobble::physics {

// A sleeping body as its last tick awake left it: a search looks at it without preparing it.
struct SleeperState {
  Box box;                           // in world coordinates, m
  Vector3d low = Vector3d::Zero();   // Survey::bounds, local, m
  Vector3d high = Vector3d::Zero();  // m
  double speed = 0;                  // m/s
  double agitation = 0;              // Survey::agitation, m/s
};

// A slot that the scene did not fill.
struct SlotState {
  std::uint32_t age = 0;  // 1: the oldest, which is taken first
  BlueprintRecipe recipe;
};

template <class Real>
struct PairsState {
  std::vector<BodyPair<Real>> awake;    // ascending
  std::vector<BodyPair<Real>> resting;  // of bodies that fell asleep together
};

struct WorldState {
  std::uint32_t tick = 0;
  Vector3d gravity = Vector3d::Zero();  // m/s²
  double stiffnessFactor = 1;
  BodyId nextId = 1;
  std::vector<SlotState> slots;        // behind the scene's
  std::vector<Body> bodies;            // by ascending id
  std::vector<SleeperState> sleepers;  // of the bodies asleep, in their order
  std::vector<BodyId> tearing;         // ascending
  std::vector<Drive> drives;
  std::vector<StepForce> stepForces;                          // by ascending body
  std::variant<PairsState<float>, PairsState<double>> pairs;  // in the world's precision
};

// What the engine, which trusts its own state, cannot bear of a state for this world: one thing, by the name of its
// field, its value and what it must be; empty: nothing. Not finite positions and velocities are borne.
[[nodiscard]] std::string FindUnsound(const WorldState& state, const World& world,
                                      std::span<const Blueprint* const> blueprints);

}  // namespace wobble::physics
