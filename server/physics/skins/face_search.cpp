// Both searches walk from the face where the point was last, since it cannot have gone far: they look at a few faces
// instead of all. They stop after kMaxSteps, so that a crumpled skin cannot hold them.
//
// The squared distance to a triangle goes by Voronoi regions of its corners, sides and inside (Ericson, Real-Time
// Collision Detection, 2005, 5.1.5).
#include "server/physics/skins/face_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/physics/kernels/contact/contact_limits.h"
#include "server/physics/lanes/vertex_rows.h"
#include "server/physics/skins/face_ring.h"

namespace wobble::physics {
namespace {

constexpr int kMaxSteps = 16;
// Squared distances that differ by less than this share of twice a face's area count as equal: the point is nearest to
// an edge or a corner that both faces have.
constexpr double kTieShare = 1e-5;

template <class Real>
Real FindSquaredDistance(const Vector3<Real>& a, const Vector3<Real>& b, const Vector3<Real>& c,
                         const Vector3<Real>& p) {
  const Vector3<Real> ab = b - a;
  const Vector3<Real> ac = c - a;
  const Vector3<Real> ap = p - a;
  const Real d1 = ab.dot(ap);
  const Real d2 = ac.dot(ap);
  if (d1 <= Real(0) && d2 <= Real(0)) return ap.squaredNorm();
  const Vector3<Real> bp = p - b;
  const Real d3 = ab.dot(bp);
  const Real d4 = ac.dot(bp);
  if (d3 >= Real(0) && d4 <= d3) return bp.squaredNorm();
  const Real vc = d1 * d4 - d3 * d2;
  if (vc <= Real(0) && d1 >= Real(0) && d3 <= Real(0)) return (ap - d1 / (d1 - d3) * ab).squaredNorm();
  const Vector3<Real> cp = p - c;
  const Real d5 = ab.dot(cp);
  const Real d6 = ac.dot(cp);
  if (d6 >= Real(0) && d5 <= d6) return cp.squaredNorm();
  const Real vb = d5 * d2 - d1 * d6;
  if (vb <= Real(0) && d2 >= Real(0) && d6 <= Real(0)) return (ap - d2 / (d2 - d6) * ac).squaredNorm();
  const Real va = d3 * d6 - d5 * d4;
  if (va <= Real(0) && d4 - d3 >= Real(0) && d5 - d6 >= Real(0)) {
    return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
  }
  const Vector3<Real> normal = ab.cross(ac);
  const Real height = normal.dot(ap);
  const Real square = normal.squaredNorm();
  return square > Real(0) ? height * height / square : ap.squaredNorm();
}

// The corner of `face` that is not on its side towards `other`; 3 if they are no neighbours.
int FindCornerOpposite(const Topology& topology, std::uint16_t face, std::uint16_t other) {
  int corner = 0;
  while (corner < 3 && topology.neighbours[face][static_cast<std::size_t>(corner)] != other) ++corner;
  return corner;
}

// True if the skin is convex or flat over the face's side towards the neighbour.
template <class Real>
bool IsConvex(const Skin<Real>& skin, const FacePoint<Real>& face, std::uint16_t neighbour) {
  const int corner = FindCornerOpposite(*skin.topology, neighbour, face.face);
  if (corner == 3) return true;
  const Vector3<Real>& beyond = skin.x[skin.faces[neighbour][static_cast<std::size_t>(corner)]];
  return (beyond - skin.x[skin.faces[face.face][0]]).dot(face.normal) <= Real(0);
}

// True if p is above the face itself and no neighbour rises towards p so far that its plane is nearer than the face.
// Then no neighbour is nearer. A face that only has a corner in common can still be nearer where the skin is hollow, if
// p is above a spot round the corner that is as wide as p's height times the angle between the faces; p finds that face
// on its way down, as the spot shrinks.
template <class Real>
bool IsPlainlyNearest(const Skin<Real>& skin, const FacePoint<Real>& at, const Vector3<Real>& p) {
  if (IsInside(skin, at) || at.weights.minCoeff() < Real(0)) return false;
  const auto& neighbours = skin.topology->neighbours[at.face];
  return std::all_of(neighbours.begin(), neighbours.end(), [&](std::uint16_t n) {
    return n == kNoFace || IsConvex(skin, at, n) || FindFacePoint(skin, n, p).distance >= at.distance;
  });
}

// Squared distance of p from the face's box, m²: a lower bound of that from the face, which rules out most faces of a
// ring. The three axes lie side by side in a register.
template <class Real>
Real FindSquaredBoxDistance(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p) {
  const Face& f = skin.faces[face];
  const auto a = LoadThree(skin.x[f[0]].data());
  const auto b = LoadThree(skin.x[f[1]].data());
  const auto c = LoadThree(skin.x[f[2]].data());
  const auto at = LoadThree(p.data());
  const auto low = MinOf(a, MinOf(b, c)) - at;
  const auto high = at - MaxOf(a, MaxOf(b, c));
  const auto beyond = MaxOf(typename RowsOf<Real>::Row{}, MaxOf(low, high));
  Real squares[4];
  StoreRow(beyond * beyond, squares);
  return squares[0] + squares[1] + squares[2];
}

// Of the faces round a vertex: lower bounds of their squared distances, m².
template <class Real>
struct RingBounds {
  std::uint16_t nearest = kNoFace;
  Real least = std::numeric_limits<Real>::max();          // of all
  Real leastOfOthers = std::numeric_limits<Real>::max();  // of all but `nearest`

