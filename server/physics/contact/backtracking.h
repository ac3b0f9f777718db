// Contact as an event: a vertex that a substep has carried through a surface is put back.
//
// The moment of crossing is where the cubic through x and v at both ends of the substep (Hermite, as dense as RK4 is
// accurate) meets the surface. There the normal velocity turns round times the restitution, Coulomb's impulse μ Δv_n
// slows the slip, and the rest of the substep is flown with its mean acceleration.
//
// A vertex that lies on a surface would cross it in every substep, at a speed that the substep itself gave it, and hop
// for ever. Slower than kRestingSteps such substeps make it, it stays on the surface; from then on the surface takes
// what accelerates it inward, and friction what accelerates it along, up to μ times that: it is held within the
// substep, where to be put back after each would let a cube creep downhill at millimetres a second.
//
// A touch breaks the smoothness that gives RK4 its order: through one it is a method of order 1.
#pragma once

#include <span>

#include "server/physics/contact/contact.h"
#include "server/physics/contact/obstacle.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// A vertex may be thrown off its way by springs in the tick that it was not seen coming; those within this are looked
// at, m.
inline constexpr double kBacktrackingRange = 0.1;

// Takes from the accelerations of vertices that lie on a surface what the surface and friction on it withstand.
template <class Real>
void HoldResting(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                 std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                 std::span<Vector3<Real>> accelerations);

// After a substep of h s from x0, v0 to x, v of one body: puts its vertices back and says which contacts touch: those
// that lie, not those that bounce. No
// vertex that is listed is left below a surface by more than rounding, where it can be above all of them.
template <class Real>
void PutBack(const Coefficients<Real>& body, Real h, std::span<const Surface<Real>> surfaces,
             std::span<const Vector3<Real>> x0, std::span<const Vector3<Real>> v0, std::span<Contact<Real>> contacts,
             std::span<Vector3<Real>> x, std::span<Vector3<Real>> v);

}  // namespace wobble::physics
