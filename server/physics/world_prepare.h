// The first phase of a tick: what acts on each body through the tick, and which static surfaces it may touch.
#pragma once

#include <span>
#include <vector>

#include "server/physics/contact/broad_phase.h"
#include "server/physics/step/island_step.h"
#include "server/physics/world.h"

namespace wobble::physics {

// What acts on the bodies of a world through one tick.
struct Surroundings {
  const WorldSettings& settings;
  std::span<const Obstacle> obstacles;
  std::span<const Drive> drives;
  std::span<const StepForce> stepForces;  // by ascending body
  std::uint32_t tick = 0;                 // counts from 1
  double time = 0;                        // at which the tick begins, since the world's first tick, s
};

// The forces on this body.
[[nodiscard]] std::span<const StepForce> FindForcesOn(BodyId body, std::span<const StepForce> stepForces);

// Fills in the member of an awake body for a tick: load, static contacts, survey, what it demands of the substeps.
// Applies a jump and the losses of this tick to the body's state and lists its contacts there. Bodies can be prepared
// in parallel, each thread with a scratch of its own.
template <class Real>
void PrepareMember(const Surroundings& surroundings, const Blueprint& blueprint, const StiffnessRule& stiffness,
                   Body& body, PrepareScratch<Real>& scratch, Member<Real>& member);

// The box round a prepared body, the way that it goes in `duration` s at its present speed, and a margin; without the
// way if no step could find what the body meets on it.
template <class Real>
[[nodiscard]] Box FindTickBox(const Member<Real>& member, double duration);

}  // namespace wobble::physics
