// Contacts of a pack with planes: one slot for each place and plane that any body of the pack may touch there, with a
// number for every lane. So nothing is gathered, and a slot without a vertex below its plane costs a few instructions.
#pragma once

#include <cstdint>

#include "server/physics/lanes/contact_lanes.h"

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
  Real* offsets = nullptr;  // [slot][lane], m; far below where the lane has no contact
  Real* shares = nullptr;   // [slot][lane], Coefficients::contactShares
  Real* sticks = nullptr;   // [slot][lane], stiffness of the spring to the anchor, N/m; 0: it is not set
  Real* anchors = nullptr;  // [slot][3][lane], m
};

// Forces from outside the sweep: SweepLanes::outer and hasOuter, and the places that have one.
template <class Real>
struct OuterLanes {
  Real* forces = nullptr;
  std::uint8_t* hasForce = nullptr;
  std::uint32_t* places = nullptr;  // room for all
  std::uint32_t count = 0;
};

template <class Real>
struct PlaneKernel {
  // state: [place][x y z vx vy vz][lane]
  void (*addForces)(const PenaltyLaw<Real>& law, const PlaneLanes<Real>& planes, const Real* state,
                    OuterLanes<Real>& outer) = nullptr;
  // As UpdateAnchors, after a substep to `state`. stick: stiffness of the anchor spring, N/m.
  void (*dragAnchors)(const PenaltyLaw<Real>& law, Real stick, const PlaneLanes<Real>& planes,
                      const Real* state) = nullptr;
};

}  // namespace wobble::physics
