// Contacts of a pack's bodies with planes, in the pack's own lanes (lanes/plane_lanes.h). While the pack is stepped
// they live here alone; the members' own lists hear of it at the end.
//
// A list of contacts that are gathered, as for other surfaces (pack_contacts.h), was three times as dear for bodies
// that lie alike, and no cheaper for bodies that lie each in its own way.
#pragma once

#include <array>
#include <vector>

#include "server/physics/lanes/plane_lanes.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// Where a pack has a vertex.
struct PackSeat {
  std::uint32_t place = 0;
  std::uint32_t lane = 0;
};

template <class Real>
[[nodiscard]] PenaltyLaw<Real> ReadLaw(const ContactParameters<Real>& parameters) {
  return {parameters.stiffness, parameters.fadeDepth, Real(1) / parameters.fadeDepth, parameters.damping,
          parameters.stickDamping};
}

template <class Real>
class PackPlanes {
 public:
  // For packs of bodies of so many vertices.
  void Reserve(std::size_t vertices);
  // No contacts, of bodies of this kind in a pack of so many places and lanes.
  void Clear(const Coefficients<Real>& body, std::size_t places, std::size_t width);
  // One with a plane.
  void Add(const PackSeat& seat, const Surface<Real>& plane, Contact<Real>& contact);
  // After the last Add.
  void Close();

  [[nodiscard]] bool IsEmpty() const { return m_entries.empty(); }

  // state: [place][x y z vx vy vz][lane]
  void AddForces(const Real* state, const PlaneKernel<Real>& kernel, OuterLanes<Real>& outer) {
    kernel.addForces(ReadLaw(m_body->contact), Lanes(), state, outer);
  }
  // After a substep: as UpdateAnchors.
  void Update(const Real* state, const PlaneKernel<Real>& kernel) {
    kernel.dragAnchors(ReadLaw(m_body->contact), m_body->contact.stickStiffness, Lanes(), state);
  }
  // To the members' own lists.
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
  std::vector<std::uint32_t> m_surfaces;  // of the planes that are touched
  std::vector<std::uint32_t> m_slotOf;    // [of those][place]: slot + 1; 0: none
  mutable std::vector<Line> m_numbers;    // as PlaneLanes has them: offsets, shares, sticks, anchors
};

}  // namespace wobble::physics
