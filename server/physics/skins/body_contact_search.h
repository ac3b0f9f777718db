// Finds the vertices of one body that may touch another body within a tick.
#pragma once

#include <span>
#include <vector>

#include "server/physics/kernels/contact/point_lanes.h"
#include "server/physics/model/bounds.h"
#include "server/physics/skins/body_contact.h"
#include "server/physics/skins/skin_points.h"

namespace wobble::physics {

// The inputs of the search of one side of a pair, at the beginning of a tick.
template <class Real>
struct ContactSearch {
  const SkinPoints<Real>* vertices = nullptr;  // of the vertices' body
  const SkinPoints<Real>* skin = nullptr;      // of the faces' body
  PointKernel<Real> kernel;
  // Of the skin, in its coordinates, with `margin` and the way of `duration` at its speed added; the speed is the sum
  // of both bodies' speeds.
  Bounds<Real> near;
  Real margin = 0;    // for motion that a vertex's present velocity does not tell, m
  Real duration = 0;  // of the tick, s
};

// Kept by the caller to save allocations.
template <class Real>
struct ContactSearchScratch {
  std::vector<BodyContact<Real>> contacts;
  std::vector<std::uint16_t> found;
};

// Replaces `contacts` by one contact for every skin vertex that may touch the other body before the tick is over. A
// contact that was in the old list keeps its state. own: the skin that the vertices belong to. Cost: some ten
// operations a vertex in vectors, and a walk of a few faces for each vertex that is near.
template <class Real>
void FindBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const Skin<Real>& own,
                      const ContactSearch<Real>& search, std::vector<BodyContact<Real>>& contacts,
                      ContactSearchScratch<Real>& scratch);

}  // namespace wobble::physics
