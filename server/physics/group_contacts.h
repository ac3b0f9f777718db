// Contacts between the members of a group, all in one list, so that their forces come as many at a time as a vector has
// lanes, and bodies that share neighbours can be worked on at the same time: what acts on a member is added up by
// itself, in one order.
#pragma once

#include <span>
#include <vector>

#include "server/physics/body_contact.h"
#include "server/physics/lanes/sweep.h"
#include "server/physics/parallel.h"

namespace wobble::physics {

template <class Real>
struct Member;
template <class Real>
struct Encounter;

// Of one member's vertices, local coordinates: m, m/s.
template <class Real>
struct Motion {
  std::span<const Vector3<Real>> x;
  std::span<const Vector3<Real>> v;
};

template <class Real>
class GroupContacts {
 public:
  // Room for so many contacts, between so many bodies.
  void Reserve(std::size_t contacts, std::size_t bodies);
  // Those of encounters between these members. The encounters' lists stay theirs; they and the members' blueprints must
  // live, and no list may get longer or shorter, until the next Build.
  void Build(std::span<const Encounter<Real>> encounters, std::span<Member<Real>* const> members,
             const SweepKernel<Real>& kernel);
  // After the lists' contacts have been changed by somebody else.
  void ReadLists();

  [[nodiscard]] bool IsEmpty() const { return m_forces.empty(); }

  // motions: of each member, in the members' order; of one that meets nobody they may be empty. threads: null: this
  // one alone. The result does not depend on it.
  void ComputeForces(std::span<const Motion<Real>> motions, Threads* threads);

  // Calls add(vertex, force in N) for every push on the member that ComputeForces found, in an order that depends on
  // the encounters alone; a vertex may come several times. May be called for several members at the same time.
  template <class Add>
  void VisitForcesOn(std::size_t member, const Add& add) const {
    for (std::size_t i = m_sidesBegin[member]; i < m_sidesBegin[member + 1]; ++i) {
      const Side& side = m_sides[m_sidesOf[i]];
      const std::span forces = std::span(m_forces).subspan(side.begin, side.contacts->size());
      for (const ContactForce<Real>& force : forces) {
        if (!force.acts) continue;
        if (side.ofVertices == member) {
          add(force.vertex, force.onVertex);
        } else {
          for (std::size_t corner = 0; corner < 3; ++corner) add(force.corners[corner], force.onCorners[corner]);
        }
      }
    }
  }

  // After a substep of h seconds: as UpdateBodyContacts, in the encounters' lists.
  void Update(std::span<const Motion<Real>> motions, Real h, Threads* threads);

 private:
  // One body's vertices against another's faces.
  struct Side {
    std::uint32_t ofVertices = 0;  // members
    std::uint32_t ofFaces = 0;
    std::vector<BodyContact<Real>>* contacts = nullptr;
    std::size_t begin = 0;  // of its contacts among all
    ContactParameters<Real> parameters;
    Meeting<Real> meeting;  // but for the motion
  };

  [[nodiscard]] Meeting<Real> Meet(const Side& side, std::span<const Motion<Real>> motions) const;
  void ListSidesOfMembers(std::size_t members);
  template <class Visit>
  static void ForEach(std::size_t count, Threads* threads, const Visit& visit);

  const SweepKernel<Real>* m_kernel = nullptr;
  std::vector<Side> m_sides;
  std::vector<std::uint32_t> m_sidesOf;  // those that member m has a part in, ascending, from m_sidesBegin[m] on
  std::vector<std::size_t> m_sidesBegin;
  std::vector<ContactForce<Real>> m_forces;
};

}  // namespace wobble::physics
