// Vertices of one skin against the faces of another, in two passes. First, in vectors, all vertices against a box and a
// ball that hold the other skin. Then each vertex that is left: its nearest vertex of the other skin, in vectors, and
// from there a walk over faces. A contact of the last tick begins its walk on the face that it had.
#include "server/physics/skins/body_contact_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/skins/body_contact_update.h"
#include "server/physics/skins/body_contact_view.h"

namespace wobble::physics {
namespace {

// The number of substeps that a contact is taken to have at the beginning of a tick, before their number is known.
constexpr double kLikelySubsteps = 4;

// The search of one side of a pair.
template <class Real>
class SideSearch {
 public:
  SideSearch(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const Skin<Real>& own,
             const ContactSearch<Real>& search)
      : m_parameters(parameters),
        m_meeting(meeting),
        m_own(own),
        m_search(search),
        m_isOpen(meeting.skin.topology->isOpen),
        m_bothClosed(!m_isOpen && !own.topology->isOpen),
        m_velocity(m_search.vertices->Velocity() - m_search.skin->Velocity()) {}

  // The vertices that lie in `near` and near enough to the ball that holds the skin, as indices into
  // topology.vertices, ascending. `found` holds the result.
  std::span<const std::uint16_t> FindCandidates(std::vector<std::uint16_t>& found) const {
    const Vector3<Real> toCentre = m_search.skin->Centre() - m_meeting.shift;
    const Real apart = m_search.skin->Radius() + FindReach(m_velocity, m_search.vertices->Agitation());
    const Real farthest = apart + m_search.vertices->Radius();
    const Real square = farthest * farthest;
    // A body that is behind an open skin is looked at however far it has come. Beyond what numbers of this precision
    // hold nothing is near: the points that fill up the last lanes would be, too.
    if (!((m_search.vertices->Centre() - toCentre).squaredNorm() <= square) || std::isinf(square)) return {};
    NearRegion<Real> region;
    for (int axis = 0; axis < 3; ++axis) {
      region.low[axis] = m_search.near.low[axis] - m_meeting.shift[axis];
      region.high[axis] = m_search.near.high[axis] - m_meeting.shift[axis];
      region.centre[axis] = toCentre[axis];
    }
    region.squaredRadius = apart * apart;
    const PointLanes<Real> points = m_search.vertices->Lanes();
    found.resize(points.count);
    return std::span(found).first(m_search.kernel.findWithin(points, region, found.data()));
  }

  // True if the vertex may touch; `contact` is then as the tick begins. known: `contact` is from the last tick.
  bool Look(std::uint16_t vertex, bool known, BodyContact<Real>& contact) const {
    const Vector3<Real> p = m_meeting.x[vertex] + m_meeting.shift;
    FacePoint<Real> at;
    if (known) {
      if (m_bothClosed) contact.outward = FindOutward(m_own, vertex);
      at = RecallContact(m_parameters, m_meeting, p, contact);
    } else if (!FindFirstFace(p, at, contact)) {
      return false;
    }
    const Vector3<Real> velocity = FindRelativeVelocity(m_meeting, vertex, at);
    if (IsOutOfReach(at, velocity)) return false;
    if (!known) FadeGap(m_meeting.skin, at);
    Arm(m_parameters, velocity, m_search.duration / static_cast<Real>(kLikelySubsteps), m_meeting.skin, at, contact);
    if (!known) contact.depth = -at.distance;
    contact.face = at.face;
    contact.foot = at.weights;
    return true;
  }

 private:
  // Upper bound of the distance at which IsOutOfReach is false for a vertex whose velocity against the skin's is
  // `velocity`, give or take `agitation`.
  Real FindReach(const Vector3<Real>& velocity, Real agitation) const {
    const Real fastest = std::sqrt(velocity.dot(velocity)) + agitation + m_search.skin->Agitation();
    return m_search.margin + (m_isOpen ? m_search.near.speed : fastest) * m_search.duration;
  }