  void Note(std::uint16_t face, Real square) {
    if (square < least) {
      leastOfOthers = least;
      least = square;
      nearest = face;
    } else {
      leastOfOthers = std::min(leastOfOthers, square);
    }
  }
  [[nodiscard]] Real FindLeastWithout(std::uint16_t face) const { return face == nearest ? leastOfOthers : least; }
};

// The walk of FindNearestFace. From face to face most corners stay, and the faces round a corner that stays are as far
// as they were: they are looked at again only if one of them may be near enough to count.
template <class Real>
class NearestFaceWalk {
 public:
  NearestFaceWalk(const Skin<Real>& skin, const FacePoint<Real>& start, const Vector3<Real>& p)
      : m_skin(skin), m_p(p), m_at(start), m_square(FindSquaredDistance(skin, start.face, p)) {}

  [[nodiscard]] const FacePoint<Real>& At() const { return m_at; }

  // Goes on to the nearest face round the corners; false if that is the present one.
  bool Step() {
    const Face corners = m_skin.faces[m_at.face];
    const Real squareOfAt = m_square;
    const Real tie = static_cast<Real>(kTieShare) * m_at.doubleArea;
    FacePoint<Real> best = m_at;
    std::array<RingBounds<Real>, 3> bounds;
    for (std::size_t i = 0; i < 3; ++i) {
      bounds[i].least = FindSeen(corners[i]);
      if (bounds[i].least > m_square + tie) continue;
      bounds[i].least = std::numeric_limits<Real>::max();
      LookRound(corners[i], tie, best, bounds[i]);
    }
    if (best.face == m_at.face) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      m_seen[i] = std::min(squareOfAt, bounds[i].FindLeastWithout(best.face));
    }
    m_seenCorners = corners;
    m_stepped = true;
    m_at = best;
    return true;
  }

 private:
  // A lower bound of the squared distances of the faces round the vertex but the present one, from the step before;
  // negative if they were not looked at.
  [[nodiscard]] Real FindSeen(std::uint16_t vertex) const {
    for (std::size_t i = 0; m_stepped && i < 3; ++i) {
      if (m_seenCorners[i] == vertex) return m_seen[i];
    }
    return Real(-1);
  }

  void LookRound(std::uint16_t vertex, Real tie, FacePoint<Real>& best, RingBounds<Real>& bounds) {
    std::span<const std::uint16_t> faces = m_skin.topology->RingOf(vertex);
    OfEachFace<Real> squares;
    OfEachFace<Real> boxes;
    for (std::size_t count = 0; !faces.empty(); faces = faces.subspan(count)) {
      const FaceRing<Real> ring(m_skin, faces, m_p);
      ring.FindSquares(squares, boxes);
      count = ring.Count();
      for (std::size_t i = 0; i < count; ++i) {
        if (faces[i] == m_at.face) continue;
        const Real square = boxes[i] > m_square + tie ? boxes[i] : squares[i];
        bounds.Note(faces[i], square);
        if (square > m_square + tie) continue;
        const FacePoint<Real> there = FindFacePoint(m_skin, faces[i], m_p);
        if (square < m_square - tie || there.distance > best.distance) {
          best = there;
          m_square = std::min(m_square, square);
        }
      }
    }
  }

