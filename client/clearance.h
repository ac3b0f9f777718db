// How far a body may be shown away from its place, by what is there: obstacles, ground, and the other bodies.
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

// Whether a ball at this place touches another body, or nearly.
[[nodiscard]] bool IsTouchingBody(const Surroundings& surroundings, protocol::Vector3 place);

// The part of `lead` that goes no deeper into anything than the body at `place` already is: up to a wall or a body, and
// lifted where ground rises.
[[nodiscard]] protocol::Vector3 LimitLead(const Surroundings& surroundings, protocol::Vector3 place,
                                          protocol::Vector3 lead);

}  // namespace wobble::client
