// On which side of an open skin a point is. For the units of body contacts (law, search, update) alone.
//
// Straight above or below a face its plane tells. Beside all faces, past a ridge or a tip, planes contradict one
// another: the point is above some and below others. There the sum of the normals round the nearest side tells, and
// round the nearest corner the sum by their angles (Bærentzen & Aanæs, Signed distance computation using the angle
// weighted pseudonormal, 2005), for a skin that does not pass through itself.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/physics/skins/face_search.h"

namespace wobble::physics {

// An angle with this cosine, rad, to 7e-5 (Abramowitz & Stegun 1964, 4.4.45), by operations that have the same bits
// everywhere.
template <class Real>
[[nodiscard]] Real FindAngle(Real cosine) {
  const Real x = std::min(Real(1), std::abs(cosine));
  const Real angle = std::sqrt(Real(1) - x) *
                     (Real(1.5707288) + x * (Real(-0.2121144) + x * (Real(0.0742610) + x * Real(-0.0187293))));
  return cosine < Real(0) ? Real(3.14159265) - angle : angle;
}

// The sum of the normals of the faces round a corner, each by its angle there, towards the skin's side.
template <class Real>
[[nodiscard]] Vector3<Real> SumNormalsRound(const Skin<Real>& skin, std::uint16_t vertex) {
  Vector3<Real> sum = Vector3<Real>::Zero();
  for (const std::uint16_t face : skin.topology->RingOf(vertex)) {
    const Face& f = skin.faces[face];
    const std::size_t corner = f[0] == vertex ? 0 : f[1] == vertex ? 1 : 2;
    const Vector3<Real> u = skin.x[f[(corner + 1) % 3]] - skin.x[vertex];
    const Vector3<Real> w = skin.x[f[(corner + 2) % 3]] - skin.x[vertex];
    const Vector3<Real> area = u.cross(w);
    const Real doubleArea = std::sqrt(area.dot(area));
    const Real lengths = std::sqrt(u.dot(u) * w.dot(w));
    if (doubleArea > Real(0) && lengths > Real(0)) sum += area * (FindAngle(u.dot(w) / lengths) / doubleArea);
  }
  return skin.side * sum;
}

// Whether p is behind the open skin whose nearest face is that of `at`. Past a border the face's plane tells.
template <class Real>
[[nodiscard]] bool IsBehindSkin(const Skin<Real>& skin, const FacePoint<Real>& at, const Vector3<Real>& p) {
  if (at.weights.minCoeff() >= Real(0)) return IsInside(skin, at);
  const Vector3<Real> weights = FindNearestWeights(skin, at.face, p);
  const Face& face = skin.faces[at.face];
  const Vector3<Real> way =
      p - (weights[0] * skin.x[face[0]] + weights[1] * skin.x[face[1]] + weights[2] * skin.x[face[2]]);
  Eigen::Index corner = 0;
  if (weights.maxCoeff(&corner) >= Real(1)) {
    return way.dot(SumNormalsRound(skin, face[static_cast<std::size_t>(corner)])) < Real(0);
  }
  weights.minCoeff(&corner);
  const std::uint16_t neighbour = skin.topology->neighbours[at.face][static_cast<std::size_t>(corner)];
  if (neighbour == kNoFace) return IsInside(skin, at);
  return way.dot(at.normal + FindFacePoint(skin, neighbour, p).normal) < Real(0);
}

}  // namespace wobble::physics
