// The penalty law for the translation units that compile it for one instruction set each.
//
// No case is told apart: a vertex outside has depth 0, so no normal force, so no friction.
#pragma once

#include "server/physics/lanes/contact_lanes.h"
#include "server/physics/lanes/lanes.h"

namespace wobble::physics {
namespace {

// With m = min(d, δ), F = k m²/2δ + k (d − m) is both of its branches. depth: at least 0.
template <class Real, class V>
static inline __attribute__((always_inline)) V FindSpringForce(const PenaltyLaw<V>& law, V depth) {
  const V bounded = Min(depth, law.fadeDepth);
  const V t = bounded / law.fadeDepth;
  return Fma(law.stiffness * bounded * t, Spread<V>(Real(0.5)), law.stiffness * (depth - bounded));
}

// F + c s ḋ, at least 0.
template <class Real, class V>
static inline __attribute__((always_inline)) V FindNormalForce(const PenaltyLaw<V>& law, V depth, V rate) {
  const V t = Min(depth, law.fadeDepth) / law.fadeDepth;
  const V fade = t * t * Fnma(Spread<V>(Real(2)), t, Spread<V>(Real(3)));
  return Max(Fma(law.damping * fade, rate, FindSpringForce<Real>(law, depth)), Spread<V>(Real(0)));
}

template <class V, class Real>
void ComputePenaltyForces(const PenaltyLaw<Real>& law, const ContactLanes<Real>& contacts) {
  constexpr std::size_t kWidth = sizeof(V) / sizeof(Real);
  const auto read = [](const Real* array, std::size_t i) { return *reinterpret_cast<const V*>(array + i); };
  const PenaltyLaw<V> everywhere{Spread<V>(law.stiffness), Spread<V>(law.fadeDepth), Spread<V>(law.damping),
                                 Spread<V>(law.stickDamping)};
  for (std::size_t i = 0; i < contacts.count; i += kWidth) {
    V normal[3];
    V v[3];
    V slip[3];
    for (int axis = 0; axis < 3; ++axis) {
      normal[axis] = read(contacts.normal[axis], i);
      v[axis] = read(contacts.v[axis], i);
      slip[axis] = read(contacts.x[axis], i) - read(contacts.anchor[axis], i);
    }
    const V away = Fma(normal[2], v[2], Fma(normal[1], v[1], normal[0] * v[0]));
    const V slipAway = Fma(normal[2], slip[2], Fma(normal[1], slip[1], normal[0] * slip[0]));
    const V depth = Max(-read(contacts.distance, i), Spread<V>(Real(0)));
    const V force = FindNormalForce<Real>(everywhere, depth, -away);
    const V stick = read(contacts.stick, i);
    V pull[3];
    for (int axis = 0; axis < 3; ++axis) {
      pull[axis] = Fma(everywhere.stickDamping, Fnma(normal[axis], away, v[axis]),
                       stick * Fnma(normal[axis], slipAway, slip[axis]));
    }
    const V strength = Sqrt(Fma(pull[2], pull[2], Fma(pull[1], pull[1], pull[0] * pull[0])));
    const V limit = read(contacts.friction, i) * force;
    // Any pull this weak is within the limit of any force.
    const V kept = Min(limit / Max(strength, Spread<V>(Real(1e-30F))), Spread<V>(Real(1)));
    const V share = read(contacts.share, i);
    for (int axis = 0; axis < 3; ++axis) {
      *reinterpret_cast<V*>(contacts.force[axis] + i) = share * Fnma(kept, pull[axis], force * normal[axis]);
    }
  }
}

}  // namespace
}  // namespace wobble::physics
