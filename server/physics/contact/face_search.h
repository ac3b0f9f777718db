// Which face of a moving surface a point belongs to.
//
// A point outside belongs to the nearest face. A point inside keeps the face that it came in through and changes it
// only by sliding over a side: the nearest face of a point in a corner may be one that it never passed, and a contact
// that took it for its own would push sideways, or out at the far end of the body.
#pragma once

#include <cstdint>
#include <span>

#include "server/physics/model/topology.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// The surface of one body at one moment.
template <class Real>
struct Skin {
  std::span<const Face> faces;
  const Topology* topology = nullptr;
  std::span<const Vector3<Real>> x;
  Real side = 1;  // -1: an open surface looked at from behind, where its outward is our inward
};

// A point seen from the plane of a face.
template <class Real>
struct FacePoint {
  std::uint16_t face = kNoFace;
  Real distance = 0;      // from the plane, m; negative inside
  Vector3<Real> normal;   // outward on the skin's side, unit length
  Vector3<Real> weights;  // barycentric, of the point's foot on the plane; they add up to one, negative beyond a side
  Real doubleArea = 0;    // m²
};

template <class Real>
[[nodiscard]] FacePoint<Real> FindFacePoint(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p);

// The nearest face that can be reached from `start` by going to a nearer one in the ring of its corners again and
// again. Of faces equally near, as round an edge, the one whose plane is farthest below p.
template <class Real>
[[nodiscard]] FacePoint<Real> FindNearestFace(const Skin<Real>& skin, std::uint16_t start, const Vector3<Real>& p);

// Whether the face looks too much the way that `outward` does for a vertex of a surface with that normal to have come
// in through it. outward: unit length; zero: of a surface that has two sides, and may have come in through any.
template <class Real>
[[nodiscard]] bool LooksAlong(const FacePoint<Real>& at, const Vector3<Real>& outward);

// Where `at` looks along `outward`: the nearest of the faces round it that does not, if p is inside and within that
// distance of it (m), or if that one is as near as `at`. Else `at`.
template <class Real>
[[nodiscard]] FacePoint<Real> TurnToFacing(const Skin<Real>& skin, const FacePoint<Real>& at, const Vector3<Real>& p,
                                           const Vector3<Real>& outward, Real within);

// Sum of the normals of the faces round the vertex by their areas, unit length; zero where they cancel.
template <class Real>
[[nodiscard]] Vector3<Real> FindOutward(const Skin<Real>& skin, std::uint16_t vertex);

// The face that a point inside has come to from `start` by sliding.
template <class Real>
[[nodiscard]] FacePoint<Real> SlideToFace(const Skin<Real>& skin, std::uint16_t start, const Vector3<Real>& p);

// As SlideToFace, one side at most and only when p has left the face: for use within a step.
template <class Real>
[[nodiscard]] FacePoint<Real> FollowFace(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p);

}  // namespace wobble::physics
