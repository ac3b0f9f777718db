// Contacts between edges of two bodies, where vertices against faces (body_contact.h) see nothing: springs and
// particles of `pair` and `graph` against one another and against the sides of skins; planar bodies in their plane; and
// the sharp edges of skins, as those of two cubes, which cross while no vertex is in a body. An edge is a capsule: all
// points within its radius. An edge whose ends are one vertex is a ball. Of two sharp edges the gap of their skins is
// the radius (skin_gap.h).
//
// Normal force. p = (1 − s) a + s b and q = (1 − t) c + t d are the points of the edges ab and cd that are nearest to
// one another, n is the unit vector from q to p, and D = n·(p − q). At depth r − D, r the sum of the radii, ab gets N n
// with N from the law in contact.h, split by 1 − s and s between its ends, and cd gets the opposite. Where p is not an
// end of its edge, p − q is normal to the edge, so ∂D/∂s = 0; where it is one, s is constant. In both cases this is the
// gradient of a potential, and its two forces act along one line: momentum and angular momentum are kept to rounding.
//
// Sense. Between two points within their edges, n keeps the sense that it had before (n·n_before > 0). So an edge that
// comes past the other's axis within a substep has a negative D and is pushed back to where it came from. At an end D
// is the distance and never negative: the normal turns by any angle as one end goes round another, so that n_before
// says nothing of the side, and a wrong sense would pull the edges together over any distance.
//
// Sharp edges. Two of them act only where both points are within their edges and each edge looks out: along n no face
// at the edge comes nearer to the other body, which is to say that n lies between the normals of its two faces (the
// arcs of the edges on the Gauss map cross: Gregorius, The separating axis test between convex polyhedra, 2013).
// Elsewhere a vertex is nearest, and its own contact holds it. The arcs give n its sense too; of two edges that look
// out in both senses, borders of sheets, the sense of before is kept. Where the faces turn so far within a substep that
// the sense changes, so does the sign of D, and the contact has no force until the end of that substep: depth that
// appears at once would be energy from nowhere.
//
// Sides of sheets. A rod whose ends are both on one side of an open skin belongs there with all of its length. A
// contact that would hold it on the other, as where the sheet has folded over it, is turned round at the beginning of a
// tick.
//
// Friction. A force F at p and −F at q, both normal to n, leave the torque D n × F. A rod has no spin about its own
// axis, so it can bear only the part of this torque that its ends balance by forces along n: for F along the edge ab,
// that is ∓ D (F·u)/|ab| n on b and a, u the edge's direction. So friction acts along ab where p is not an end, and, of
// the rest, along cd where q is not one. Two balls have none, as two points on springs cannot bear it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/physics/model/topology.h"
#include "server/physics/skins/body_contact.h"

namespace wobble::physics {

// What a contact does. "Begin": at the beginning of a tick; "end": after a substep.
//
//   from                    when                                             to
//   (none)                  begin: found; sharp edges that do not look out   kFree; kTurned
//   kFree, kTouching        end: it pushes; it does not                      kTouching; kFree
//   kFree, kTouching        end: sharp edges do not look out in this sense   kTurned; depth, leap and stick spring end
//   kTurned                 end: both look out in the sense of before        kFree or kTouching; the depth becomes leap
enum class EdgePhase : std::uint8_t {
  kFree,      // a force as soon as it pushes, without a stick spring
  kTouching,  // it pushed at the end of the last substep: slip, s and t describe the stick spring
  kTurned,    // no force: other parts of the two skins are nearer
};

// An edge of a pair's first body near an edge of its second. Lists are sorted by `first`, then `second`; all fields
// live on from tick to tick.
template <class Real>
struct EdgeContact {
  std::uint16_t first = 0;  // places in the bodies' lists of edges
  std::uint16_t second = 0;
  EdgePhase phase = EdgePhase::kFree;
  Real depth = 0;  // pushed back at the end of the last substep, m; negative apart
  Real leap = 0;   // depth beyond `depth` that no motion has brought: not pushed back, m
  Real s = 0;      // of the nearest points at the last substep's end
  Real t = 0;
  Vector3<Real> normal = Vector3<Real>::UnitZ();  // from the second edge to the first, unit length
  Vector3<Real> slip = Vector3<Real>::Zero();     // of the stick spring at the last substep's end, m
};

// The order of lists.
template <class Real>
[[nodiscard]] bool IsListedBefore(const EdgeContact<Real>& a, const EdgeContact<Real>& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

// The edges of two bodies at one moment.
template <class Real>
struct EdgeMeeting {
  struct Body {
    std::span<const EdgeEnds> edges;
    VectorView<Real> x;                     // in the body's own local coordinates, m
    VectorView<Real> v;                     // m/s
    std::span<const Real> shares;           // Coefficients::contactShares
    std::span<const EdgeWings> wings = {};  // of sharp edges, one an edge; empty: the edges are rods
  };
  Body first;
  Body second;
  Vector3<Real> shift = Vector3<Real>::Zero();  // from the first body's coordinates to the second's, m
  Real radius = 0;                              // of both edges together, m

  [[nodiscard]] bool AreSharp() const { return !first.wings.empty(); }
};

// The force of one contact, N, on the ends of the first edge and of the second.
template <class Real>
struct EdgeForce {
  bool acts = false;  // false: the other fields are not set
  std::array<std::uint16_t, 4> vertices{};
  std::array<Vector3<Real>, 4> forces;
};

// What a contact sees at one moment.
template <class Real>
struct EdgeView {
  struct Side {
    Vector3<Real> direction = Vector3<Real>::Zero();  // of the edge, unit length
    Real length = 0;                                  // m; 0 for a ball
    bool inside = false;                              // the nearest point is not an end
  };
  Side first;
  Side second;
  Real s = 0;
  Real t = 0;
  Vector3<Real> normal;
  Real distance = 0;       // D, m
  bool looksOut = true;    // false: sharp edges, and other parts of the two skins are nearer, or the sense changes
  Vector3<Real> velocity;  // of p against q, m/s
};

// The distance of two segments, m. Segments may be points.
[[nodiscard]] double FindSegmentDistance(const std::array<Vector3d, 2>& first, const std::array<Vector3d, 2>& second);

// normal: n_before of the header, unit length; zero to take the sense from q to p, of sharp edges that of the arcs.
template <class Real>
[[nodiscard]] EdgeView<Real> FindEdgeView(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second,
                                          const Vector3<Real>& normal);

// Whether two sharp edges may look out at one another before the tick is over: only such are listed.
template <class Real>
[[nodiscard]] bool MayLookOut(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second);

// The largest relative speed of two edges' ends, m/s. Rods are light and turn fast: within a tick their nearest points
// may be others, that come nearer when these do not.
template <class Real>
[[nodiscard]] Real FindTopSpeed(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second);

// Writes one force per contact. forces: as many as contacts.
template <class Real>
void ComputeEdgeContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                         std::span<const EdgeContact<Real>> contacts, std::span<EdgeForce<Real>> forces);

// After a substep of h s: the sense of each contact, its leap, and its stick spring, which slips as far as friction
// cannot hold it.
template <class Real>
void UpdateEdgeContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting, Real h,
                        std::span<EdgeContact<Real>> contacts);

