// Contacts of a pack's bodies with planes, in the pack's own lanes (kernels/contact/plane_lanes.h). While the pack is
// stepped, the current state of its contacts is here; WriteBack copies it to the members' own lists at the end.
//
// Gathering them into a list, as for other surfaces (pack_contacts.h), took three times as long for bodies that touch
// the plane with the same vertices, and no less time for bodies that touch it each with others.
#pragma once

#include <array>
#include <vector>

#include "server/physics/kernels/contact/plane_lanes.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// Where a pack keeps a vertex of one of its bodies.
struct PackSeat {
  std::uint32_t place = 0;
  std::uint32_t lane = 0;
};

// The parameters of the penalty law as kernels take them.
template <class Real>
[[nodiscard]] PenaltyLaw<Real> ReadLaw(const ContactParameters<Real>& parameters) {
  return {.stiffness = parameters.stiffness,
          .fadeDepth = parameters.fadeDepth,
          .perFadeDepth = Real(1) / parameters.fadeDepth,
          .damping = parameters.damping,
          .stickDamping = parameters.stickDamping};
}

template <class Real>
class PackPlanes {
 public:
  // Makes room for packs of bodies with so many vertices each.
  void Reserve(std::size_t vertices);
  // Begins anew without contacts, for bodies with these coefficients in a pack of so many places and lanes.
  void Clear(const Coefficients<Real>& body, std::size_t places, std::size_t width);
  // Adds a contact with a plane. Both must live until WriteBack.
  void Add(const PackSeat& seat, const Surface<Real>& plane, Contact<Real>& contact);
  // Call after the last Add.
  void Close();

  [[nodiscard]] bool IsEmpty() const { return m_entries.empty(); }

  // Adds the forces at state, [place][x y z vx vy vz][lane], to `outer`.
  void AddForces(const Real* state, const PlaneKernel<Real>& kernel, OuterLanes<Real>& outer) {
    kernel.addForces(ReadLaw(m_body->contact), Lanes(), state, outer);
  }
  // Updates the anchors after a substep of h s to `state`, as UpdateAnchors of contact/contact.h does.
  void Update(const Real* state, Real h, const PlaneKernel<Real>& kernel) {
    kernel.dragAnchors(ReadLaw(m_body->contact), m_body->contact.stickStiffness, h, Lanes(), state);
  }
  // Copies the contacts to the members' own lists.
  void WriteBack() const;

 private:
  struct Entry {
    std::uint32_t slot = 0;
    std::uint32_t lane = 0;
    const Surface<Real>* plane = nullptr;
    Contact<Real>* contact = nullptr;
  };
  struct alignas(64) Line {
    std::array<Real, 64 / sizeof(Real)> numbers;
  };

  std::uint32_t FindSlot(std::uint32_t place, std::uint32_t surface, const Surface<Real>& plane);
  [[nodiscard]] PlaneLanes<Real> Lanes() const;

  const Coefficients<Real>* m_body = nullptr;
  std::size_t m_places = 0;
  std::size_t m_width = 0;
  std::vector<Entry> m_entries;
  std::vector<PlaneSlot<Real>> m_slots;
  std::vector<std::uint32_t> m_surfaces;  // Contact::surface of each plane that has contacts
  std::vector<std::uint32_t> m_slotOf;    // [index in m_surfaces][place]: slot + 1; 0: none
  mutable std::vector<Line> m_numbers;    // PlaneLanes' offsets, shares, sticks, anchors
};

}  // namespace wobble::physics
