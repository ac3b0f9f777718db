// Contacts of a pack with what stands still, side by side: the penalty law of contact.h, as many at a time as a vector
// has lanes, whoever's they are.
#pragma once

#include <cstddef>

namespace wobble::physics {

// Of the bodies' blueprint, or of each lane; ContactParameters without what a lane does not need.
template <class Real>
struct PenaltyLaw {
  Real stiffness = 0;     // N/m
  Real fadeDepth = 0;     // m
  Real perFadeDepth = 0;  // 1/m
  Real damping = 0;       // N·s/m
  Real stickDamping = 0;  // N·s/m
};

// One number a contact in each array, up to the whole vector above `count`; x, y, z where there are three.
template <class Real>
struct ContactLanes {
  std::size_t count = 0;
  const Real* x[3] = {};           // of the vertex, m
  const Real* v[3] = {};           // m/s
  const Real* normal[3] = {};      // of the surface
  const Real* distance = nullptr;  // over it, m
  const Real* anchor[3] = {};      // of friction, m
  const Real* stick = nullptr;     // stiffness of the spring to it, N/m; 0: it is not set
  const Real* friction = nullptr;  // Coulomb's coefficient
  const Real* share = nullptr;     // Coefficients::contactShares
  Real* force[3] = {};             // on the vertex, N; filled
};

template <class Real>
using ContactKernel = void (*)(const PenaltyLaw<Real>& law, const ContactLanes<Real>& contacts);

}  // namespace wobble::physics