// The energy that the springs hold, normal and stick, J.
template <class Real>
[[nodiscard]] double ComputeEdgeContactEnergy(const ContactParameters<Real>& parameters,
                                              const EdgeMeeting<Real>& meeting,
                                              std::span<const EdgeContact<Real>> contacts);

// AddContactLoads of body_contact.h, for edges. loads, secondLoads: by vertex of each body.
template <class Real>
[[nodiscard]] int AddEdgeContactLoads(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                                      std::span<const EdgeContact<Real>> contacts, double duration,
                                      std::span<VertexLoad> loads, std::span<VertexLoad> secondLoads);

// An open skin, and what is known of the sides that the other body's vertices are on.
template <class Real>
struct SkinSeen {
  const Topology* topology = nullptr;  // null: the body has no open skin
  std::span<const Face> faces;
  std::span<const BodyContact<Real>> contacts;  // of vertices of the other body with these faces
};

// The inputs of the search at the beginning of a tick.
template <class Real>
struct EdgeSearch {
  Bounds<Real> first;  // of each body, in its own coordinates
  Bounds<Real> second;
  Real margin = 0;    // for motion that the present velocities do not tell, m
  Real duration = 0;  // of the tick, s
  // The rest is of rods alone; sharp edges need none of it. Vertices of each body that are behind the other, an open
  // skin (IsBehind of body_contact.h); ascending.
  std::span<const std::uint16_t> firstBehind = {};
  std::span<const std::uint16_t> secondBehind = {};
  SkinSeen<Real> skinOfFirst = {};
  SkinSeen<Real> skinOfSecond = {};
};

// The contact of two edges in a list; null if it has none. Searches ask in the list's order: `from` is the first place
// that may have it, and moves on.
template <class Real>
[[nodiscard]] const EdgeContact<Real>* FindKnown(std::span<const EdgeContact<Real>> list, std::uint16_t first,
                                                 std::uint16_t second, std::size_t& from) {
  const EdgeContact<Real> wanted{.first = first, .second = second};
  while (from < list.size() && IsListedBefore(list[from], wanted)) ++from;
  return from < list.size() && !IsListedBefore(wanted, list[from]) ? &list[from] : nullptr;
}

// A contact that begins as `view` shows it. Depth that no motion has brought is leap.
template <class Real>
[[nodiscard]] EdgeContact<Real> MakeEdgeContact(const ContactParameters<Real>& parameters,
                                                const EdgeMeeting<Real>& meeting, std::uint16_t first,
                                                std::uint16_t second, const EdgeView<Real>& view);

// Kept by the caller to save allocations.
template <class Real>
struct EdgeSearchScratch {
  std::vector<EdgeContact<Real>> contacts;
  std::vector<std::uint16_t> first;
  std::vector<std::uint16_t> second;
};

// Replaces `contacts` by one contact for every two edges that may touch before the tick is over. Contacts that were in
// the old list keep their state. Rods are light, so the speeds of both bodies count, not the present approach. Cost:
// one box test for each edge, and for each two edges that lie near the other body.
template <class Real>
void FindEdgeContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                      const EdgeSearch<Real>& search, std::vector<EdgeContact<Real>>& contacts,
                      EdgeSearchScratch<Real>& scratch);

}  // namespace wobble::physics
