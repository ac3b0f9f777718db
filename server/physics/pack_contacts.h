// Contacts of a pack's bodies with what stands still, in one list for all of them, so that their forces come as many at
// a time as a vector has lanes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/group_step.h"
#include "server/physics/lanes/contact_lanes.h"

namespace wobble::physics {

// Whether the bulk computes this law; the others go through AddContacts.
[[nodiscard]] inline bool IsBulkLaw(ContactLaw law) { return law == ContactLaw::kPenalty; }

// Where a vertex is in a pack: number k of n that an array has of each stands at (n place + k) width + lane.
struct PackSeat {
  std::uint32_t place = 0;
  std::uint32_t lane = 0;
};

template <class Real>
class PackContacts {
 public:
  // Room for so many contacts.
  void Reserve(std::size_t contacts);
  // No contacts, of bodies of this kind.
  void Clear(const Coefficients<Real>& body);
  // Those of a member. findSeat(vertex): where in the pack it is.
  template <class FindSeat>
  void Add(Member<Real>& member, const FindSeat& findSeat) {
    for (Contact<Real>& contact : member.state->contacts) {
      m_entries.push_back({findSeat(contact.vertex), &contact, &member.surfaces[contact.surface]});
    }
  }
  // After the last Add.
  void Close();

  [[nodiscard]] bool IsEmpty() const { return m_entries.empty(); }

  // state: [place][x y z vx vy vz][lane] with `width` lanes. Calls add(seat, force) for those that push.
  template <class Add>
  void FindForces(const Real* state, std::size_t width, ContactKernel<Real> kernel, const Add& add) {
    ReadPoints(state, width);
    ComputeForces(kernel);
    for (std::size_t i = 0; i < m_entries.size(); ++i) {
      if (!(Row(kDistance)[i] < Real(0))) continue;
      add(m_entries[i].seat, Vector3<Real>(Row(kForce)[i], Row(kForce + 1)[i], Row(kForce + 2)[i]));
    }
  }

  // After a substep: as UpdateAnchors, in the members' own lists.
  void Update(const Real* state, std::size_t width);

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

  Real* Row(std::size_t number) { return reinterpret_cast<Real*>(m_numbers.data()) + number * m_capacity; }
  void ReadPoints(const Real* state, std::size_t width);
  void ReadAnchor(std::size_t i);
  void ComputeForces(ContactKernel<Real> kernel);

  const Coefficients<Real>* m_body = nullptr;
  std::vector<Entry> m_entries;
  std::vector<Line> m_numbers;  // [number][contact]
  std::size_t m_capacity = 0;   // contacts a row has room for, whole lines
};

}  // namespace wobble::physics
