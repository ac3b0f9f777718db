// Keeps a body that is shown away from its place out of what is there: obstacles, ground, and the other bodies.
#pragma once

#include <cstdint>
#include <span>

#include "client/client.h"
#include "protocol/geometry.h"
#include "protocol/messages.h"

namespace wobble::client {

// Bodies count as balls of their blueprint's size, metres; obstacles as they are.
struct Surroundings {
  std::span<const wire::Obstacle> obstacles;
  std::span<const Ground> grounds;
  std::span<const BodySample> bodies;  // by their poses; `own` is passed over
  std::uint32_t own = 0;
  float size = 0;  // of the own body
};

// Changes a lead so that the body, shown that far from `place`, is no deeper in anything than it is at `place`: what it
// meets pushes it out by the shortest way, the ground upward.
[[nodiscard]] protocol::Vector3 ClearLead(const Surroundings& surroundings, protocol::Vector3 place,
                                          protocol::Vector3 lead);

}  // namespace wobble::client
