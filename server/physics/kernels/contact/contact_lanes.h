// Input and output of the kernel for contacts of a pack's bodies with obstacles: the penalty law of contact.h, one
// contact a lane, whichever body it belongs to.
#pragma once

#include <cstddef>

namespace wobble::physics {

// The fields of ContactParameters that a lane needs; numbers for a whole blueprint, or vectors with a law in each lane.
template <class Real>
struct PenaltyLaw {
  Real stiffness = 0;     // N/m
  Real fadeDepth = 0;     // m
  Real perFadeDepth = 0;  // 1/m
  Real damping = 0;       // N·s/m
  Real stickDamping = 0;  // N·s/m
};

// Arrays with one number a contact, padded to a whole vector above `count` and aligned to it. Three arrays: x, y, z.
template <class Real>
struct ContactLanes {
  std::size_t count = 0;
  const Real* x[3] = {};           // of the vertex, m
  const Real* v[3] = {};           // m/s
  const Real* normal[3] = {};      // of the surface, unit length
  const Real* distance = nullptr;  // from the surface, m; negative inside
  const Real* anchor[3] = {};      // of the stick spring, m
  const Real* stick = nullptr;     // stiffness of the stick spring, N/m; 0: there is no anchor
  const Real* friction = nullptr;  // Coulomb's coefficient
  const Real* share = nullptr;     // Coefficients::contactShares
  Real* force[3] = {};             // output: on the vertex, N
};

template <class Real>
using ContactKernel = void (*)(const PenaltyLaw<Real>& law, const ContactLanes<Real>& contacts);

}  // namespace wobble::physics
