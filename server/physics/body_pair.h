// Pairs of bodies near one another, and what their contacts remember.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "server/physics/contact/broad_phase.h"
#include "server/physics/edges/edge_contact.h"
#include "server/physics/skins/body_contact.h"
#include "server/physics/skins/core_contact.h"
#include "server/physics/skins/untangling.h"
#include "server/physics/step/body.h"

namespace wobble::physics {

// Two bodies near one another, with the contacts between them, which live on from tick to tick. first < second, or
// equal: a body near itself, which has edge contacts, a tangle and pulls alone.
template <class Real>
struct BodyPair {
  BodyId first = 0;
  BodyId second = 0;
  IndexPair places{};                                   // of the two in the world's list of bodies
  std::array<std::vector<BodyContact<Real>>, 2> sides;  // as in ContactPair
  std::vector<EdgeContact<Real>> edges;
  CoreContact core;
  double gap = 0;  // at which the skins begin to push, m (skins/skin_gap.h)
  Tangle tangle;
  Pulls<Real> pulls;  // of this tick, that take the skins apart
  bool met = false;   // the contacts have been searched for in this tick

  [[nodiscard]] bool IsSelf() const { return first == second; }
  [[nodiscard]] bool Has(BodyId body) const { return first == body || second == body; }
  // 0 or 1: whether a body that the pair has is its first or its second. sides[SideOf(body)] are contacts of the body's
  // vertices, the other side contacts with its faces.
  [[nodiscard]] std::size_t SideOf(BodyId body) const { return first == body ? 0 : 1; }
  [[nodiscard]] BodyId OtherThan(BodyId body) const { return first == body ? second : first; }
  // At the end of the last step that it was in.
  [[nodiscard]] bool IsTouching() const {
    const auto touches = [](const BodyContact<Real>& contact) { return contact.phase == ContactPhase::kTouching; };
    return std::any_of(sides[0].begin(), sides[0].end(), touches) ||
           std::any_of(sides[1].begin(), sides[1].end(), touches) ||
           std::any_of(edges.begin(), edges.end(),
                       [](const EdgeContact<Real>& contact) { return contact.phase == EdgePhase::kTouching; });
  }
};

template <class Real>
bool ComesBefore(const BodyPair<Real>& a, const BodyPair<Real>& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

}  // namespace wobble::physics
