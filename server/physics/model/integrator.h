// The names of the methods that step a body. The largest stable step of each: methods/step_limits.h.
#pragma once

#include <cstdint>

namespace wobble::physics {

enum class Integrator : std::uint8_t {
  kRungeKutta4,  // the default; runge_kutta.h
  kExplicitEuler,
  kSemiImplicitEuler,
  kVelocityVerlet,
  kLeapFrog,
  kPositionVerlet,  // springs as distances to be kept, by relaxation; position_verlet.h
  kImplicitEuler,   // implicit_euler.h
};

}  // namespace wobble::physics
