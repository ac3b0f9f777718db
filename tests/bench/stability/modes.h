// The theory against which measured limits are checked: a body near rest as a linear system, and the step at which the
// first of its motions grows under each method.
//
// Near rest x'' = −K x − C x', with K and C symmetric once coordinates are weighted by the roots of the masses. Gas
// stiffens a body without damping it, so K and C have no modes in common and the body is not a set of independent
// oscillators. Yet each motion of the stepped body is one: let x grow by μ per step and multiply the method's equation
// by x* from the left; K and C become the two real numbers κ = x*Kx/x*x and γ = x*Cx/x*x. Hence a limit has a
// frequency √κ and a damping ratio γ/2√κ, by which bodies of any kind lie on one line per method (for velocity Verlet,
// whose step contains C², bodies with gas only nearly).
//   Explicit Euler, RK4: μ = R(hλ) over the complex eigenvalues λ of [0 I; −K −C], R(z) = 1 + z and
//     1 + z + z²/2 + z³/6 + z⁴/24 (Hairer & Wanner, Solving ordinary differential equations II, IV.2).
//   Semi-implicit Euler, leap-frog: (μ − 1)² + h²κ μ + hγ (μ − 1) = 0, whose roots lie in the unit circle as long as
//     4 − h²κ − 2hγ > 0 (Jury 1964), for all x, that is while 4 − h²K − 2hC is positive definite.
//   Velocity Verlet: with D = 1 − hC/2, μ² x − μ (1 + D² − h²/2 (1 + D) K) x + D² x = 0. Multiplied by (1 + D)⁻¹ all
//     matrices are symmetric: stable while 4 (1 + D)⁻¹(1 + D²) − h²K and 1 + D are positive definite.
// At the first step at which such a matrix is singular, μ = −1 is reached, so these are exact limits and not mere
// bounds.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "server/physics/model/integrator.h"
#include "tests/bench/accuracy/equations.h"

namespace wobble::bench {

struct LinearMotion {
  Eigen::MatrixXd stiffness;                // K, 1/s²
  Eigen::MatrixXd damping;                  // C, 1/s
  std::vector<std::complex<double>> rates;  // λ of e^{λt}, 1/s; without those of rigid motion
};

// K and C at x and v, by central differences of the equations over the free coordinates; `rates` stays empty. They are
// not symmetrised: they are symmetric only where the forces have a potential and v is zero.
[[nodiscard]] LinearMotion Linearise(const Equations& equations, const std::vector<Vector3d>& x,
                                     const std::vector<Vector3d>& v);
// The same at rest, symmetrised, with rates.
[[nodiscard]] LinearMotion LineariseAtRest(const physics::Blueprint& blueprint);

struct StepLimit {
  double step = 0;          // the largest stable step, s; 0: none
  double frequency = 0;     // √κ of the first motion that grows, 1/s
  double dampingRatio = 0;  // γ/2√κ of that motion; 1 is critical
};

// For the five explicit methods. Explicit Euler is unstable at any step on an undamped body: step 0, with the frequency
// of the fastest mode.
[[nodiscard]] StepLimit FindStepLimit(physics::Integrator integrator, const LinearMotion& motion);

}  // namespace wobble::bench