  // At an open skin the largest speed of the two bodies counts, not the present approach: a sheet is light, so its
  // present motion hardly tells its next, and a vertex that crosses it unseen is never brought back.
  bool IsOutOfReach(const FacePoint<Real>& at, const Vector3<Real>& velocity) const {
    const Real approach = m_isOpen ? m_search.near.speed : std::max(Real(0), -at.normal.dot(velocity));
    return at.distance + m_meeting.skin.offset > m_search.margin + approach * m_search.duration;
  }

  // Finds the face, side and outward normal of a vertex without a contact; false if the skin is out of reach. With D
  // the distance to the skin's nearest vertex and d that to the skin, D² ≤ d² + SquaredGap: most vertices need no walk.
  bool FindFirstFace(const Vector3<Real>& p, FacePoint<Real>& at, BodyContact<Real>& contact) const {
    const Real reach = FindReach(m_meeting.v[contact.vertex] - m_search.skin->Velocity(), Real(0));
    const NearestPoint<Real> nearest = m_search.kernel.findNearest(m_search.skin->Lanes(), p.data());
    if (nearest.square > reach * reach + m_search.skin->SquaredGap()) return false;
    const Skin<Real>& skin = m_meeting.skin;
    at = FindNearestFace(skin, FindFaceAround(skin, skin.topology->vertices[nearest.index], p), p);
    if (at.distance > reach) return false;
    // A vertex straight above this face has no nearer face, so neither the outward normal nor the side is needed.
    const bool isAbove = !IsInside(skin, at) && at.weights.minCoeff() >= Real(0);
    if (isAbove && IsOutOfReach(at, FindRelativeVelocity(m_meeting, contact.vertex, at))) return false;
    if (m_bothClosed) contact.outward = FindOutward(m_own, contact.vertex);
    at = ChooseSide(m_meeting, at, p, contact.outward, contact.side);
    return true;
  }

  const ContactParameters<Real>& m_parameters;
  const Meeting<Real>& m_meeting;
  const Skin<Real>& m_own;
  const ContactSearch<Real>& m_search;
  bool m_isOpen;
  bool m_bothClosed;
  Vector3<Real> m_velocity;  // of the vertices' skin against the faces', m/s
};

}  // namespace

template <class Real>
void FindBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const Skin<Real>& own,
                      const ContactSearch<Real>& search, std::vector<BodyContact<Real>>& contacts,
                      ContactSearchScratch<Real>& scratch) {
  const SideSearch<Real> side(parameters, meeting, own, search);
  scratch.contacts.clear();
  auto kept = contacts.begin();
  const auto look = [&](bool known, BodyContact<Real> contact) {
    if (side.Look(contact.vertex, known, contact)) scratch.contacts.push_back(contact);
  };
  // Of the contacts whose vertices are not near, those behind an open skin are kept.
  const auto skipUpTo = [&](std::size_t vertex) {
    for (; kept != contacts.end() && kept->vertex < vertex; ++kept) {
      if (IsBehind(*meeting.skin.topology, *kept)) look(true, *kept);
    }
  };
  for (const std::uint16_t index : side.FindCandidates(scratch.found)) {
    const std::uint16_t vertex = own.topology->vertices[index];
    skipUpTo(vertex);
    const bool known = kept != contacts.end() && kept->vertex == vertex;
    look(known, known ? *kept++ : BodyContact<Real>{.vertex = vertex});
  }
  skipUpTo(std::numeric_limits<std::size_t>::max());
  contacts.swap(scratch.contacts);
}

#define WOBBLE_INSTANTIATE(Real)                                                                                \
  template void FindBodyContacts<Real>(const ContactParameters<Real>&, const Meeting<Real>&, const Skin<Real>&, \
                                       const ContactSearch<Real>&, std::vector<BodyContact<Real>>&,             \
                                       ContactSearchScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
