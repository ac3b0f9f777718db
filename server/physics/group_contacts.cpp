#include "server/physics/group_contacts.h"

#include "server/physics/group_step.h"

namespace wobble::physics {

template <class Real>
void GroupContacts<Real>::Reserve(std::size_t contacts, std::size_t bodies) {
  m_sides.reserve(16 * bodies);  // seldom has a body more than eight neighbours
  m_sidesOf.reserve(32 * bodies);
  m_sidesBegin.reserve(bodies + 1);
  m_forces.reserve(contacts);
}

template <class Real>
void GroupContacts<Real>::Build(std::span<const Encounter<Real>> encounters, std::span<Member<Real>* const> members,
                                const SweepKernel<Real>& kernel) {
  m_kernel = &kernel;
  m_sides.clear();
  std::size_t count = 0;
  for (const Encounter<Real>& encounter : encounters) {
    for (std::size_t s = 0; s < 2; ++s) {
      Side side;
      side.ofVertices = encounter.members[s];
      side.ofFaces = encounter.members[1 - s];
      side.contacts = encounter.sides[s];
      side.begin = count;
      side.parameters = encounter.parameters;
      side.meeting = MakeMeeting<Real>(*members[side.ofVertices], {}, {}, *members[side.ofFaces], {}, {});
      m_sides.push_back(side);
      count += side.contacts->size();
    }
  }
  m_forces.resize(count);
  ListSidesOfMembers(members.size());
  ReadLists();
}

template <class Real>
void GroupContacts<Real>::ListSidesOfMembers(std::size_t members) {
  m_sidesBegin.assign(members + 1, 0);
  for (const Side& side : m_sides) {
    ++m_sidesBegin[side.ofVertices + 1U];
    ++m_sidesBegin[side.ofFaces + 1U];
  }
  for (std::size_t i = 0; i < members; ++i) m_sidesBegin[i + 1] += m_sidesBegin[i];
  m_sidesOf.resize(2 * m_sides.size());
  for (std::size_t i = m_sides.size(); i-- > 0;) {
    m_sidesOf[--m_sidesBegin[m_sides[i].ofVertices + 1U]] = static_cast<std::uint32_t>(i);
    m_sidesOf[--m_sidesBegin[m_sides[i].ofFaces + 1U]] = static_cast<std::uint32_t>(i);
  }
  // Each member's end has been counted down to its begin: one step to the left, and they are begins again.
  m_sidesBegin.erase(m_sidesBegin.begin());
  m_sidesBegin.push_back(m_sidesOf.size());
}

template <class Real>
void GroupContacts<Real>::ReadLists() {}

template <class Real>
template <class Visit>
void GroupContacts<Real>::ForEach(std::size_t count, Threads* threads, const Visit& visit) {
  if (threads != nullptr) {
    threads->ForEach(count, visit);
  } else {
    for (std::size_t i = 0; i < count; ++i) visit(i);
  }
}

template <class Real>
Meeting<Real> GroupContacts<Real>::Meet(const Side& side, std::span<const Motion<Real>> motions) const {
  Meeting<Real> meeting = side.meeting;
  meeting.x = motions[side.ofVertices].x;
  meeting.v = motions[side.ofVertices].v;
  meeting.shell.x = motions[side.ofFaces].x;
  meeting.shellV = motions[side.ofFaces].v;
  return meeting;
}

template <class Real>
void GroupContacts<Real>::ComputeForces(std::span<const Motion<Real>> motions, Threads* threads) {
  ForEach(m_sides.size(), threads, [&](std::size_t i) {
    const Side& side = m_sides[i];
    const std::span forces = std::span(m_forces).subspan(side.begin, side.contacts->size());
    ComputeBodyContacts<Real>(side.parameters, Meet(side, motions), *side.contacts, forces);
  });
}

template <class Real>
void GroupContacts<Real>::Update(std::span<const Motion<Real>> motions, Real h, Threads* threads) {
  ForEach(m_sides.size(), threads, [&](std::size_t i) {
    const Side& side = m_sides[i];
    UpdateBodyContacts<Real>(side.parameters, Meet(side, motions), h, *side.contacts);
  });
}

template class GroupContacts<float>;
template class GroupContacts<double>;

}  // namespace wobble::physics
