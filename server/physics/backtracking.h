// Contact as an event: a vertex that a substep has carried through a surface is put back.
//
// The moment of crossing is where the cubic through x and v at both ends of the substep (Hermite, as dense as RK4 is
// accurate) meets the surface. There the normal velocity turns round times the restitution, Coulomb's impulse μ Δv_n
// slows the slip, and the rest of the substep is flown with its mean acceleration.
//
// A vertex that lies on a surface crosses it in every substep, at a speed that the substep itself gave it. It would
// bounce for ever in ever smaller hops; slower than kRestingSteps such substeps make it, it stays on the surface
// instead, and what was taken from its normal velocity is the impulse that bounds friction. Half of the velocity that
// friction takes over a substep is taken from the way as well: without that a body that sticks creeps downhill by
// ½ g sin α h² each substep, and a slide ends v h/2 late.
//
// Putting vertices back breaks the smoothness that gives RK4 its order: after a touch it is one of order 1.
#pragma once

#include <span>

#include "server/physics/blueprint.h"
#include "server/physics/contact.h"
#include "server/physics/obstacle.h"
#include "server/physics/vector.h"

namespace wobble::physics {

// A vertex may be thrown off its way by springs in the tick that it was not seen coming; those within this are looked
// at, m.
inline constexpr double kBacktrackingRange = 0.1;

// After a substep of h s from x0, v0 to x, v of one body: puts its vertices back and says which contacts touch. No
// vertex that is listed is left below a surface by more than rounding, where it can be above all of them.
template <class Real>
void PutBack(const Coefficients<Real>& body, Real h, std::span<const Surface<Real>> surfaces,
             std::span<const Vector3<Real>> x0, std::span<const Vector3<Real>> v0, std::span<Contact<Real>> contacts,
             std::span<Vector3<Real>> x, std::span<Vector3<Real>> v);

}  // namespace wobble::physics
