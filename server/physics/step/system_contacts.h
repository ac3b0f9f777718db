// Contacts between the members of a system, all in one list, so that a kernel computes as many at a time as a vector
// has lanes. Forces are computed for all contacts first and added up member by member afterwards: so threads can work
// on bodies that share neighbours at the same time, and every sum still has one order.
#pragma once

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

#include "server/physics/kernels/contact/body_contact_lanes.h"
#include "server/physics/model/parallel.h"
#include "server/physics/skins/body_contact.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// Positions, m, and velocities, m/s, of one member's vertices in its local coordinates.
template <class Real>
struct Motion {
  VectorView<Real> x;
  VectorView<Real> v;
  const MovingPoint<Real>* points = nullptr;  // the same numbers, if they lie side by side; of all members or of none
};

template <class Real>
class SystemContacts {
 public:
  // Makes room for so many contacts between so many bodies.
  void Reserve(std::size_t contacts, std::size_t bodies);
  // Takes over the contacts of these pairs. The pairs keep their lists, which this class reads and writes: until the
  // next Build the lists and the members' blueprints must live, and no list may get longer or shorter.
  void Build(std::span<const ContactPair<Real>> contactPairs, std::span<Member<Real>* const> members,
             const BodyContactKernel<Real>& kernel);
  // Reads the lists again. Call after other code has changed their contacts.
  void ReadLists();

  [[nodiscard]] bool IsEmpty() const { return m_entries.empty(); }

  // Index of the first contact of side s of contact pair p among all contacts; side: 2 p + s.
  [[nodiscard]] std::size_t BeginOf(std::size_t side) const { return m_sides[side].begin; }

  // Computes the forces of all contacts. motions: one a member, in the members' order; those of a member without
  // contact pairs may be empty. threads: shares the contacts out; null: the calling thread does all. The result does
  // not depend on it.
  void ComputeForces(std::span<const Motion<Real>> motions, Threads* threads);

  // Calls add(vertex, force in N) for every force on the member that ComputeForces found, in an order that depends on
  // the contact pairs alone; a vertex may come several times. Threads may call it for several members at the same time.
  template <class Add>
  void VisitForcesOn(std::size_t member, const Add& add) const {
    for (std::size_t i = m_sidesBegin[member]; i < m_sidesBegin[member + 1]; ++i) {
      const Side& side = m_sides[m_sidesOf[i]];
      if (side.ofVertices == member) {
        VisitActing(side, [&](std::size_t contact, std::size_t lane, const BodyContactForces<Real>& forces) {
          add(m_entries[contact].vertex, ReadRows(forces.onVertex, lane));
        });
      } else {
        VisitActing(side, [&](std::size_t contact, std::size_t lane, const BodyContactForces<Real>& forces) {
          const bool left = (forces.left >> lane & 1U) != 0;
          const Face& corners = left ? m_leftTo[contact] : m_entries[contact].corners;
          for (std::size_t corner = 0; corner < 3; ++corner) {
            add(corners[corner], ReadRows(forces.onCorners[corner], lane));
          }
        });
      }
    }
  }

  // Brings all contacts up to date after a substep of h s, in the pairs' lists too, as UpdateBodyContacts does.
  void Update(std::span<const Motion<Real>> motions, Real h, Threads* threads);

 private:
  // One side of a contact pair: vertices of one body against faces of the other.
  struct Side {
    std::uint32_t ofVertices = 0;  // places of the members
    std::uint32_t ofFaces = 0;
    std::vector<BodyContact<Real>>* contacts = nullptr;
    std::size_t begin = 0;  // of the side's contacts among all
    ContactParameters<Real> parameters;
    Meeting<Real> meeting;  // without positions and velocities
  };

  struct Entry {
    std::uint32_t side = 0;
    std::uint16_t vertex = 0;
    Face corners{};
    Face across{};  // Topology::across of the face
  };

  static Vector3<Real> ReadRows(const ContactRow<Real> (&rows)[3], std::size_t lane) {
    return {rows[0][lane], rows[1][lane], rows[2][lane]};
  }
  static void WriteRows(const Vector3<Real>& value, std::size_t lane, ContactRow<Real> (&rows)[3]) {
    for (int axis = 0; axis < 3; ++axis) rows[axis][lane] = value[axis];
  }

  // Calls visit(contact, its lane, forces of its block) for the side's contacts that act, ascending.
  template <class Visit>
  void VisitActing(const Side& side, const Visit& visit) const {
    const std::size_t end = side.begin + side.contacts->size();
    for (std::size_t at = side.begin; at < end;) {
      const std::size_t block = at / kContactsInBlock;
      const std::size_t first = block * kContactsInBlock;
      const std::size_t next = std::min(end, first + kContactsInBlock);
      const BodyContactForces<Real>& forces = m_forces[block];
      const std::uint32_t ofSide = (1U << (next - first)) - (1U << (at - first));
      for (std::uint32_t acts = forces.acts & ofSide; acts != 0; acts &= acts - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(acts));
        visit(first + lane, lane, forces);
      }
      at = next;
    }
  }

  [[nodiscard]] std::size_t CountInBlock(std::size_t block) const {
    return std::min(kContactsInBlock, m_entries.size() - block * kContactsInBlock);
  }
  [[nodiscard]] BodyContact<Real>& ContactOf(std::size_t contact) const {
    const Side& side = m_sides[m_entries[contact].side];
    return (*side.contacts)[contact - side.begin];
  }
  [[nodiscard]] Meeting<Real> Meet(const Side& side, std::span<const Motion<Real>> motions) const;
  void ListSidesOfMembers(std::size_t members);
  void WriteConstants(std::size_t contact);
  void ReadList(std::size_t contact);
  void GatherPoints(std::size_t block, std::span<const Motion<Real>> motions, BodyContactPoints<Real>& points) const;
  void GatherAcross(std::size_t block, std::span<const Motion<Real>> motions, BodyContactPoints<Real>& points) const;
  // The same where positions and velocities lie side by side.
  void SpreadPoints(std::size_t block, std::span<const Motion<Real>> motions, BodyContactPoints<Real>& points) const;
  void SpreadAcross(std::size_t block, std::span<const Motion<Real>> motions, BodyContactPoints<Real>& points) const;
  void ComputeForcesOf(std::size_t block, std::span<const Motion<Real>> motions);
  void ComputeForceOfLeft(std::size_t contact, std::span<const Motion<Real>> motions);
  void Update(std::size_t block, std::span<const Motion<Real>> motions, Real h);
  void WriteList(std::size_t contact, bool armed, bool touching);
  template <class Visit>
  void ForEachBlock(Threads* threads, const Visit& visit) const;

  BodyContactKernel<Real> m_kernel;
  std::vector<Side> m_sides;
  std::vector<std::uint32_t> m_sidesOf;  // indices of the sides of member m, ascending, from m_sidesBegin[m] on
  std::vector<std::size_t> m_sidesBegin;
  std::vector<Entry> m_entries;  // one a contact
  std::vector<Face> m_leftTo;    // one a contact: corners that it pushes when its vertex has left its face
  std::vector<BodyContactBlock<Real>> m_blocks;
  std::vector<BodyContactForces<Real>> m_forces;
};

}  // namespace wobble::physics
