// The bodies of a group behind one another in one array, as one system of equations: each stage of a step sees all of
// them at the same moment, and forces between them are equal and opposite at every stage.
#pragma once

#include <algorithm>
#include <span>

#include "server/physics/backtracking.h"
#include "server/physics/group_step.h"

namespace wobble::physics {

template <class Real>
[[nodiscard]] bool Backtracks(const Member<Real>& member) {
  return member.blueprint->full.contact.law == ContactLaw::kBacktracking && !member.state->contacts.empty();
}

template <class Real>
class Group {
 public:
  Group(std::span<Member<Real>* const> members, std::span<const Encounter<Real>> encounters, Threads* threads,
        GroupScratch<Real>& scratch, int widestPack = kWidestPack)
      : m_members(members), m_encounters(encounters), m_threads(threads), m_scratch(scratch) {
    Gather();
    SaveContacts();
    m_scratch.groupContacts.Build(encounters, members, FindSweepKernels<Real>(widestPack).back().bodyContacts);
  }

  [[nodiscard]] std::span<Member<Real>* const> Members() const { return m_members; }
  [[nodiscard]] std::span<const Encounter<Real>> Encounters() const { return m_encounters; }
  [[nodiscard]] GroupScratch<Real>& Scratch() const { return m_scratch; }
  [[nodiscard]] Threads* Parallel() const { return m_threads; }  // null: one thread
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

  // Of all members, until the next call.
  [[nodiscard]] std::span<const Motion<Real>> FindMotions(std::span<const Vector3<Real>> x,
                                                          std::span<const Vector3<Real>> v) const {
    m_scratch.motions.clear();
    for (std::size_t i = 0; i < m_members.size(); ++i) m_scratch.motions.push_back({PartOf(x, i), PartOf(v, i)});
    return m_scratch.motions;
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

  [[nodiscard]] Meeting<Real> Meet(const Encounter<Real>& encounter, std::size_t side, std::span<const Vector3<Real>> x,
                                   std::span<const Vector3<Real>> v) const {
    const std::uint32_t vertices = encounter.members[side];
    const std::uint32_t faces = encounter.members[1 - side];
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
    m_scratch.groupContacts.ComputeForces(FindMotions(x, v), m_threads);
    ForEach(m_members.size(), [&](std::size_t i) {
      const auto forces = PartOf(a, i);
      m_scratch.groupContacts.VisitForcesOn(
          i, [forces](std::size_t vertex, const Vector3<Real>& force) { forces[vertex] += force; });
      const Member<Real>& member = *m_members[i];
      const Coefficients<Real>& body = member.blueprint->template Read<Real>();
      DivideByMasses<Real>(body, member.load, PartOf(a, i));
      if (Backtracks(member)) {
        HoldResting<Real>(body, member.surfaces, member.state->contacts, PartOf(x, i), PartOf(a, i));
      }
    });
  }

  // Back to where the tick began: the bodies' own states stay as it found them until Scatter.
  void StartAgain() {
    Gather();
    auto contact = m_scratch.contacts.cbegin();
    for (Member<Real>* member : m_members) {
      for (Contact<Real>& each : member->state->contacts) each = *contact++;
    }
    auto bodyContact = m_scratch.bodyContacts.cbegin();
    for (const Encounter<Real>& encounter : m_encounters) {
      for (auto* side : encounter.sides) {
        for (BodyContact<Real>& each : *side) each = *bodyContact++;
      }
    }
    m_scratch.groupContacts.ReadLists();
  }

  void Scatter() const {
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      State<Real>& state = *m_members[i]->state;
      const auto positions = PartOf(m_scratch.positions, i);
      const auto velocities = PartOf(m_scratch.velocities, i);
      std::copy(positions.begin(), positions.end(), state.positions.begin());
      std::copy(velocities.begin(), velocities.end(), state.velocities.begin());
    }
  }

 private:
  void Gather() {
    m_scratch.positions.clear();
    m_scratch.velocities.clear();
    m_scratch.begins.assign(1, 0);
    for (const Member<Real>* member : m_members) {
      const State<Real>& state = *member->state;
      m_scratch.positions.insert(m_scratch.positions.end(), state.positions.begin(), state.positions.end());
      m_scratch.velocities.insert(m_scratch.velocities.end(), state.velocities.begin(), state.velocities.end());
      m_scratch.begins.push_back(m_scratch.positions.size());
    }
  }

  void SaveContacts() {
    m_scratch.contacts.clear();
    m_scratch.bodyContacts.clear();
    for (const Member<Real>* member : m_members) {
      const auto& contacts = member->state->contacts;
      m_scratch.contacts.insert(m_scratch.contacts.end(), contacts.begin(), contacts.end());
    }
    for (const Encounter<Real>& encounter : m_encounters) {
      for (const auto* side : encounter.sides) {
        m_scratch.bodyContacts.insert(m_scratch.bodyContacts.end(), side->begin(), side->end());
      }
    }
  }

  std::span<Member<Real>* const> m_members;
  std::span<const Encounter<Real>> m_encounters;
  Threads* m_threads;
  GroupScratch<Real>& m_scratch;
};

}  // namespace wobble::physics
