// Boxes round each edge against the other body's bounds first, then every two edges that are left. Those near another
// body are few: a tree or a grid over edges would cost more than it saves.
#include <algorithm>
#include <cmath>

#include "server/physics/edges/edge_contact.h"

namespace wobble::physics {
namespace {

// Least cosine between a contact's normal and a skin's for the skin to tell on which side of it the contact holds.
constexpr double kTellingCosine = 0.3;

template <class Real>
struct EdgeBox {
  Vector3<Real> low;
  Vector3<Real> high;
};

template <class Real>
EdgeBox<Real> FindBox(const typename EdgeMeeting<Real>::Body& body, std::uint16_t edge, const Vector3<Real>& shift) {
  const Vector3<Real> a = body.x[body.edges[edge][0]] + shift;
  const Vector3<Real> b = body.x[body.edges[edge][1]] + shift;
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

template <class Real>
bool AreNear(const EdgeBox<Real>& a, const EdgeBox<Real>& b, Real reach) {
  return (a.low.array() <= b.high.array() + reach).all() && (b.low.array() <= a.high.array() + reach).all();
}

// The edges of `body`, moved by `shift`, within `reach` of a box.
template <class Real>
void ListNear(const typename EdgeMeeting<Real>::Body& body, const Vector3<Real>& shift, const EdgeBox<Real>& box,
              Real reach, std::vector<std::uint16_t>& near) {
  near.clear();
  for (std::size_t edge = 0; edge < body.edges.size(); ++edge) {
    const auto index = static_cast<std::uint16_t>(edge);
    if (AreNear(FindBox<Real>(body, index, shift), box, reach)) near.push_back(index);
  }
}

// Whether the end that is nearer to the edge's point at `along` is among the vertices `behind`.
template <class Real>
bool IsNearEndBehind(const EdgeEnds& edge, Real along, std::span<const std::uint16_t> behind) {
  return std::ranges::binary_search(behind, edge[along < Real(0.5) ? 0 : 1]);
}

// 1 or −1: the side of the skin that both ends of the edge are on, its front or its back; 0 if that is not known.
template <class Real>
int FindSide(const EdgeEnds& edge, std::span<const BodyContact<Real>> contacts) {
  int side = 0;
  for (const std::uint16_t end : edge) {
    const auto at = std::ranges::lower_bound(contacts, end, {}, &BodyContact<Real>::vertex);
    if (at == contacts.end() || at->vertex != end || at->phase == ContactPhase::kWaiting) return 0;
    const int ofEnd = at->side == SkinSide::kBack ? -1 : 1;
    if (side == -ofEnd) return 0;
    side = ofEnd;
  }
  return side;
}

// Whether a contact would hold `edge` on the side of the skin that it does not belong to. side: of a face of the skin.
// normal: from there to the edge. x: of the skin's vertices. Where the two faces of the side are steep against the
// normal, they do not tell.
template <class Real>
bool HoldsOnWrongSide(const EdgeEnds& edge, const EdgeEnds& side, const SkinSeen<Real>& skin, const VectorView<Real>& x,
                      const Vector3<Real>& normal) {
  if (skin.topology == nullptr) return false;
  const int belongs = FindSide<Real>(edge, skin.contacts);
  if (belongs == 0) return false;
  Vector3<Real> front = Vector3<Real>::Zero();
  for (const std::uint16_t face : skin.topology->RingOf(side[0])) {
    const Face& f = skin.faces[face];
    if (std::ranges::find(f, side[1]) != f.end()) front += (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]);
  }
  const Real steepness = static_cast<Real>(kTellingCosine) * std::sqrt(front.dot(front));
  return static_cast<Real>(belongs) * front.dot(normal) < -steepness;
}

}  // namespace

template <class Real>
EdgeContact<Real> MakeEdgeContact(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                                  std::uint16_t first, std::uint16_t second, const EdgeView<Real>& view) {
  const Real depth = meeting.radius - view.distance;
  EdgeContact<Real> contact{.first = first, .second = second};
  if (!view.looksOut) {
    contact.phase = EdgePhase::kTurned;
    contact.normal = view.normal;
    return contact;
  }
  contact.leap = std::max(Real(0), depth - FindFreeDepth(parameters));
  contact.depth = depth - contact.leap;
  contact.normal = view.normal;
  contact.s = view.s;
  contact.t = view.t;
  return contact;
}

template <class Real>
void FindEdgeContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                      const EdgeSearch<Real>& search, std::vector<EdgeContact<Real>>& contacts,
                      EdgeSearchScratch<Real>& scratch) {
  scratch.contacts.clear();
  const Real reach = meeting.radius + search.margin + (search.first.speed + search.second.speed) * search.duration;
  ListNear<Real>(meeting.first, meeting.shift, {search.second.low, search.second.high}, reach, scratch.first);
  ListNear<Real>(meeting.second, -meeting.shift, {search.first.low, search.first.high}, reach, scratch.second);
  std::size_t from = 0;
  for (const std::uint16_t first : scratch.first) {
    const EdgeBox<Real> box = FindBox<Real>(meeting.first, first, meeting.shift);
    for (const std::uint16_t second : scratch.second) {
      if (!AreNear(box, FindBox<Real>(meeting.second, second, Vector3<Real>::Zero()), reach)) continue;
      if (meeting.AreSharp() && !MayLookOut(meeting, first, second)) continue;
      const EdgeContact<Real>* known = FindKnown<Real>(contacts, first, second, from);
      const Vector3<Real> normal = known != nullptr ? known->normal : Vector3<Real>::Zero();
      EdgeView<Real> view = FindEdgeView(meeting, first, second, normal);
      if (std::abs(view.distance) > reach) continue;
      const EdgeEnds& ofFirst = meeting.first.edges[first];
      const EdgeEnds& ofSecond = meeting.second.edges[second];
      const bool isWrong =
          HoldsOnWrongSide<Real>(ofFirst, ofSecond, search.skinOfSecond, meeting.second.x, view.normal) ||
          HoldsOnWrongSide<Real>(ofSecond, ofFirst, search.skinOfFirst, meeting.first.x, -view.normal);
      if (isWrong) known = nullptr;
      // Where edges meet anew behind an open skin, they must not hold one another there: an edge is let through on its
      // way back, and held from then on.
      if (known == nullptr && (isWrong || IsNearEndBehind(ofFirst, view.s, search.firstBehind) ||
                               IsNearEndBehind(ofSecond, view.t, search.secondBehind))) {
        view = FindEdgeView<Real>(meeting, first, second, -view.normal);
        if (view.distance > Real(0)) continue;
      }
      scratch.contacts.push_back(known != nullptr ? *known : MakeEdgeContact(parameters, meeting, first, second, view));
    }
  }
  contacts.swap(scratch.contacts);
}

#define WOBBLE_INSTANTIATE(Real)                                                                             \
  template EdgeContact<Real> MakeEdgeContact<Real>(const ContactParameters<Real>&, const EdgeMeeting<Real>&, \
                                                   std::uint16_t, std::uint16_t, const EdgeView<Real>&);     \
  template void FindEdgeContacts<Real>(const ContactParameters<Real>&, const EdgeMeeting<Real>&,             \
                                       const EdgeSearch<Real>&, std::vector<EdgeContact<Real>>&,             \
                                       EdgeSearchScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
