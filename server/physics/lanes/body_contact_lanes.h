// Contacts of vertices with the faces of other bodies, side by side: the law of body_contact.h, as many at a time as a
// vector has lanes, whoever's they are.
//
// In blocks of kContactsInBlock, [number][contact], whatever the width: a block's numbers lie together, and a contact's
// bits cannot depend on its neighbours'. The lanes look at the face that a contact has. One whose vertex has left that
// face is `left` to the plain code: one in a hundred.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobble::physics {

inline constexpr std::size_t kContactsInBlock = 16;

template <class Real>
using ContactRow = Real[kContactsInBlock];

template <class Real>
struct alignas(64) BodyContactBlock {
  // Constant through a tick:
  ContactRow<Real> shift[3];   // from the vertex's local coordinates to the face's, m
  ContactRow<Real> stiffness;  // ContactParameters
  ContactRow<Real> fadeDepth;
  ContactRow<Real> perFadeDepth;
  ContactRow<Real> damping;
  ContactRow<Real> stickStiffness;
  ContactRow<Real> stickDamping;
  ContactRow<Real> friction;
  ContactRow<Real> share;      // Coefficients::contactShares
  ContactRow<Real> freeDepth;  // that may come from nowhere, m
  ContactRow<Real> open;       // 1: the face's surface is
  ContactRow<Real> outward[3];
  // Of BodyContact, as the last substep left them:
  ContactRow<Real> side;      // 1; -1: `behind`
  ContactRow<Real> maxDepth;  // -1: not armed
  ContactRow<Real> depth;
  ContactRow<Real> leap;
  ContactRow<Real> touching;  // 0, 1
  ContactRow<Real> foot[3];
  ContactRow<Real> slip[3];
};

// Positions, m, and velocities, m/s: of the vertex, each in its own body's coordinates, and of the face's corners.
template <class Real>
struct alignas(64) BodyContactPoints {
  ContactRow<Real> x[4][3];
  ContactRow<Real> v[4][3];
  ContactRow<Real> across[3][3];  // after a substep: the neighbours' corners across the sides opposite to the corners
};

// N; bit i of the masks is contact i.
template <class Real>
struct alignas(64) BodyContactForces {
  ContactRow<Real> onVertex[3];
  ContactRow<Real> onCorners[3][3];
  std::uint32_t acts = 0;  // forces of others are not to be used
  std::uint32_t left = 0;
};

struct BodyContactChange {
  std::uint32_t armed = 0;
  std::uint32_t touching = 0;
  std::uint32_t left = 0;  // their numbers are not to be used
};

template <class Real>
struct BodyContactKernel {
  void (*computeForces)(const BodyContactBlock<Real>& block, const BodyContactPoints<Real>& points,
                        BodyContactForces<Real>& forces) = nullptr;
  // After a substep of h seconds.
  BodyContactChange (*update)(const BodyContactPoints<Real>& points, Real h, BodyContactBlock<Real>& block) = nullptr;
};

}  // namespace wobble::physics
