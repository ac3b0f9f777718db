// Bodies that are stepped together as one system of equations: positions and velocities of all of them stand one body
// after the other in one array, so that every stage of a step sees all bodies at the same moment and the forces between
// them are equal and opposite at every stage.
//
// An island is a connected component: bodies that are linked by contact pairs, or a body alone. A system holds one
// island or, in lanes (batch_step.h), several islands that ask for the same number of substeps. Islands of a system
// exert no force on one another, so each is judged, stepped again and put back by itself.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "server/physics/contact/backtracking.h"
#include "server/physics/kernels/sweep.h"
#include "server/physics/methods/integrator_step.h"
#include "server/physics/model/parallel.h"
#include "server/physics/step/member.h"
#include "server/physics/step/system_contacts.h"
#include "server/physics/step/system_cores.h"
#include "server/physics/step/system_edges.h"

namespace wobble::physics {

// Whether a member's contacts follow the backtracking law and it has any.
template <class Real>
[[nodiscard]] bool Backtracks(const Member<Real>& member) {
  return member.blueprint->full.contact.law == ContactLaw::kBacktracking && !member.state->contacts.empty();
}

// The members and contact pairs of one island of a system, by their places there, each from begin up to end. Contact
// pairs of an island link members of that island only.
struct Island {
  std::size_t memberBegin = 0;
  std::size_t memberEnd = 0;
  std::size_t contactPairBegin = 0;
  std::size_t contactPairEnd = 0;
};

// How the tick of an island was stepped.
struct IslandOutcome {
  int substeps = 0;     // of the try that counts, equal for all members
  int allSubsteps = 0;  // the same with the substeps of the tries that were thrown away
};

// The arrays of a system. Reused from system to system to save allocations; one system uses it at a time.
template <class Real>
struct SystemScratch {
  IntegratorScratch<Real> integrator;
  std::vector<Vector3<Real>> positions;        // of all members, each in its body's local coordinates, m
  std::vector<Vector3<Real>> velocities;       // m/s
  std::vector<Vector3<Real>> positionsBefore;  // the substep; filled only where a member backtracks
  std::vector<Vector3<Real>> velocitiesBefore;
  std::vector<MovingPoint<Real>> points;  // empty where no members touch
  std::vector<std::size_t> begins;        // of each member's vertices in these arrays, and the end of the last
  SystemContacts<Real> systemContacts;
  SystemEdges<Real> systemEdges;
  SystemCores<Real> systemCores;
  std::vector<Motion<Real>> motions;  // of each member
  // Contacts as the tick found them, one list after the other, for a tick that is stepped again.
  std::vector<Contact<Real>> contacts;
  std::vector<std::size_t> contactBegins;  // of each member's list in `contacts`
  std::vector<BodyContact<Real>> bodyContacts;
  std::vector<Vector3d> places;  // of one body's vertices

  // Makes room for the largest system that the world can have, so that one that grows allocates nothing.
  void Reserve(std::size_t vertices, std::size_t bodies) {
    integrator.Reserve(vertices);
    positions.reserve(vertices);
    velocities.reserve(vertices);
    points.reserve(vertices);
    positionsBefore.reserve(vertices);
    velocitiesBefore.reserve(vertices);
    contacts.reserve(vertices);
    bodyContacts.reserve(vertices);
    places.reserve(vertices);
    begins.reserve(bodies + 1);
    contactBegins.reserve(bodies);
    systemContacts.Reserve(vertices, bodies);
    systemCores.Reserve(bodies);
    motions.reserve(bodies);
  }
};

template <class Real>
class BodySystem {
 public:
  // Notes the contacts as they are, for StartAgain; positions and velocities come with Gather. All arguments must
  // outlive the system. threads: shares the members out; null: the calling thread does all. No result depends on it.
  BodySystem(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs, Threads* threads,
             const SweepKernel<Real>& kernel, SystemScratch<Real>& scratch)
      : m_members(members), m_contactPairs(contactPairs), m_threads(threads), m_scratch(scratch) {
    ListMembers();
    SaveContacts();
    m_scratch.systemContacts.Build(contactPairs, members, kernel.bodyContacts);
    m_scratch.systemEdges.Build(contactPairs, members);
    m_scratch.systemCores.Build(contactPairs, members);
  }