  const Skin<Real>& m_skin;
  const Vector3<Real>& m_p;
  FacePoint<Real> m_at;
  Real m_square;  // of the distance of m_at, or of a face that ties with it, m²
  bool m_stepped = false;
  Face m_seenCorners{};          // of the face before m_at
  std::array<Real, 3> m_seen{};  // by these corners
};

// True if a point inside that belonged to `from` now belongs to `to`, across the side opposite to `corner`.
template <class Real>
bool SlidesOver(const Skin<Real>& skin, const FacePoint<Real>& from, std::size_t corner, const FacePoint<Real>& to) {
  const bool rises = to.distance > from.distance && IsConvex(skin, from, to.face);
  if (from.weights[static_cast<Eigen::Index>(corner)] >= Real(0)) {
    return rises && from.normal.dot(to.normal) > static_cast<Real>(kSmoothCosine);
  }
  const int back = FindCornerOpposite(*skin.topology, to.face, from.face);
  return rises || (back < 3 && to.weights[back] >= Real(0));
}

}  // namespace

template <class Real>
Real FindSquaredDistance(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p) {
  const Face& f = skin.faces[face];
  return FindSquaredDistance<Real>(skin.x[f[0]], skin.x[f[1]], skin.x[f[2]], p);
}

template <class Real>
FacePoint<Real> FindFacePoint(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p) {
  const Face& f = skin.faces[face];
  const Vector3<Real>& a = skin.x[f[0]];
  const Vector3<Real>& b = skin.x[f[1]];
  const Vector3<Real>& c = skin.x[f[2]];
  FacePoint<Real> at;
  at.face = face;
  const Vector3<Real> area = (b - a).cross(c - a);
  at.doubleArea = std::max(std::sqrt(area.dot(area)), std::numeric_limits<Real>::min());
  const Vector3<Real> normal = area / at.doubleArea;
  at.normal = skin.side * normal;
  at.distance = (p - a).dot(at.normal) - skin.offset;
  // A corner's weight is the area of the triangle between the foot and the opposite side, over the face's area.
  at.weights[1] = (p - a).cross(c - a).dot(normal) / at.doubleArea;
  at.weights[2] = (b - a).cross(p - a).dot(normal) / at.doubleArea;
  at.weights[0] = Real(1) - at.weights[1] - at.weights[2];
  return at;
}

template <class Real>
Vector3<Real> FindNearestWeights(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p) {
  Vector3<Real> best = FindFacePoint(skin, face, p).weights;
  if (best.minCoeff() >= Real(0)) return best;
  Real least = std::numeric_limits<Real>::max();
  const Face& f = skin.faces[face];
  for (int corner = 0; corner < 3; ++corner) {  // the nearest point of each side
    const int from = (corner + 1) % 3;
    const int to = (corner + 2) % 3;
    const Vector3<Real> side = skin.x[f[to]] - skin.x[f[from]];
    const Vector3<Real> ap = p - skin.x[f[from]];
    const Real square = side.dot(side);
    const Real along = square > Real(0) ? std::clamp(ap.dot(side) / square, Real(0), Real(1)) : Real(0);
    const Real distance = (ap - along * side).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best.setZero();
    best[from] = Real(1) - along;
    best[to] = along;
  }
  return best;
}

template <class Real>
FacePoint<Real> FindNearestFace(const Skin<Real>& skin, const FacePoint<Real>& start, const Vector3<Real>& p) {
  if (IsPlainlyNearest(skin, start, p)) return start;
  NearestFaceWalk<Real> walk(skin, start, p);
  for (int step = 0; step < kMaxSteps && walk.Step(); ++step) {
  }
  return walk.At();
}

template <class Real>
FacePoint<Real> FindFaceAround(const Skin<Real>& skin, std::uint16_t vertex, const Vector3<Real>& p) {
  FacePoint<Real> best;
  Real greatest = std::numeric_limits<Real>::lowest();
  std::span<const std::uint16_t> faces = skin.topology->RingOf(vertex);
  while (!faces.empty() && greatest < Real(0)) {
    const FaceRing<Real> ring(skin, faces, p);
    Real least = 0;
    const FacePoint<Real> at = ring.FindMostAbove(least);
    if (best.face == kNoFace || least > greatest) {
      best = at;
      greatest = least;
    }
    faces = faces.subspan(ring.Count());
  }
  return best;
}

