// Contacts of a body with itself: edge contacts (edge_contact.h) whose two edges belong to one body.
//
// A skin in space meets itself by balls at its vertices, of equal radius r = 0.4 L, L the mean length of its sides. Why
// balls: their force has a potential in which nothing jumps, no side of a face has to be remembered, and a body that is
// folded, crushed or cut needs nothing else. What they hold back, with centres that stay d = 2 r = 0.8 L apart: a
// vertex would have to pass the middle of a face, L/√3 = 0.58 L from its corners, and two sides that cross at right
// angles have ends that come within L/√2 = 0.71 L. So with sides of equal length nothing passes through until they are
// drawn out by an eighth, or the balls pressed in as far. Layers that lie on one another are 0.56 L to 0.8 L apart. Two
// balls have no friction, as edge_contact.h says why. Bodies without faces meet themselves by their rods, planar ones
// by their border.
//
// A body whose edges are first seen deep in one another (broken, or put so), or cross in its plane, is tangled, and has
// no such contacts until it has come apart by its other forces: contacts would hold the tangle.
//
// What is joined must be free to bend, so only edges that are apart by more than kSelfApartShare d at rest meet.
#pragma once

#include <span>
#include <vector>

#include "server/physics/edges/edge_contact.h"

namespace wobble::physics {

// A body's edges that meet one another, at positions x, m, and velocities v, m/s.
template <class Real>
[[nodiscard]] EdgeMeeting<Real> MakeSelfMeeting(const Blueprint& blueprint, const VectorView<Real>& x,
                                                const VectorView<Real>& v) {
  const typename EdgeMeeting<Real>::Body body{
      .edges = blueprint.selfEdges, .x = x, .v = v, .shares = blueprint.template Read<Real>().contactShares};
  return {.first = body,
          .second = body,
          .shift = Vector3<Real>::Zero(),
          .radius = static_cast<Real>(2 * blueprint.selfRadius)};
}

// The inputs of the search at the beginning of a tick.
template <class Real>
struct SelfSearch {
  std::span<const Vector3d> rest;  // the body's rest shape, m
  Bounds<Real> bounds;             // of its vertices, in its own coordinates
  Real margin = 0;                 // for motion that the present velocities do not tell, m
  Real agitation = 0;              // Survey::agitation, m/s
  Real duration = 0;               // of the tick, s

  // The way that two edges may come nearer to one another in the tick, m.
  [[nodiscard]] Real FindReach() const { return margin + Real(2) * agitation * duration; }
};

// Kept by the caller to save allocations.
template <class Real>
struct SelfSearchScratch {
  std::vector<std::uint16_t> slabOf;  // by edge
  std::vector<std::uint32_t> slabs;   // where each slab begins in `order`
  std::vector<std::uint16_t> order;   // edges, slab by slab
  std::vector<Real> places;           // of their middles: all x, all y, all z, then the same at rest, m
  std::vector<Real> scores;           // of one row of the search
  std::vector<EdgeEnds> found;        // pairs of edges, ascending
  std::vector<EdgeContact<Real>> contacts;
};

// Replaces `contacts` by one contact for every two edges that may meet and may touch before the tick is over, by their
// distance and relative speed; by none of a tangled body. Contacts that were in the old list keep their state. Returns
// how much nearer any two edges that may meet can come before they touch, m, as far as it has looked; less than 0 where
// two overlap.
// Cost: for each edge a sweep over those in a slab across the body, 3 d thick, some 16 of them a nanosecond.
template <class Real>
[[nodiscard]] Real FindSelfContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                                    const SelfSearch<Real>& search, std::vector<EdgeContact<Real>>& contacts,
                                    SelfSearchScratch<Real>& scratch);

}  // namespace wobble::physics
