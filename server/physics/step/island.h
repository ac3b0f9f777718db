// Bodies that are stepped together, behind one another in one array, as one system of equations: each stage of a step
// sees all of them at the same moment, and forces between them are equal and opposite at every stage. What hangs
// together by contacts is one part of a island; parts do nothing to one another and are judged by themselves.
#pragma once

#include <algorithm>
#include <span>

#include "server/physics/contact/backtracking.h"
#include "server/physics/lanes/sweep.h"
#include "server/physics/step/island_step.h"

namespace wobble::physics {

template <class Real>
[[nodiscard]] bool Backtracks(const Member<Real>& member) {
  return member.blueprint->full.contact.law == ContactLaw::kBacktracking && !member.state->contacts.empty();
}

// Members, and contact pairs between them, that belong to one part: from begin up to end, by their place in the island.
struct Part {
  std::size_t memberBegin = 0;
  std::size_t memberEnd = 0;
  std::size_t contactPairBegin = 0;
  std::size_t contactPairEnd = 0;
};

template <class Real>
class Island {
 public:
  Island(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs, Threads* threads,
         const SweepKernel<Real>& kernel, IslandScratch<Real>& scratch)
      : m_members(members), m_contactPairs(contactPairs), m_threads(threads), m_scratch(scratch) {
    ListMembers();
    SaveContacts();
    m_scratch.islandContacts.Build(contactPairs, members, kernel.bodyContacts);
  }

  [[nodiscard]] Part Whole() const { return {0, m_members.size(), 0, m_contactPairs.size()}; }
  [[nodiscard]] std::span<Member<Real>* const> MembersOf(const Part& part) const {
    return m_members.subspan(part.memberBegin, part.memberEnd - part.memberBegin);
  }
  [[nodiscard]] std::span<const ContactPair<Real>> ContactPairsOf(const Part& part) const {
    return m_contactPairs.subspan(part.contactPairBegin, part.contactPairEnd - part.contactPairBegin);
  }
  [[nodiscard]] std::span<Member<Real>* const> Members() const { return m_members; }
  [[nodiscard]] std::span<const ContactPair<Real>> ContactPairs() const { return m_contactPairs; }
  [[nodiscard]] IslandScratch<Real>& Scratch() const { return m_scratch; }
  [[nodiscard]] std::span<Vector3<Real>> Positions() const { return m_scratch.positions; }
  [[nodiscard]] std::span<Vector3<Real>> Velocities() const { return m_scratch.velocities; }

  template <class Value>
  [[nodiscard]] std::span<Value> PartOf(std::span<Value> values, std::size_t member) const {
    const std::size_t begin = m_scratch.begins[member];
    return values.subspan(begin, m_scratch.begins[member + 1] - begin);
  }
  template <class Value>
  [[nodiscard]] std::span<const Value> PartOf(const std::vector<Value>& values, std::size_t member) const {
    return PartOf(std::span<const Value>(values), member);
  }

  // visit(i), each i once, on any thread.
  template <class Visit>
  void ForEach(std::size_t count, const Visit& visit) const {
    if (m_threads != nullptr) {
      m_threads->ForEach(count, visit);
    } else {
      for (std::size_t i = 0; i < count; ++i) visit(i);
    }
  }

  [[nodiscard]] Meeting<Real> Meet(const ContactPair<Real>& contactPair, std::size_t side,
                                   std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v) const {
    const std::uint32_t vertices = contactPair.members[side];
    const std::uint32_t faces = contactPair.members[1 - side];
    return MakeMeeting<Real>(*m_members[vertices], PartOf(x, vertices), PartOf(v, vertices), *m_members[faces],
                             PartOf(x, faces), PartOf(v, faces));
  }

  // From these three on: a System of integrator_step.h.
  [[nodiscard]] std::size_t CountBodies() const { return m_members.size(); }
  [[nodiscard]] SteppedBody<Real> ReadBody(std::size_t i) const {
    const Member<Real>& member = *m_members[i];
    return {member.blueprint,       &member.load,       member.surfaces,
            member.state->contacts, member.state->torn, m_scratch.begins[i]};
  }
  void Accelerate(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> a,
                  bool springs) const {
    Accelerate(x, v, a, springs, [](std::size_t) {});
  }
  // prepare(i) comes first for each member, on the thread that computes its forces.
  template <class Prepare>
  void Accelerate(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> a,
                  bool springs, const Prepare& prepare) const {
    ForEach(m_members.size(), [&](std::size_t i) {
      prepare(i);
      const Member<Real>& member = *m_members[i];
      Load<Real> load = member.load;
      if (!springs) load.stiffnessFactor = 0;
      ComputeForces<Real>(member.blueprint->template Read<Real>(), load, member.surfaces, member.state->contacts,
                          PartOf(x, i), PartOf(v, i), PartOf(a, i));
    });
    ComputeAllBodyContacts(x, v);
    ForEach(m_members.size(), [&](std::size_t i) {
      const auto forces = PartOf(a, i);
      VisitContactForces(i, [forces](std::uint16_t vertex, const Vector3<Real>& force) { forces[vertex] += force; });
      const Member<Real>& member = *m_members[i];
      const Coefficients<Real>& body = member.blueprint->template Read<Real>();
      DivideByMasses<Real>(body, member.load, PartOf(a, i));
      if (Backtracks(member)) {
        HoldResting<Real>(body, member.surfaces, member.state->contacts, PartOf(x, i), PartOf(a, i));
      }
    });
  }

