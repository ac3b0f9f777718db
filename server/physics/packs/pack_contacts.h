// Contacts of a pack's bodies with static surfaces other than planes (those are in pack_planes.h), in one list for all
// bodies, so that a kernel computes as many at a time as a vector has lanes. While a pack is stepped, the current state
// of its contacts is here; WriteBack copies it to the members' own lists at the end.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/kernels/contact/contact_lanes.h"
#include "server/physics/packs/pack_planes.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// Whether kernels compute this contact law. The others go through AddContacts of contact/contact.h.
[[nodiscard]] inline bool HasContactKernel(ContactLaw law) { return law == ContactLaw::kPenalty; }

template <class Real>
class PackContacts {
 public:
  // Makes room for so many contacts.
  void Reserve(std::size_t contacts);
  // Begins a new list, empty, for bodies with these coefficients in a pack of so many lanes.
  void Clear(const Coefficients<Real>& body, std::size_t width);
  // surface and contact must live until WriteBack.
  void Add(const PackSeat& seat, const Surface<Real>& surface, Contact<Real>& contact) {
    m_entries.push_back({seat, &contact, &surface});
  }
  // Call after the last Add.
  void Close();

  [[nodiscard]] bool IsEmpty() const { return m_entries.empty(); }

  // Computes the forces at state, [place][x y z vx vy vz][lane], and calls add(seat, force in N) for the contacts whose
  // vertex is below its surface.
  template <class Add>
  void FindForces(const Real* state, ContactKernel<Real> kernel, const Add& add) {
    if (!m_isRead) ReadPoints(state);
    m_isRead = false;
    ComputeForces(kernel);
    for (std::size_t i = 0; i < m_entries.size(); ++i) {
      if (!(Row(kDistance)[i] < Real(0))) continue;
      add(m_entries[i].seat, Vector3<Real>(Row(kForce)[i], Row(kForce + 1)[i], Row(kForce + 2)[i]));
    }
  }

  // Updates the anchors after a substep of h s to `state`, as UpdateAnchors of contact/contact.h does. The next
  // FindForces must be at the same state, since it reuses the points.
  void Update(const Real* state, Real h);
  // Copies the contacts to the members' own lists.
  void WriteBack() const;

 private:
  // Rows of m_numbers. kX, kV, kNormal, kAnchor and kForce are the first of three rows, one an axis.
  enum Number : std::size_t {
    kX = 0,
    kV = 3,
    kNormal = 6,
    kAnchor = 9,
    kForce = 12,
    kDistance = 15,
    kStick,
    kFriction,
    kShare,
    kNumbers
  };

  struct Entry {
    PackSeat seat;
    Contact<Real>* contact = nullptr;
    const Surface<Real>* surface = nullptr;
  };
  struct alignas(64) Line {
    std::array<Real, 64 / sizeof(Real)> numbers;
  };

  [[nodiscard]] Real* Row(std::size_t number) {
    return reinterpret_cast<Real*>(m_numbers.data()) + number * m_capacity;
  }
  [[nodiscard]] const Real* Row(std::size_t number) const {
    return reinterpret_cast<const Real*>(m_numbers.data()) + number * m_capacity;
  }
  void ReadPoints(const Real* state);
  void ComputeForces(ContactKernel<Real> kernel);

  const Coefficients<Real>* m_body = nullptr;
  std::size_t m_width = 0;
  std::vector<Entry> m_entries;
  std::vector<Line> m_numbers;  // [number][contact]
  std::size_t m_capacity = 0;   // contacts that a row has room for: whole lines
  bool m_isRead = false;        // the points are those of the state that FindForces will be given
};

}  // namespace wobble::physics
