// The body is cut into slabs across its longest side, as many as it has edges, and each edge is held against those of
// the slabs that begin within its reach. Most rows of this search find nothing, so a row is one pass without branches
// over the distances now and at rest, and only a row with a small distance is looked through.
//
// Tried first: boxes that are sorted along an axis; to sort them took as long as the search.
#include "server/physics/edges/self_contact.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace wobble::physics {
namespace {

// The search looks at least as far as edges that may meet are apart at rest, so that a body that finds nothing near is
// not looked at again for some ticks. Tried: as far as parts can come in four ticks; the bodies that move enough for it
// are then searched half as often, at three times the cost.
constexpr double kHorizonShare = kSelfApartShare;
// Makes the score of two edges that may not meet larger than any distance.
constexpr double kFar = 1e12;

// Edges that are first seen nearer than this share of the distance of touching have not come there from outside.
constexpr double kTangledShare = 0.5;
// Edges of a known contact that are nearer than this share cross one another in their plane: they have passed, and no
// sense is left in which the contact could push.
constexpr double kCrossedShare = 1e-3;

template <class Real>
using Column = Eigen::Map<const Eigen::Array<Real, Eigen::Dynamic, 1>>;

template <class Real>
Real Square(Real value) {
  return value * value;
}

// The distance from which two edges may come to touch in the tick, by their relative speed, m.
template <class Real>
Real FindReachOf(const EdgeMeeting<Real>& meeting, const SelfSearch<Real>& search, std::uint16_t first,
                 std::uint16_t second) {
  return meeting.radius + search.margin + FindTopSpeed(meeting, first, second) * search.duration;
}

template <class Real>
class SelfSweep {
 public:
  SelfSweep(const EdgeMeeting<Real>& meeting, const SelfSearch<Real>& search, SelfSearchScratch<Real>& scratch)
      : m_meeting(meeting), m_search(search), m_scratch(scratch), m_count(meeting.first.edges.size()) {
    (search.bounds.high - search.bounds.low).maxCoeff(&m_axis);
    for (const EdgeEnds& ends : meeting.first.edges) {
      m_half = std::max(m_half, (meeting.first.x[ends[0]] - meeting.first.x[ends[1]]).norm() / Real(2));
    }
    const Real reach = search.FindReach() + meeting.radius;
    m_far = std::max(reach, static_cast<Real>(kHorizonShare) * meeting.radius);
    m_horizon = m_far + Real(2) * m_half;
    m_near = HasRods() ? m_horizon : reach;
    m_apart = static_cast<Real>(kSelfApartShare) * meeting.radius;
  }

  // Fills in scratch.found, in the order of lists, with the pairs of balls that may touch in the tick. Returns the
  // least distance of two balls that may meet, at most how far it has looked, m. Of rods it has only seen middles and
  // boxes: there it returns how far it has looked, and found has all pairs that are nearer.
  Real Run() {
    m_scratch.found.clear();
    SortIntoSlabs();
    Real least = Square(m_horizon);
    for (std::size_t i = 0; i + 1 < m_count; ++i) least = std::min(least, LookAlong(i));
    std::sort(m_scratch.found.begin(), m_scratch.found.end());
    return HasRods() ? m_far : std::sqrt(least);
  }

  [[nodiscard]] bool HasRods() const { return m_half > Real(0); }

 private:
  [[nodiscard]] Vector3<Real> MiddleOf(std::size_t edge) const {
    const EdgeEnds& ends = m_meeting.first.edges[edge];
    return (m_meeting.first.x[ends[0]] + m_meeting.first.x[ends[1]]) / Real(2);
  }

  // NaN goes into the first slab.
  [[nodiscard]] std::size_t FindSlab(Real along) const {
    const Real low = m_search.bounds.low[m_axis];
    const Real share = (along - low) / (m_search.bounds.high[m_axis] - low) * static_cast<Real>(m_count);
    return share > Real(0) ? static_cast<std::size_t>(std::min(share, static_cast<Real>(m_count - 1))) : 0;
  }

  void SortIntoSlabs() {
    m_scratch.slabs.assign(m_count + 1, 0);
    m_scratch.slabOf.resize(m_count);
    for (std::size_t edge = 0; edge < m_count; ++edge) {
      const std::size_t slab = FindSlab(MiddleOf(edge)[m_axis]);
      m_scratch.slabOf[edge] = static_cast<std::uint16_t>(slab);
      ++m_scratch.slabs[slab + 1];
    }
    for (std::size_t slab = 0; slab < m_count; ++slab) m_scratch.slabs[slab + 1] += m_scratch.slabs[slab];
    m_scratch.order.resize(m_count);
    m_scratch.places.resize(6 * m_count);
    // Counts each slab's end down to its begin; from the last edge on, so that edges ascend within a slab.
    for (std::size_t edge = m_count; edge-- > 0;) {
      const std::size_t at = --m_scratch.slabs[m_scratch.slabOf[edge] + 1U];
      m_scratch.order[at] = static_cast<std::uint16_t>(edge);
      const EdgeEnds& ends = m_meeting.first.edges[edge];
      const Vector3<Real> now = MiddleOf(edge);
      const Vector3d rest = (m_search.rest[ends[0]] + m_search.rest[ends[1]]) / 2;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<Eigen::Index>(axis);
        m_scratch.places[axis * m_count + at] = now[i];
        m_scratch.places[(axis + 3) * m_count + at] = static_cast<Real>(rest[i]);
      }
    }
    // slabs[s + 1] is now the begin of slab s.
    m_scratch.slabs.erase(m_scratch.slabs.begin());
    m_scratch.slabs.push_back(static_cast<std::uint32_t>(m_count));
  }

