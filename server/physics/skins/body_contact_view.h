// How a body contact sees its face: relative velocity, stick spring, whether it pushes. For the three units of body
// contacts (law, search, update) alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "server/physics/skins/behind_skin.h"
#include "server/physics/skins/body_contact.h"

namespace wobble::physics {

// The barycentric weight by which a vertex may have slid beyond its face within a substep and still be pushed by it. A
// face that is squashed thin turns so fast that its plane can sweep over a vertex far beside it, whose weights are then
// a lever that makes any force as large as one likes.
inline constexpr double kMaxOverhang = 0.25;
// The weight by which a vertex may lie beyond a sharp edge and still belong to its face.
inline constexpr double kHangingOverhang = 0.05;

// Σ wᵢ valueᵢ over the corners of a face.
template <class Real>
[[nodiscard]] Vector3<Real> Blend(const Vector3<Real>& weights, const Face& face, const VectorView<Real>& values) {
  return weights[0] * values[face[0]] + weights[1] * values[face[1]] + weights[2] * values[face[2]];
}

// The skin of the faces' body, with normals towards `side`.
template <class Real>
[[nodiscard]] Skin<Real> SkinFrom(const Meeting<Real>& meeting, SkinSide side) {
  Skin<Real> skin = meeting.skin;
  skin.side = side == SkinSide::kBack ? Real(-1) : Real(1);
  return skin;
}

// The vertex's velocity against the point of the skin under it, or where the face ends against the nearest part of the
// face, m/s.
template <class Real>
[[nodiscard]] Vector3<Real> FindRelativeVelocity(const Meeting<Real>& meeting, std::uint16_t vertex,
                                                 const FacePoint<Real>& at) {
  const Vector3<Real> weights = at.weights.cwiseMax(Real(0));
  return meeting.v[vertex] - Blend<Real>(weights / weights.sum(), meeting.skin.faces[at.face], meeting.skinV);
}

// True if the foot lies past a border of the skin.
template <class Real>
[[nodiscard]] bool IsPastBorder(const Skin<Real>& skin, const FacePoint<Real>& at) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const bool beyond = at.weights[static_cast<Eigen::Index>(corner)] < Real(0);
    if (beyond && skin.topology->neighbours[at.face][corner] == kNoFace) return true;
  }
  return false;
}

// The vertex p seen from the nearest point of the face instead of from its plane: the normal is the direction to that
// point (behind: the skin is in front of the vertex) and the depth the distance from it.
template <class Real>
[[nodiscard]] FacePoint<Real> FindRounded(const Skin<Real>& skin, const FacePoint<Real>& at, const Vector3<Real>& p,
                                          bool behind) {
  FacePoint<Real> rounded = at;
  rounded.rounded = true;
  rounded.weights = FindNearestWeights(skin, at.face, p);
  const Vector3<Real> back = Blend<Real>(rounded.weights, skin.faces[at.face], skin.x) - p;
  const Real sense = behind ? Real(1) : Real(-1);
  const Real distance = std::sqrt(back.dot(back));
  rounded.normal = distance > Real(0) ? Vector3<Real>(back * (sense / distance)) : at.normal;
  rounded.distance = -sense * distance - skin.offset;
  return rounded;
}

// Whether the vertex p, beside the face `at` of an open skin, is behind the skin. It has only changed sides if it can
// have come through since the contact was last looked at: from `before` m behind to where it is now. Then the skin
// round the nearest point tells (IsBehindSkin).
template <class Real>
[[nodiscard]] bool IsBehindNow(const Skin<Real>& skin, const BodyContact<Real>& contact, const FacePoint<Real>& at,
                               const Vector3<Real>& p) {
  const Real before = contact.depth + contact.leap - skin.offset;
  const Real play = contact.maxDepth - std::max(Real(0), contact.depth);
  const bool wasBehind = before > Real(0);
  const auto isTooFar = [&](const FacePoint<Real>& from) {
    return std::abs(from.distance + skin.offset) + std::abs(before) > play;
  };
  if (isTooFar(at) || IsBehindSkin(skin, at, p) == wasBehind) return wasBehind;
  return isTooFar(FindRounded(skin, at, p, !wasBehind)) ? wasBehind : !wasBehind;
}

