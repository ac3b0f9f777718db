// The springs between the cores of members of a system (skins/core_contact.h), as SystemEdges has edge contacts.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/step/member.h"
#include "server/physics/step/system_contacts.h"

namespace wobble::physics {

template <class Real>
class SystemCores {
 public:
  // Makes room for so many pairs.
  void Reserve(std::size_t pairs) { m_pairs.reserve(pairs); }

  // Takes over the springs that may act in this tick. The members must live until the next Build.
  void Build(std::span<const ContactPair<Real>> contactPairs, std::span<Member<Real>* const> members);

  // motions: one a member.
  void ComputeForces(std::span<const Motion<Real>> motions);

  // Calls add(vertex, force in N) for every force on the member that ComputeForces found.
  template <class Add>
  void VisitForcesOn(std::size_t member, const Add& add) const {
    for (const Pair& pair : m_pairs) {
      if (!pair.acts || (pair.members[0] != member && pair.members[1] != member)) continue;
      const Blueprint& blueprint = *m_members[member]->blueprint;
      const double sense = pair.members[0] == member ? -1 : 1;
      const Vector3d acceleration = sense / blueprint.totalMass * pair.force;
      for (std::size_t i = 0; i < blueprint.rest.size(); ++i) {
        const Vector3d force = blueprint.full.masses[i] * acceleration;
        add(static_cast<std::uint16_t>(i), Vector3<Real>(force.template cast<Real>()));
      }
    }
  }

 private:
  struct Pair {
    std::array<std::uint32_t, 2> members{};
    CoreContact contact;
    Vector3d shift;  // from the first's local coordinates to the second's, m
    bool acts = false;
    Vector3d force;  // on the second, N
  };

  std::span<Member<Real>* const> m_members;
  std::vector<Pair> m_pairs;
};

}  // namespace wobble::physics