  // The forces of all contacts between members.
  void ComputeAllBodyContacts(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v) const {
    m_scratch.islandContacts.ComputeForces(FindMotions(x, v), m_threads);
  }
  // Those that act on a member: add(vertex, force), in their one order.
  template <class Add>
  void VisitContactForces(std::size_t member, const Add& add) const {
    m_scratch.islandContacts.VisitForcesOn(member, add);
  }
  // After a substep of h s to these positions and velocities.
  void UpdateAllBodyContacts(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, Real h) const {
    m_scratch.islandContacts.Update(FindMotions(x, v), h, m_threads);
  }

  // Takes the part's positions and velocities from the bodies' own states, which stay as they are until Scatter.
  void Gather(const Part& part) const {
    for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
      const State<Real>& state = *m_members[i]->state;
      std::copy(state.positions.begin(), state.positions.end(), PartOf(Positions(), i).begin());
      std::copy(state.velocities.begin(), state.velocities.end(), PartOf(Velocities(), i).begin());
    }
  }

  // Back to where the tick began.
  void StartAgain(const Part& part) const {
    Gather(part);
    for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
      const auto saved = ContactsBefore(i);
      std::copy(saved.begin(), saved.end(), m_members[i]->state->contacts.begin());
    }
    for (std::size_t side = 2 * part.contactPairBegin; side < 2 * part.contactPairEnd; ++side) {
      const auto saved = BodyContactsBefore(side);
      std::copy(saved.begin(), saved.end(), m_contactPairs[side / 2].sides[side % 2]->begin());
    }
    m_scratch.islandContacts.ReadLists();
  }

  void Scatter(const Part& part) const {
    for (std::size_t i = part.memberBegin; i < part.memberEnd; ++i) {
      State<Real>& state = *m_members[i]->state;
      const auto positions = PartOf(Positions(), i);
      const auto velocities = PartOf(Velocities(), i);
      std::copy(positions.begin(), positions.end(), state.positions.begin());
      std::copy(velocities.begin(), velocities.end(), state.velocities.begin());
    }
  }

  // Those of a member with what stands still, and those of side s of contact pair e, at 2 e + s, as the tick found
  // them.
  [[nodiscard]] std::span<const Contact<Real>> ContactsBefore(std::size_t member) const {
    return std::span(m_scratch.contacts).subspan(m_scratch.contactBegins[member], ContactsOf(member).size());
  }
  [[nodiscard]] std::span<const BodyContact<Real>> BodyContactsBefore(std::size_t side) const {
    return std::span(m_scratch.bodyContacts)
        .subspan(m_scratch.islandContacts.BeginOf(side), m_contactPairs[side / 2].sides[side % 2]->size());
  }

 private:
  void ListMembers() {
    m_scratch.begins.assign(1, 0);
    for (const Member<Real>* member : m_members) {
      m_scratch.begins.push_back(m_scratch.begins.back() + member->state->positions.size());
    }
    m_scratch.positions.resize(m_scratch.begins.back());
    m_scratch.velocities.resize(m_scratch.begins.back());
  }

  const std::vector<Contact<Real>>& ContactsOf(std::size_t member) const { return m_members[member]->state->contacts; }

  void SaveContacts() {
    m_scratch.contacts.clear();
    m_scratch.contactBegins.clear();
    m_scratch.bodyContacts.clear();
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      m_scratch.contactBegins.push_back(m_scratch.contacts.size());
      m_scratch.contacts.insert(m_scratch.contacts.end(), ContactsOf(i).begin(), ContactsOf(i).end());
    }
    for (const ContactPair<Real>& contactPair : m_contactPairs) {
      for (const auto* side : contactPair.sides) {
        m_scratch.bodyContacts.insert(m_scratch.bodyContacts.end(), side->begin(), side->end());
      }
    }
  }

  // Of all members, until the next call.
  [[nodiscard]] std::span<const Motion<Real>> FindMotions(std::span<const Vector3<Real>> x,
                                                          std::span<const Vector3<Real>> v) const {
    m_scratch.motions.clear();
    for (std::size_t i = 0; i < m_members.size(); ++i) m_scratch.motions.push_back({PartOf(x, i), PartOf(v, i)});
    return m_scratch.motions;
  }

  std::span<Member<Real>* const> m_members;
  std::span<const ContactPair<Real>> m_contactPairs;
  Threads* m_threads;
  IslandScratch<Real>& m_scratch;
};

}  // namespace wobble::physics
