// The penalty law on vectors (contact_lanes.h). Compiled once for each instruction set.
//
// Without branches: a vertex outside has depth 0, so no normal force, so no friction.
#pragma once

#include "server/physics/kernels/contact/contact_lanes.h"
#include "server/physics/lanes/lanes.h"

namespace wobble::physics {
namespace {

// F(d): with m = min(d, δ), F = k m²/2δ + k (d − m) covers both branches. depth: at least 0, m.
template <class Real, class V>
static inline __attribute__((always_inline)) V FindSpringForce(const PenaltyLaw<V>& law, V depth) {
  const V bounded = Min(depth, law.fadeDepth);
  const V t = bounded * law.perFadeDepth;
  return Fma(law.stiffness * bounded * t, Spread<V>(Real(0.5)), law.stiffness * (depth - bounded));
}

// F + c s ḋ, at least 0. spring: F, N.
template <class Real, class V>
static inline __attribute__((always_inline)) V FindNormalForce(const PenaltyLaw<V>& law, V spring, V depth, V rate) {
  const V t = Min(depth, law.fadeDepth) * law.perFadeDepth;
  const V fade = t * t * Fnma(Spread<V>(Real(2)), t, Spread<V>(Real(3)));
  return Max(Fma(law.damping * fade, rate, spring), Spread<V>(Real(0)));
}

// The stiffness with which a stick spring of the square length `square`, m², pulls no harder than `limit`, N
// (FindStickPull of contact.h). Most springs stick, so the root and the quotient are often saved.
template <class V>
static inline __attribute__((always_inline)) V LimitStick(V stick, V square, V limit) {
  const V squarePull = stick * stick * square;
  const V squareLimit = limit * limit;
  if (FindBelow(squareLimit, squarePull) == 0) return stick;
  return squareLimit < squarePull ? limit / Sqrt(square) : stick;
}

template <class V, class Real>
static inline __attribute__((always_inline)) PenaltyLaw<V> SpreadLaw(const PenaltyLaw<Real>& law) {
  return {.stiffness = Spread<V>(law.stiffness),
          .fadeDepth = Spread<V>(law.fadeDepth),
          .perFadeDepth = Spread<V>(law.perFadeDepth),
          .damping = Spread<V>(law.damping),
          .stickDamping = Spread<V>(law.stickDamping)};
}

template <class V>
static inline __attribute__((always_inline)) V Dot(const V* a, const V* b) {
  return Fma(a[2], b[2], Fma(a[1], b[1], a[0] * b[0]));
}

// The part of `way`, from the anchor to the vertex, that is tangential to the surface.
template <class V>
static inline __attribute__((always_inline)) void FindSlip(const V* normal, const V* way, V* slip) {
  const V away = Dot(normal, way);
  for (int axis = 0; axis < 3; ++axis) slip[axis] = Fnma(normal[axis], away, way[axis]);
}

// The stick spring of a contact that has begun within the last substep of h s (FindFirstSlip of contact.h).
template <class Real, class V>
static inline __attribute__((always_inline)) void FindFirstSlip(Real h, V depth, const V* normal, const V* velocity,
                                                                V* slip) {
  const V away = Dot(normal, velocity);
  const V time = Min(Spread<V>(h), depth / Max(-away, Spread<V>(Real(1e-30F))));
  for (int axis = 0; axis < 3; ++axis) slip[axis] = time * Fnma(normal[axis], away, velocity[axis]);
}

// The force on a vertex, before its contact share, N. friction: Coulomb's coefficient; stick: stiffness of the stick
// spring, N/m.
template <class Real, class V>
static inline __attribute__((always_inline)) void FindContactForce(const PenaltyLaw<V>& law, const V* normal,
                                                                   V distance, const V* v, const V* slip, V stick,
                                                                   V friction, V* force) {
  const V away = Dot(normal, v);
  const V depth = Max(-distance, Spread<V>(Real(0)));
  const V spring = FindSpringForce<Real>(law, depth);
  const V push = FindNormalForce<Real>(law, spring, depth, -away);
  const V held = LimitStick(stick, Dot(slip, slip), friction * spring);
  V pull[3];
  for (int axis = 0; axis < 3; ++axis) {
    pull[axis] = Fma(law.stickDamping, Fnma(normal[axis], away, v[axis]), held * slip[axis]);
  }
  // The bound avoids 0/0; a pull this weak is within any limit.
  const V strength = Max(Sqrt(Dot(pull, pull)), Spread<V>(Real(1e-30F)));
  const V kept = Min(friction * push / strength, Spread<V>(Real(1)));
  for (int axis = 0; axis < 3; ++axis) force[axis] = Fnma(kept, pull[axis], push * normal[axis]);
}

template <class V, class Real>
void ComputePenaltyForces(const PenaltyLaw<Real>& law, const ContactLanes<Real>& contacts) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(Real);
  const auto read = [](const Real* array, std::size_t i) { return *reinterpret_cast<const V*>(array + i); };
  const PenaltyLaw<V> everywhere = SpreadLaw<V>(law);
  for (std::size_t i = 0; i < contacts.count; i += kWidth) {
    V normal[3];
    V v[3];
    V way[3];
    for (int axis = 0; axis < 3; ++axis) {
      normal[axis] = read(contacts.normal[axis], i);
      v[axis] = read(contacts.v[axis], i);
      way[axis] = read(contacts.x[axis], i) - read(contacts.anchor[axis], i);
    }
    V slip[3];
    V force[3];
    FindSlip(normal, way, slip);
    FindContactForce<Real>(everywhere, normal, read(contacts.distance, i), v, slip, read(contacts.stick, i),
                           read(contacts.friction, i), force);
    const V share = read(contacts.share, i);
    for (int axis = 0; axis < 3; ++axis) *reinterpret_cast<V*>(contacts.force[axis] + i) = share * force[axis];
  }
}

}  // namespace
}  // namespace wobble::physics
