// Contacts of a pack's bodies with what stands still, in one list for all of them, so that their forces come as many at
// a time as a vector has lanes. While a pack is stepped its contacts live here alone; the members' own lists hear of it
// at the end. Contacts with planes are not among them (pack_planes.h).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/lanes/contact_lanes.h"
#include "server/physics/step/member.h"
#include "server/physics/step/pack_planes.h"

namespace wobble::physics {

// Whether the bulk computes this law; the others go through AddContacts.
[[nodiscard]] inline bool IsBulkLaw(ContactLaw law) { return law == ContactLaw::kPenalty; }

template <class Real>
class PackContacts {
 public:
  // Room for so many contacts.
  void Reserve(std::size_t contacts);
  // No contacts, of bodies of this kind in a pack of so many lanes.
  void Clear(const Coefficients<Real>& body, std::size_t width);
  void Add(const PackSeat& seat, const Surface<Real>& surface, Contact<Real>& contact) {
    m_entries.push_back({seat, &contact, &surface});
  }
  // After the last Add.
  void Close();

  [[nodiscard]] bool IsEmpty() const { return m_entries.empty(); }

  // state: [place][x y z vx vy vz][lane]. Calls add(seat, force) for those that push.
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

  // After a substep: as UpdateAnchors. The next FindForces is taken to be at the same state.
  void Update(const Real* state);
  // To the members' own lists.
  void WriteBack() const;

 private:
  // Rows of m_numbers; the next two of those with three axes belong to them.
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
  std::size_t m_capacity = 0;   // contacts a row has room for, whole lines
  bool m_isRead = false;        // points are those of the state that comes next
};

}  // namespace wobble::physics
