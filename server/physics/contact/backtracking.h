// The backtracking law, contact as an event: a vertex that a substep has carried through a surface is put back.
//
// The moment of crossing is where the cubic through x and v at both ends of the substep (Hermite, as dense as RK4 is
// accurate) meets the surface. There the normal velocity is reversed and multiplied by the restitution, Coulomb's
// impulse μ Δv_n slows the slip, and the vertex flies on for the rest of the substep with its mean acceleration.
//
// A vertex that lies on a surface would cross it in every substep, at a speed that the substep itself gave it, and hop
// for ever. A vertex that is slower than kRestingSteps such substeps make it stays on the surface. From then on the
// surface takes the inward part of its acceleration, and friction the part along the surface, up to μ times that: the
// vertex is held within the substep. Putting it back after each substep instead let a cube creep downhill at
// millimetres a second.
//
// A touch breaks the smoothness that gives RK4 its order: through a touch RK4 is a method of order 1.
#pragma once

#include <span>

#include "server/physics/contact/contact.h"
#include "server/physics/contact/obstacle.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// Vertices within this distance of a surface are looked at, m: springs may throw a vertex off its way within the tick.
inline constexpr double kBacktrackingRange = 0.1;

// Removes from the accelerations, m/s², one a vertex, what the surface and friction withstand, for touching contacts.
template <class Real>
void HoldResting(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                 std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                 std::span<Vector3<Real>> accelerations);

// After a substep of h seconds of one body from x0, v0 to x, v: puts its vertices back, and marks as touching the
// contacts whose vertices lie on the surface, not those that bounce. No listed vertex is left below a surface by more
// than rounding, if there is a place above all of them.
template <class Real>
void PutBack(const Coefficients<Real>& body, Real h, std::span<const Surface<Real>> surfaces,
             std::span<const Vector3<Real>> x0, std::span<const Vector3<Real>> v0, std::span<Contact<Real>> contacts,
             std::span<Vector3<Real>> x, std::span<Vector3<Real>> v);

}  // namespace wobble::physics
