// The explicit methods of order one and two. Each takes accelerate(x, v, a), which fills in a, m/s², from positions and
// velocities, as StepRungeKutta does. Each leaves x and v at the same moment, so that any method can follow any other.
//
// Forces that depend on velocity (dashpots, friction, drag) use the last velocity known, as is usual for each method.
// This makes the two methods of order 2 methods of order 1 where there is damping. A predicted velocity would keep the
// order, but the method would no longer be what the literature calls Verlet. No method keeps accelerations from one
// step to the next: between two steps anchors are dragged, loads change and bodies meet, so the kept accelerations
// would belong to other forces.
#pragma once

#include <span>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

template <class Real>
using AccelerationBuffers = StageBuffers<Real, 4>;  // the same as RK4's, so that one scratch serves all methods

// x' = x + h v, v' = v + h a(x, v). Order 1. Not for use; the laboratory shows the other methods beside it.
template <class Real, class Accelerate>
void StepExplicitEuler(Real h, Accelerate&& accelerate, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v,
                       AccelerationBuffers<Real>& buffers) {
  buffers.Resize(x.size());
  const std::span<Vector3<Real>> a(buffers.accelerations[0]);
  accelerate(std::span<const Vector3<Real>>(x), std::span<const Vector3<Real>>(v), a);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] += h * v[i];
    v[i] += h * a[i];
  }
}

// v' = v + h a(x, v), x' = x + h v' (symplectic Euler). Order 1, energy bounded.
template <class Real, class Accelerate>
void StepSemiImplicitEuler(Real h, Accelerate&& accelerate, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v,
                           AccelerationBuffers<Real>& buffers) {
  buffers.Resize(x.size());
  const std::span<Vector3<Real>> a(buffers.accelerations[0]);
  accelerate(std::span<const Vector3<Real>>(x), std::span<const Vector3<Real>>(v), a);
  for (std::size_t i = 0; i < x.size(); ++i) {
    v[i] += h * a[i];
    x[i] += h * v[i];
  }
}

// Kick half, drift, kick half (Swope et al. 1982): v½ = v + h/2 a(x, v), x' = x + h v½, v' = v½ + h/2 a(x', v½).
template <class Real, class Accelerate>
void StepVelocityVerlet(Real h, Accelerate&& accelerate, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v,
                        AccelerationBuffers<Real>& buffers) {
  buffers.Resize(x.size());
  const std::span<Vector3<Real>> a(buffers.accelerations[0]);
  const Real half = h / Real(2);
  accelerate(std::span<const Vector3<Real>>(x), std::span<const Vector3<Real>>(v), a);
  for (std::size_t i = 0; i < x.size(); ++i) {
    v[i] += half * a[i];
    x[i] += h * v[i];
  }
  accelerate(std::span<const Vector3<Real>>(x), std::span<const Vector3<Real>>(v), a);
  for (std::size_t i = 0; i < x.size(); ++i) v[i] += half * a[i];
}

// Drift half, kick, drift half: x½ = x + h/2 v, v' = v + h a(x½, v), x' = x½ + h/2 v'. From half step to half step the
// positions leap over the velocities; one evaluation a step, where velocity Verlet has two.
template <class Real, class Accelerate>
void StepLeapFrog(Real h, Accelerate&& accelerate, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v,
                  AccelerationBuffers<Real>& buffers) {
  buffers.Resize(x.size());
  const std::span<Vector3<Real>> a(buffers.accelerations[0]);
  const Real half = h / Real(2);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += half * v[i];
  accelerate(std::span<const Vector3<Real>>(x), std::span<const Vector3<Real>>(v), a);
  for (std::size_t i = 0; i < x.size(); ++i) {
    v[i] += h * a[i];
    x[i] += half * v[i];
  }
}

}  // namespace wobble::physics
