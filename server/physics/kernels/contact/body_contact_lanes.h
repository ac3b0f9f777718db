// Input and output of the kernel for contacts between bodies: the law of body_contact.h, one contact a lane, whichever
// body it belongs to.
//
// Contacts lie in blocks of kContactsInBlock, [number][contact], whatever the vector's width: a block's numbers lie
// together, and a contact's bits cannot depend on its neighbours'. The kernel only looks at the face that a contact
// has. A contact whose vertex may have left that face is `left` to the plain code: one in a hundred.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobble::physics {

inline constexpr std::size_t kContactsInBlock = 16;

template <class Real>
using ContactRow = Real[kContactsInBlock];

template <class Real>
struct alignas(64) BodyContactBlock {
  // Constant through a tick.
  ContactRow<Real> shift[3];   // from the vertex's local coordinates to the face's, m
  ContactRow<Real> stiffness;  // this and the next six: ContactParameters of the pair
  ContactRow<Real> fadeDepth;
  ContactRow<Real> perFadeDepth;
  ContactRow<Real> damping;
  ContactRow<Real> stickStiffness;
  ContactRow<Real> stickDamping;
  ContactRow<Real> friction;
  ContactRow<Real> share;      // Coefficients::contactShares
  ContactRow<Real> offset;     // Skin::offset, m
  ContactRow<Real> freeDepth;  // depth that is no leap, m: FindFreeDepth, at an open skin kArmingDepth
  ContactRow<Real> open;       // 1: the face's skin is open; 0: closed
  ContactRow<Real> outward[3];
  // Fields of BodyContact as the last substep left them. maxDepth and touching together are its phase: waiting is
  // maxDepth -1, touching is touching 1, armed is neither.
  ContactRow<Real> side;  // 1: front; -1: back
  ContactRow<Real> maxDepth;
  ContactRow<Real> depth;
  ContactRow<Real> leap;
  ContactRow<Real> touching;  // 0, 1
  ContactRow<Real> foot[3];
  ContactRow<Real> slip[3];
};

// Positions, m, and velocities, m/s, of the vertex ([0]) and the face's corners ([1] to [3]), each in its own body's
// local coordinates.
template <class Real>
struct alignas(64) BodyContactPoints {
  ContactRow<Real> x[4][3];
  ContactRow<Real> v[4][3];
  // For the update alone: positions of the neighbours' corners across the sides opposite to the corners.
  ContactRow<Real> across[3][3];
};

// Forces, N. Bit i of the masks is contact i.
template <class Real>
struct alignas(64) BodyContactForces {
  ContactRow<Real> onVertex[3];
  ContactRow<Real> onCorners[3][3];
  std::uint32_t acts = 0;  // contacts whose forces are valid
  std::uint32_t left = 0;  // contacts that the plain code must compute
};

// The phases after an update. Bit i of the masks is contact i.
struct BodyContactChange {
  std::uint32_t armed = 0;     // armed or touching
  std::uint32_t touching = 0;  // touching
  std::uint32_t left = 0;      // contacts that the plain code must update; their numbers in the block are not valid
};

template <class Real>
struct BodyContactKernel {
  void (*computeForces)(const BodyContactBlock<Real>& block, const BodyContactPoints<Real>& points,
                        BodyContactForces<Real>& forces) = nullptr;
  // After a substep of h seconds: writes leap, depth, maxDepth, foot and slip to the block.
  BodyContactChange (*update)(const BodyContactPoints<Real>& points, Real h, BodyContactBlock<Real>& block) = nullptr;
};

}  // namespace wobble::physics