template <class Real>
bool LooksAlong(const FacePoint<Real>& at, const Vector3<Real>& outward) {
  return (outward.array() != Real(0)).any() && at.normal.dot(outward) > static_cast<Real>(kFacingCosine);
}

template <class Real>
FacePoint<Real> TurnToFacing(const Skin<Real>& skin, const FacePoint<Real>& at, const Vector3<Real>& p,
                             const Vector3<Real>& outward, Real within) {
  if (!LooksAlong(at, outward)) return at;
  FacePoint<Real> best = at;
  Real least = within * within;
  if (!IsInside(skin, at)) {
    least = FindSquaredDistance(skin, at.face, p) + static_cast<Real>(kTieShare) * at.doubleArea;
  }
  for (const std::uint16_t vertex : skin.faces[at.face]) {
    for (const std::uint16_t face : skin.topology->RingOf(vertex)) {
      if (FindSquaredBoxDistance(skin, face, p) >= least) continue;
      const Real square = FindSquaredDistance(skin, face, p);
      if (square >= least) continue;
      const FacePoint<Real> there = FindFacePoint(skin, face, p);
      if (LooksAlong(there, outward)) continue;
      least = square;
      best = there;
    }
  }
  return best;
}

template <class Real>
Vector3<Real> FindOutward(const Skin<Real>& skin, std::uint16_t vertex) {
  Vector3<Real> sum = Vector3<Real>::Zero();
  for (const std::uint16_t face : skin.topology->RingOf(vertex)) {
    const Face& f = skin.faces[face];
    sum += (skin.x[f[1]] - skin.x[f[0]]).cross(skin.x[f[2]] - skin.x[f[0]]);
  }
  const Real length = std::sqrt(sum.dot(sum));
  if (length > Real(0)) sum /= length;
  return sum;
}

template <class Real>
FacePoint<Real> SlideToFace(const Skin<Real>& skin, const FacePoint<Real>& start, const Vector3<Real>& p) {
  FacePoint<Real> at = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    FacePoint<Real> best = at;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint16_t neighbour = skin.topology->neighbours[at.face][corner];
      if (neighbour == kNoFace) continue;
      const FacePoint<Real> there = FindFacePoint(skin, neighbour, p);
      if (!SlidesOver(skin, at, corner, there)) continue;
      if (best.face == at.face || there.distance > best.distance) best = there;
    }
    if (best.face == at.face) break;
    at = best;
  }
  return at;
}

template <class Real>
FacePoint<Real> FollowFace(const Skin<Real>& skin, std::uint16_t face, const Vector3<Real>& p) {
  const FacePoint<Real> at = FindFacePoint(skin, face, p);
  Eigen::Index corner = 0;
  if (at.weights.minCoeff(&corner) >= Real(0)) return at;
  const std::uint16_t neighbour = skin.topology->neighbours[face][static_cast<std::size_t>(corner)];
  if (neighbour == kNoFace) return at;
  const FacePoint<Real> there = FindFacePoint(skin, neighbour, p);
  return SlidesOver(skin, at, static_cast<std::size_t>(corner), there) ? there : at;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                   \
  template Real FindSquaredDistance<Real>(const Skin<Real>&, std::uint16_t, const Vector3<Real>&);                 \
  template Vector3<Real> FindNearestWeights<Real>(const Skin<Real>&, std::uint16_t, const Vector3<Real>&);         \
  template FacePoint<Real> FindFaceAround<Real>(const Skin<Real>&, std::uint16_t, const Vector3<Real>&);           \
  template FacePoint<Real> FindFacePoint<Real>(const Skin<Real>&, std::uint16_t, const Vector3<Real>&);            \
  template FacePoint<Real> FindNearestFace<Real>(const Skin<Real>&, const FacePoint<Real>&, const Vector3<Real>&); \
  template bool LooksAlong<Real>(const FacePoint<Real>&, const Vector3<Real>&);                                    \
  template FacePoint<Real> TurnToFacing<Real>(const Skin<Real>&, const FacePoint<Real>&, const Vector3<Real>&,     \
                                              const Vector3<Real>&, Real);                                         \
  template Vector3<Real> FindOutward<Real>(const Skin<Real>&, std::uint16_t);                                      \
  template FacePoint<Real> SlideToFace<Real>(const Skin<Real>&, const FacePoint<Real>&, const Vector3<Real>&);     \
  template FacePoint<Real> FollowFace<Real>(const Skin<Real>&, std::uint16_t, const Vector3<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
