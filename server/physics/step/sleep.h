// When a body falls asleep, and what changes about it then.
//
// The bodies of an island fall asleep together: one that slept alone would be a rigid wall to those that rest on it.
// They wake together as well, when something touches any of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/contact/broad_phase.h"
#include "server/physics/step/body.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// A body is at rest after moving slower than this, RMS over its vertices by mass, for so long: one corner that trembles
// does not keep it awake. What stays below 1 cm/s for half a second round the turning point of a swing of up to 2 s
// swings at no more than 1.5 cm/s. A bound of acceleration as well, 5 cm/s², was rejected: all that it kept awake, for
// 1 to 3 s, were vibrations of less than a millimetre.
inline constexpr double kQuietSpeed = 0.01;  // m/s
inline constexpr double kQuietTime = 0.5;    // s

// Restarts the count of quiet ticks too.
inline void WakeUp(Body& body) {
  body.asleep = false;
  body.quietTicks = 0;
}

// Whether the player asks nothing of the body and its gas and stiffness factors have arrived at 1 and at
// restingStiffness, the factor of a body that its player does not stiffen.
[[nodiscard]] bool IsLeftAlone(const Body& body, double restingStiffness);

// Counts this tick as quiet or begins to count anew, from the member's speed. Call once a tick.
template <class Real>
void NoteMotion(const Member<Real>& member, double restingStiffness, Body& body);

// Lists, ascending, the places in `bodies` of the islands in which every body has been quiet for kQuietTime.
void FindQuietIslands(double tickDuration, const Islands& islands, std::span<const Body> bodies,
                      std::vector<std::uint32_t>& places);

// Marks the body as asleep and stops every vertex, so that the rest of its motion does not return when it wakes. state:
// the body's own.
template <class Real>
void FallAsleep(Body& body, State<Real>& state);

}  // namespace wobble::physics
