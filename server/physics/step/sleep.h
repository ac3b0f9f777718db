// When a body falls asleep, and what that means for it.
//
// Bodies that hang together by contacts fall asleep together: one alone would be a wall to those that rest on it. They
// wake together as well, by what touches any of them.
#pragma once

#include "server/physics/step/body.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// Slower than this and changing its speed by less for so long, a body is at rest. RMS over vertices, so that a corner
// that trembles does not keep it awake. Creep at the limit would be a centimetre a second.
inline constexpr double kQuietSpeed = 0.01;         // m/s
inline constexpr double kQuietAcceleration = 0.05;  // m/s²
inline constexpr double kQuietTime = 0.5;           // s

inline void WakeUp(Body& body) {
  body.asleep = false;
  body.quietTicks = 0;
}

// Nothing is asked of it that would move it. restingStiffness: what its stiffness factor is on its way to then.
[[nodiscard]] bool IsLeftAlone(const Body& body, double restingStiffness);

// Counts the ticks that the body has been quiet for.
template <class Real>
void NoteMotion(const Member<Real>& member, double restingStiffness, Body& body);

// Stops every vertex: what was left of its motion is not to come back when it wakes.
template <class Real>
void FallAsleep(Body& body, State<Real>& state);

}  // namespace wobble::physics
