// Finds the face of a body's skin that a point belongs to.
//
// A point outside belongs to the nearest face. A point inside keeps the face that it came in through and changes it
// only by sliding over a side: the nearest face of a point in a corner may be one that the point never passed, and a
// contact with that face would push sideways, or out at the far end of the body.
//
// All points and positions are in the local coordinates of the skin's body, m.
#pragma once

#include <cstdint>
#include <span>

#include "server/physics/model/topology.h"
#include "server/physics/model/vector_view.h"

namespace wobble::physics {

// The surface of one body at one moment. It owns nothing.
template <class Real>
struct Skin {
  std::span<const Face> faces;
  const Topology* topology = nullptr;
  VectorView<Real> x;
  Real side = 1;       // -1: an open skin seen from behind; all normals are then reversed
  Real offset = 0;     // the distance at which the points that meet it begin to push, m: all distances are less by this
  Real fadingGap = 0;  // the offset if it fades out beyond the sides of faces (FadeGap of body_contact_view.h), m
};

// A point seen from the plane of a face.
template <class Real>
struct FacePoint {
  std::uint16_t face = kNoFace;
  Real distance = 0;      // from the plane, less Skin::offset, m; negative inside
  Vector3<Real> normal;   // outward on the skin's `side`, unit length
  Vector3<Real> weights;  // barycentric, of the point's foot on the plane; their sum is one, negative beyond a side
  Real doubleArea = 0;    // twice the face's area, m²
  Real faded = 0;         // of the gap, m: `distance` is more by this
  bool rounded = false;   // seen from the nearest point of the face (FindRounded of body_contact_view.h)
};

// True if the point is below the face itself; a point less than Skin::offset above it has a negative distance already.
template <class Real>
[[nodiscard]] bool IsInside(const Skin<Real>& skin, const FacePoint<Real>& at) {
  return at.distance < -skin.offset;
}

// The point p seen from this face. A face without area gives finite numbers.
template <class Real>
[[nodiscard]] FacePoint<Real> FindFacePoint(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p);

// Squared distance of p from the face, m².
template <class Real>
[[nodiscard]] Real FindSquaredDistance(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p);

// The barycentric weights of the face's point that is nearest to p.
template <class Real>
[[nodiscard]] Vector3<Real> FindNearestWeights(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p);

// The nearest face that can be reached from `start` by steps to a nearer face in the ring of the corners; at most 16
// steps. Of faces equally near, as round an edge, the one whose plane is farthest below p. start: FindFacePoint of this
// skin and this p, which most callers have already.
template <class Real>
[[nodiscard]] FacePoint<Real> FindNearestFace(const Skin<Real>& skin, const FacePoint<Real>& start,
                                              const Vector3<Real>& p);

// The point p seen from the face round the vertex at which the search for p's nearest face begins, and nearly always
// ends: the first that has p above or below itself, or the one that comes nearest to that. vertex: of a face at least.
template <class Real>
[[nodiscard]] FacePoint<Real> FindFaceAround(const Skin<Real>& skin, std::uint16_t vertex, const Vector3<Real>& p);

// True if a vertex whose own skin has the normal `outward` cannot have come in through the face, because the face looks
// the same way. outward: unit length, or zero for a vertex that may have come in through any face (an open skin).
template <class Real>
[[nodiscard]] bool LooksAlong(const FacePoint<Real>& at, const Vector3<Real>& outward);

// Returns `at` unless it looks along `outward`. If it does: the nearest face around `at` that does not, provided that p
// is inside and within `within` m of that face, or that the face is as near as `at`; otherwise `at`.
template <class Real>
[[nodiscard]] FacePoint<Real> TurnToFacing(const Skin<Real>& skin, const FacePoint<Real>& at, const Vector3<Real>& p,
                                           const Vector3<Real>& outward, Real within);

// The vertex's normal: the area-weighted sum of the normals of its faces, unit length; zero where they cancel.
template <class Real>
[[nodiscard]] Vector3<Real> FindOutward(const Skin<Real>& skin, std::uint16_t vertex);

// The face that a point inside has come to from `start` by sliding over sides; at most 16 steps. start: FindFacePoint
// of this skin and this p.
template <class Real>
[[nodiscard]] FacePoint<Real> SlideToFace(const Skin<Real>& skin, const FacePoint<Real>& start, const Vector3<Real>& p);

// Like SlideToFace, but over one side at most and only if p has left the face: for use within a substep.
template <class Real>
[[nodiscard]] FacePoint<Real> FollowFace(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p);

}  // namespace wobble::physics