  // The squared distance of the i-th edge in the order to each of those from `begin` up to `end`, now or at rest.
  [[nodiscard]] auto FindSquares(std::size_t i, std::size_t begin, std::size_t end, std::size_t column) const {
    const auto away = [&, this](std::size_t axis) {
      const Real* values = m_scratch.places.data() + (column + axis) * m_count;
      return (Column<Real>(values + begin, static_cast<Eigen::Index>(end - begin)) - values[i]).square();
    };
    return away(0) + away(1) + away(2);
  }

  // Whether two rods have no end in common, and the boxes round them are nearer to one another than m_far along every
  // axis.
  [[nodiscard]] bool MayMeet(const EdgeEnds& a, const EdgeEnds& b) const {
    if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) return false;
    const VectorView<Real>& x = m_meeting.first.x;
    const auto far = Vector3<Real>::Constant(m_far);
    const Vector3<Real> above = x[a[0]].cwiseMin(x[a[1]]) - x[b[0]].cwiseMax(x[b[1]]);
    const Vector3<Real> below = x[b[0]].cwiseMin(x[b[1]]) - x[a[0]].cwiseMax(x[a[1]]);
    return (above.array() < far.array()).all() && (below.array() < far.array()).all();
  }

  // Holds the i-th edge in the order against those after it. Returns the least squared distance of one that may meet
  // it.
  Real LookAlong(std::size_t i) {
    const Real along = m_scratch.places[static_cast<std::size_t>(m_axis) * m_count + i];
    const std::size_t begin = i + 1;
    const std::size_t end = m_scratch.slabs[FindSlab(along + m_horizon) + 1];
    if (begin >= end) return Square(m_horizon);
    m_scratch.scores.resize(std::max(m_scratch.scores.size(), m_count));
    Eigen::Map<Eigen::Array<Real, Eigen::Dynamic, 1>> scores(m_scratch.scores.data(),
                                                             static_cast<Eigen::Index>(end - begin));
    scores =
        FindSquares(i, begin, end, 0).max((Square(m_apart) - FindSquares(i, begin, end, 3)) * static_cast<Real>(kFar));
    const Real least = scores.minCoeff();
    if (!(least < Square(m_near))) return least;
    for (std::size_t j = begin; j < end; ++j) {
      if (!(m_scratch.scores[j - begin] < Square(m_near))) continue;
      const std::uint16_t a = m_scratch.order[i];
      const std::uint16_t b = m_scratch.order[j];
      if (HasRods() ? !MayMeet(m_meeting.first.edges[a], m_meeting.first.edges[b])
                    : m_scratch.scores[j - begin] > Square(FindReachOf(m_meeting, m_search, a, b))) {
        continue;
      }
      m_scratch.found.push_back({std::min(a, b), std::max(a, b)});
    }
    return least;
  }

  const EdgeMeeting<Real>& m_meeting;
  const SelfSearch<Real>& m_search;
  SelfSearchScratch<Real>& m_scratch;
  std::size_t m_count;
  Eigen::Index m_axis = 0;
  Real m_half = 0;     // of the longest edge, m
  Real m_far = 0;      // how far the search looks between edges, m
  Real m_horizon = 0;  // and between their middles, m
  Real m_near = 0;     // between middles that are found, m
  Real m_apart = 0;    // at rest, of edges that may meet, m
};

// Whether two edges are so far apart at rest that they may meet.
template <class Real>
bool AreApartAtRest(const EdgeMeeting<Real>& meeting, std::span<const Vector3d> rest, const EdgeEnds& pair) {
  const EdgeEnds& a = meeting.first.edges[pair[0]];
  const EdgeEnds& b = meeting.first.edges[pair[1]];
  const double apart = kSelfApartShare * double{meeting.radius};
  return FindSegmentDistance({rest[a[0]], rest[a[1]]}, {rest[b[0]], rest[b[1]]}) > apart;
}

}  // namespace

template <class Real>
Real FindSelfContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                      const SelfSearch<Real>& search, std::vector<EdgeContact<Real>>& contacts,
                      SelfSearchScratch<Real>& scratch) {
  SelfSweep<Real> sweep(meeting, search, scratch);
  Real least = sweep.Run();
  scratch.contacts.clear();
  bool isTangled = false;
  std::size_t from = 0;
  for (const EdgeEnds& pair : scratch.found) {
    if (!AreApartAtRest(meeting, search.rest, pair)) continue;
    const auto [first, second] = pair;
    const EdgeContact<Real>* known = FindKnown<Real>(contacts, first, second, from);
    const Vector3<Real> normal = known != nullptr ? known->normal : Vector3<Real>::Zero();
    const EdgeView<Real> view = FindEdgeView(meeting, first, second, normal);
    const Real distance = std::abs(view.distance);
    least = std::min(least, distance);
    if (distance > FindReachOf(meeting, search, first, second)) continue;
    isTangled |= distance < static_cast<Real>(known == nullptr ? kTangledShare : kCrossedShare) * meeting.radius;
    scratch.contacts.push_back(known != nullptr ? *known : MakeEdgeContact(parameters, meeting, first, second, view));
  }
  contacts.swap(scratch.contacts);
  if (isTangled) contacts.clear();
  return least - meeting.radius;
}

#define WOBBLE_INSTANTIATE(Real)                                                                 \
  template Real FindSelfContacts<Real>(const ContactParameters<Real>&, const EdgeMeeting<Real>&, \
                                       const SelfSearch<Real>&, std::vector<EdgeContact<Real>>&, \
                                       SelfSearchScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
