// Input and output of the kernel for contacts of a pack with planes: one slot for each place and plane that any body of
// the pack may touch there, with a number for every lane. So nothing is gathered, and a slot without a vertex below its
// plane costs a few instructions.
#pragma once

#include <cstdint>

#include "server/physics/kernels/contact/contact_lanes.h"

namespace wobble::physics {

template <class Real>
struct PlaneSlot {
  std::uint32_t place = 0;
  Real normal[3] = {};
  Real friction = 0;  // Coulomb's coefficient of body and plane
};

template <class Real>
struct PlaneLanes {
  std::uint32_t count = 0;  // slots
  std::uint32_t width = 0;  // lanes of the pack
  const PlaneSlot<Real>* slots = nullptr;
  Real* offsets = nullptr;  // [slot][lane], of the plane, m; far below all vertices if the lane has no contact
  Real* shares = nullptr;   // [slot][lane], Coefficients::contactShares
  Real* sticks = nullptr;   // [slot][lane], stiffness of the stick spring, N/m; 0: there is no anchor
  Real* anchors = nullptr;  // [slot][3][lane], m
};

// Forces that the sweep does not compute: SweepLanes::outer and hasOuter, and the list of places that have one.
template <class Real>
struct OuterLanes {
  Real* forces = nullptr;
  std::uint8_t* hasForce = nullptr;
  std::uint32_t* places = nullptr;  // with room for all places
  std::uint32_t count = 0;
};

template <class Real>
struct PlaneKernel {
  // Adds the forces of all slots, N. state: [place][x y z vx vy vz][lane].
  void (*addForces)(const PenaltyLaw<Real>& law, const PlaneLanes<Real>& planes, const Real* state,
                    OuterLanes<Real>& outer) = nullptr;
  // UpdateAnchors of contact.h after a substep of h s to `state`: writes sticks and anchors. stick: stiffness of the
  // stick spring, N/m.
  void (*dragAnchors)(const PenaltyLaw<Real>& law, Real stick, Real h, const PlaneLanes<Real>& planes,
                      const Real* state) = nullptr;
};

}  // namespace wobble::physics