  [[nodiscard]] std::span<Member<Real>* const> Members() const { return m_members; }
  [[nodiscard]] std::span<const ContactPair<Real>> ContactPairs() const { return m_contactPairs; }
  [[nodiscard]] SystemScratch<Real>& Scratch() const { return m_scratch; }
  [[nodiscard]] std::span<Vector3<Real>> Positions() const { return m_scratch.positions; }
  [[nodiscard]] std::span<Vector3<Real>> Velocities() const { return m_scratch.velocities; }

  // Where packs put the positions and velocities that the contacts between members are computed at.
  [[nodiscard]] std::span<MovingPoint<Real>> Points() const { return m_scratch.points; }

  // The whole system as one range: the island where it holds only one.
  [[nodiscard]] Island All() const {
    return {.memberBegin = 0,
            .memberEnd = m_members.size(),
            .contactPairBegin = 0,
            .contactPairEnd = m_contactPairs.size()};
  }
  [[nodiscard]] std::span<Member<Real>* const> MembersOf(const Island& island) const {
    return m_members.subspan(island.memberBegin, island.memberEnd - island.memberBegin);
  }
  [[nodiscard]] std::span<const ContactPair<Real>> ContactPairsOf(const Island& island) const {
    return m_contactPairs.subspan(island.contactPairBegin, island.contactPairEnd - island.contactPairBegin);
  }

  // A member's own values out of an array that has one value for each vertex of the system.
  template <class Value>
  [[nodiscard]] std::span<Value> SliceOf(std::span<Value> values, std::size_t member) const {
    const std::size_t begin = m_scratch.begins[member];
    return values.subspan(begin, m_scratch.begins[member + 1] - begin);
  }
  template <class Value>
  [[nodiscard]] std::span<const Value> SliceOf(const std::vector<Value>& values, std::size_t member) const {
    return SliceOf(std::span<const Value>(values), member);
  }

  // Calls visit(i) once for each i below count, on any thread.
  template <class Visit>
  void ForEach(std::size_t count, const Visit& visit) const {
    if (m_threads != nullptr) {
      m_threads->ForEach(count, visit);
    } else {
      for (std::size_t i = 0; i < count; ++i) visit(i);
    }
  }

  // A side of a contact pair at positions x and velocities v of the whole system.
  [[nodiscard]] Meeting<Real> Meet(const ContactPair<Real>& contactPair, std::size_t side,
                                   std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v) const {
    const std::uint32_t vertices = contactPair.members[side];
    const std::uint32_t faces = contactPair.members[1 - side];
    return MakeMeeting<Real>(*m_members[vertices], SliceOf(x, vertices), SliceOf(v, vertices), *m_members[faces],
                             SliceOf(x, faces), SliceOf(v, faces), contactPair.gap);
  }

  // The edges of a contact pair, likewise.
  [[nodiscard]] EdgeMeeting<Real> MeetEdges(const ContactPair<Real>& contactPair, std::span<const Vector3<Real>> x,
                                            std::span<const Vector3<Real>> v) const {
    const auto [first, second] = contactPair.members;
    return MakeEdgeMeeting<Real>(*m_members[first], SliceOf(x, first), SliceOf(v, first), *m_members[second],
                                 SliceOf(x, second), SliceOf(v, second), contactPair.gap);
  }

  // The threads that ForEach uses.
  [[nodiscard]] std::size_t CountThreads() const {
    return m_threads == nullptr ? 1 : static_cast<std::size_t>(m_threads->Count());
  }