// How a contact sees the vertex p from the face `at`. Beside all faces of an open skin, the nearest point of the skin
// pushes the vertex, and below a ridge or a tip pulls it back: that distance is steady as one face takes over from the
// other and past a border, where planes of faces would push what they only pass by. Nor do planes tell the sides there.
template <class Real>
[[nodiscard]] FacePoint<Real> FindSeen(const Skin<Real>& skin, const BodyContact<Real>& contact,
                                       const FacePoint<Real>& at, const Vector3<Real>& p) {
  if (!skin.topology->isOpen || contact.phase == ContactPhase::kWaiting) return at;
  if (at.weights.minCoeff() >= Real(0)) return at;
  const bool isBehind = IsBehindNow(skin, contact, at, p);
  const Real below = -at.distance - skin.offset;
  const bool isAtBorder = IsPastBorder(skin, at) && below * below < at.doubleArea;
  if (isBehind && IsInside(skin, at) && isAtBorder) return at;
  return FindRounded(skin, at, p, isBehind);
}

// Lets the gap of a contact fade out beside its face, where the face's plane says little of the skin: with b the way
// beyond a side and h the height above the plane, the vertex is √(h² + b²) from the side and not h. Else what is past
// an edge would be pushed as if the face went on, and from some weight on no more at all, which cost one in eight
// bodies in contact their error target. b and h are the same from both faces of an edge where one takes over from the
// other. A linear fade, b/2, made a stack of cubes with edges on edges drift by 5 mm.
template <class Real>
void FadeGap(const Skin<Real>& skin, FacePoint<Real>& at) {
  if (!(skin.fadingGap > Real(0)) || at.weights.minCoeff() >= Real(0)) return;
  const Face& face = skin.faces[at.face];
  Real beyond = 0;
  for (int i = 0; i < 3; ++i) {
    const Vector3<Real> side = skin.x[face[(i + 2) % 3]] - skin.x[face[(i + 1) % 3]];
    const Real length = std::max(std::sqrt(side.dot(side)), std::numeric_limits<Real>::min());
    beyond = std::max(beyond, -at.weights[i] * at.doubleArea / length);
  }
  const Real above = std::max(Real(0), at.distance + skin.offset);
  at.faded = std::min(skin.fadingGap, std::sqrt(above * above + beyond * beyond) - above);
  at.distance += at.faded;
}

// Whether the contact exerts force (ContactPhase). at: with the leap added to its distance.
template <class Real>
[[nodiscard]] bool Pushes(const BodyContact<Real>& contact, const FacePoint<Real>& at) {
  return MayPush(contact.phase) && at.distance < Real(0) && -at.distance <= contact.maxDepth &&
         at.weights.minCoeff() >= -static_cast<Real>(kMaxOverhang);
}

// The stick spring of a touching contact, m. at: where its vertex p is now. The height above the face that the vertex
// comes from is no slip, and must not become one along the face that it has come to.
template <class Real>
[[nodiscard]] Vector3<Real> FindSlip(const Meeting<Real>& meeting, const BodyContact<Real>& contact,
                                     const Vector3<Real>& p, const FacePoint<Real>& at) {
  const Vector3<Real> foot = Blend<Real>(contact.foot, meeting.skin.faces[contact.face], meeting.skin.x);
  Vector3<Real> slip = contact.slip + p - foot;
  if (at.face != contact.face) slip = RemoveNormalPart<Real>(slip, FindFacePoint(meeting.skin, contact.face, p).normal);
  return RemoveNormalPart<Real>(slip, at.normal);
}

// Whether the vertex stays on the face `kept` although it has slid over its side to the face `slid`: that is so when
// the vertex cannot have come in through `slid`. Where edges lie on edges, rounding decides on which side of them a
// vertex is; changing the face with it would push sideways now and then, or drop the contact and with it what friction
// holds.
template <class Real>
[[nodiscard]] bool HangsOn(const BodyContact<Real>& contact, const FacePoint<Real>& slid, const FacePoint<Real>& kept) {
  return LooksAlong(slid, contact.outward) && !LooksAlong(kept, contact.outward) && kept.distance < Real(0) &&
         kept.weights.minCoeff() >= -static_cast<Real>(kHangingOverhang);
}

}  // namespace wobble::physics
