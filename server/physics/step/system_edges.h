// Edge contacts between the members of a system (edges/edge_contact.h), as SystemContacts keeps those of vertices
// with faces: forces are computed for all contacts first and added up member by member afterwards, always in one order.
#pragma once

#include <span>
#include <vector>

#include "server/physics/model/parallel.h"
#include "server/physics/step/member.h"
#include "server/physics/step/system_contacts.h"

namespace wobble::physics {

template <class Real>
class SystemEdges {
 public:
  // Takes over the edge contacts of these pairs and notes them as they are. The pairs keep their lists: until the next
  // Build these and the members' blueprints must live, and no list may get longer or shorter.
  void Build(std::span<const ContactPair<Real>> contactPairs, std::span<Member<Real>* const> members);

  // Computes the forces of all contacts. motions: one a member; threads: null for the calling thread alone.
  void ComputeForces(std::span<const Motion<Real>> motions, Threads* threads);
  // Brings all contacts up to date after a substep of h s.
  void Update(std::span<const Motion<Real>> motions, Real h, Threads* threads) const;

  // Calls add(vertex, force in N) for every force on the member that ComputeForces found.
  template <class Add>
  void VisitForcesOn(std::size_t member, const Add& add) const {
    if (m_pairs.empty()) return;
    for (std::size_t i = m_sidesBegin[member]; i < m_sidesBegin[member + 1]; ++i) {
      const Pair& pair = m_pairs[m_sides[i] / 2];
      const std::size_t from = 2 * (m_sides[i] % 2);  // ends of the first edge, or of the second
      for (std::size_t at = pair.begin; at < pair.end; ++at) {
        const EdgeForce<Real>& force = m_forces[at];
        if (!force.acts) continue;
        add(force.vertices[from], force.forces[from]);
        add(force.vertices[from + 1], force.forces[from + 1]);
      }
    }
  }

  // The contacts of a contact pair as Build found them.
  [[nodiscard]] std::span<const EdgeContact<Real>> Before(std::size_t contactPair) const {
    for (const Pair& pair : m_pairs) {
      if (pair.contactPair == contactPair) return std::span(m_before).subspan(pair.begin, pair.end - pair.begin);
    }
    return {};
  }
  // Puts the contacts of contact pairs from `begin` up to `end` back to what they were.
  void PutBack(std::size_t begin, std::size_t end) const;

 private:
  // A contact pair that has edge contacts; they are those from begin up to end of the system's.
  struct Pair {
    std::size_t contactPair = 0;
    std::array<std::uint32_t, 2> members{};
    std::vector<EdgeContact<Real>>* contacts = nullptr;
    std::size_t begin = 0;
    std::size_t end = 0;
    ContactParameters<Real> parameters;
    EdgeMeeting<Real> meeting;  // without positions and velocities
  };

  [[nodiscard]] static EdgeMeeting<Real> Meet(const Pair& pair, std::span<const Motion<Real>> motions);
  template <class Visit>
  void ForEachPair(Threads* threads, const Visit& visit) const;

  std::vector<Pair> m_pairs;
  std::vector<EdgeContact<Real>> m_before;
  std::vector<EdgeForce<Real>> m_forces;
  std::vector<std::size_t> m_sides;  // 2 p + s: side s of m_pairs[p], by member, from m_sidesBegin[member] on
  std::vector<std::size_t> m_sidesBegin;
};

}  // namespace wobble::physics