  // CountBodies, ReadBody and Accelerate make this a System of methods/integrator_step.h.
  [[nodiscard]] std::size_t CountBodies() const { return m_members.size(); }
  [[nodiscard]] SteppedBody<Real> ReadBody(std::size_t i) const {
    const Member<Real>& member = *m_members[i];
    return {.blueprint = member.blueprint,
            .load = &member.load,
            .surfaces = member.surfaces,
            .contacts = member.state->contacts,
            .torn = member.state->torn,
            .begin = m_scratch.begins[i]};
  }
  // Writes the accelerations of all vertices, m/s², at positions x, m, and velocities v, m/s, to a. springs: false
  // leaves out the forces of the bodies' springs.
  void Accelerate(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> a,
                  bool springs) const {
    Accelerate(x, v, a, springs, [](std::size_t) {});
  }
  // The same, but prepare(i) runs first for each member i, on the thread that computes its forces. It may write the
  // member's slices of x and v.
  template <class Prepare>
  void Accelerate(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> a,
                  bool springs, const Prepare& prepare) const {
    ForEach(m_members.size(), [&](std::size_t i) {
      prepare(i);
      const Member<Real>& member = *m_members[i];
      Load<Real> load = member.load;
      if (!springs) load.stiffnessFactor = 0;
      ComputeForces<Real>(member.blueprint->template Read<Real>(), load, member.surfaces, member.state->contacts,
                          SliceOf(x, i), SliceOf(v, i), SliceOf(a, i));
    });
    ComputeAllBodyContacts(x, v);
    ForEach(m_members.size(), [&](std::size_t i) {
      const auto forces = SliceOf(a, i);
      VisitContactForces(i, [forces](std::uint16_t vertex, const Vector3<Real>& force) { forces[vertex] += force; });
      const Member<Real>& member = *m_members[i];
      const Coefficients<Real>& body = member.blueprint->template Read<Real>();
      DivideByMasses<Real>(body, member.load, SliceOf(a, i));
      if (Backtracks(member)) {
        HoldResting<Real>(body, member.surfaces, member.state->contacts, SliceOf(x, i), SliceOf(a, i));
      }
    });
  }

  // Computes the forces of all contacts between members at x and v; VisitContactForces reads them.
  void ComputeAllBodyContacts(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v) const {
    ComputeAllBodyContactsAt(FindMotions(x, v));
  }
  // The same at Points().
  void ComputeAllBodyContacts() const { ComputeAllBodyContactsAt(FindMotionsOfPoints()); }
  // Calls add(vertex, force in N) for every such force on a member, always in the same order.
  template <class Add>
  void VisitContactForces(std::size_t member, const Add& add) const {
    m_scratch.systemContacts.VisitForcesOn(member, add);
    m_scratch.systemEdges.VisitForcesOn(member, add);
    m_scratch.systemCores.VisitForcesOn(member, add);
  }
  // Brings the contacts between members up to date after a substep of h s that ended at x and v.
  void UpdateAllBodyContacts(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, Real h) const {
    UpdateAllBodyContactsAt(FindMotions(x, v), h);
  }
  // The same for a substep that ended at Points().
  void UpdateAllBodyContacts(Real h) const { UpdateAllBodyContactsAt(FindMotionsOfPoints(), h); }

  // Copies positions and velocities from the bodies' own states into the system's arrays. The states keep those of the
  // tick's begin until Scatter.
  void Gather(const Island& island) const {
    for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
      const State<Real>& state = *m_members[i]->state;
      std::copy(state.positions.begin(), state.positions.end(), SliceOf(Positions(), i).begin());
      std::copy(state.velocities.begin(), state.velocities.end(), SliceOf(Velocities(), i).begin());
    }
  }

  // Puts the island back to the tick's begin: positions, velocities and contacts.
  void StartAgain(const Island& island) const {
    Gather(island);
    for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
      const auto saved = ContactsBefore(i);
      std::copy(saved.begin(), saved.end(), m_members[i]->state->contacts.begin());
    }
    for (std::size_t side = 2 * island.contactPairBegin; side < 2 * island.contactPairEnd; ++side) {
      const auto saved = BodyContactsBefore(side);
      std::copy(saved.begin(), saved.end(), m_contactPairs[side / 2].sides[side % 2]->begin());
    }
    m_scratch.systemEdges.PutBack(island.contactPairBegin, island.contactPairEnd);
    m_scratch.systemContacts.ReadLists();
  }

  // Copies the island's positions and velocities to the bodies' own states: the tick has ended.
  void Scatter(const Island& island) const {
    for (std::size_t i = island.memberBegin; i < island.memberEnd; ++i) {
      State<Real>& state = *m_members[i]->state;
      const auto positions = SliceOf(Positions(), i);
      const auto velocities = SliceOf(Velocities(), i);
      std::copy(positions.begin(), positions.end(), state.positions.begin());
      std::copy(velocities.begin(), velocities.end(), state.velocities.begin());
    }
  }

  // The contacts of a member with static surfaces as the tick found them.
  [[nodiscard]] std::span<const Contact<Real>> ContactsBefore(std::size_t member) const {
    return std::span(m_scratch.contacts).subspan(m_scratch.contactBegins[member], ContactsOf(member).size());
  }
  // The contacts of side s of contact pair p as the tick found them; side: 2 p + s.
  [[nodiscard]] std::span<const BodyContact<Real>> BodyContactsBefore(std::size_t side) const {
    return std::span(m_scratch.bodyContacts)
        .subspan(m_scratch.systemContacts.BeginOf(side), m_contactPairs[side / 2].sides[side % 2]->size());
  }
  // The edge contacts of a contact pair as the tick found them.
  [[nodiscard]] std::span<const EdgeContact<Real>> EdgeContactsBefore(std::size_t contactPair) const {
    return m_scratch.systemEdges.Before(contactPair);
  }

 private:
  void ListMembers() {
    m_scratch.begins.assign(1, 0);
    for (const Member<Real>* member : m_members) {
      m_scratch.begins.push_back(m_scratch.begins.back() + member->state->positions.size());
    }
    m_scratch.positions.resize(m_scratch.begins.back());
    m_scratch.velocities.resize(m_scratch.begins.back());
    m_scratch.points.resize(m_contactPairs.empty() ? 0 : m_scratch.begins.back());
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

  void ComputeAllBodyContactsAt(std::span<const Motion<Real>> motions) const {
    m_scratch.systemContacts.ComputeForces(motions, m_threads);
    m_scratch.systemEdges.ComputeForces(motions, m_threads);
    m_scratch.systemCores.ComputeForces(motions);
  }
  void UpdateAllBodyContactsAt(std::span<const Motion<Real>> motions, Real h) const {
    m_scratch.systemContacts.Update(motions, h, m_threads);
    m_scratch.systemEdges.Update(motions, h, m_threads);
  }

  // Valid until the next call.
  [[nodiscard]] std::span<const Motion<Real>> FindMotions(std::span<const Vector3<Real>> x,
                                                          std::span<const Vector3<Real>> v) const {
    m_scratch.motions.clear();
    for (std::size_t i = 0; i < m_members.size(); ++i) m_scratch.motions.push_back({SliceOf(x, i), SliceOf(v, i)});
    return m_scratch.motions;
  }
  [[nodiscard]] std::span<const Motion<Real>> FindMotionsOfPoints() const {
    m_scratch.motions.clear();
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const MovingPoint<Real>* const points = m_scratch.points.data() + m_scratch.begins[i];
      m_scratch.motions.push_back({{&points->x, sizeof *points}, {&points->v, sizeof *points}, points});
    }
    return m_scratch.motions;
  }

  std::span<Member<Real>* const> m_members;
  std::span<const ContactPair<Real>> m_contactPairs;
  Threads* m_threads;
  SystemScratch<Real>& m_scratch;
};

}  // namespace wobble::physics
