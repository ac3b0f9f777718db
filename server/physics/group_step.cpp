// Bodies that touch are one system of equations: their states stand behind one another in one array, so that each stage
// of a step sees all of them at the same moment, and forces between them are equal and opposite at every stage.
#include "server/physics/group_step.h"

#include <algorithm>

#include "server/physics/backtracking.h"
#include "server/physics/stability.h"

namespace wobble::physics {
namespace {

template <class Real>
class Group {
 public:
  Group(std::span<Member<Real>* const> members, std::span<const Encounter<Real>> encounters,
        GroupScratch<Real>& scratch)
      : m_members(members), m_encounters(encounters), m_scratch(scratch) {
    Gather();
  }

  int Step(double duration) {
    const Integrator integrator = FindIntegrator();
    const int substeps = FindSubsteps(integrator, duration);
    const auto h = static_cast<Real>(duration / substeps);
    for (int substep = 0; substep < substeps; ++substep) {
      KeepBefore();
      StepOnce<Real>(integrator, h, *this, std::span(m_scratch.positions), std::span(m_scratch.velocities),
                     m_scratch.integrator);
      PutAllBack(h);
      UpdateContacts(h);
    }
    Scatter();
    return substeps;
  }

  // As a system of StepOnce.
  [[nodiscard]] std::size_t CountBodies() const { return m_members.size(); }
  [[nodiscard]] SteppedBody<Real> ReadBody(std::size_t i) const {
    const Member<Real>& member = *m_members[i];
    return {member.blueprint, &member.load, member.surfaces, member.state->contacts, {}, m_scratch.begins[i]};
  }
  void Accelerate(std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> a,
                  bool springs) const {
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const Member<Real>& member = *m_members[i];
      Load<Real> load = member.load;
      if (!springs) load.stiffnessFactor = 0;
      ComputeForces<Real>(member.blueprint->template Read<Real>(), load, member.surfaces, member.state->contacts,
                          PartOf(x, i), PartOf(v, i), PartOf(a, i));
    }
    for (const Encounter<Real>& encounter : m_encounters) {
      for (std::size_t side = 0; side < 2; ++side) {
        AddBodyContacts<Real>(encounter.parameters, Meet(encounter, side, x, v), *encounter.sides[side],
                              PartOf(a, encounter.members[side]), PartOf(a, encounter.members[1 - side]));
      }
    }
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const Member<Real>& member = *m_members[i];
      const Coefficients<Real>& body = member.blueprint->template Read<Real>();
      DivideByMasses<Real>(body, member.load, PartOf(a, i));
      if (Backtracks(member)) {
        HoldResting<Real>(body, member.surfaces, member.state->contacts, PartOf(x, i), PartOf(a, i));
      }
    }
  }

 private:
  // Bodies that touch are stepped as one. Where they ask for different methods none of those is right for all, and
  // what they have in common is the default.
  [[nodiscard]] Integrator FindIntegrator() const {
    const Integrator first = m_members[0]->blueprint->integrator;
    for (const Member<Real>* member : m_members) {
      if (member->blueprint->integrator != first) return Integrator::kRungeKutta4;
    }
    return first;
  }

  template <class Value>
  std::span<Value> PartOf(std::span<Value> values, std::size_t member) const {
    const std::size_t begin = m_scratch.begins[member];
    return values.subspan(begin, m_scratch.begins[member + 1] - begin);
  }

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

  void Scatter() const {
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const auto positions = PartOf(std::span<const Vector3<Real>>(m_scratch.positions), i);
      const auto velocities = PartOf(std::span<const Vector3<Real>>(m_scratch.velocities), i);
      std::copy(positions.begin(), positions.end(), m_members[i]->state->positions.begin());
      std::copy(velocities.begin(), velocities.end(), m_members[i]->state->velocities.begin());
    }
  }

  Meeting<Real> Meet(const Encounter<Real>& encounter, std::size_t side, std::span<const Vector3<Real>> x,
                     std::span<const Vector3<Real>> v) const {
    const std::uint32_t vertices = encounter.members[side];
    const std::uint32_t faces = encounter.members[1 - side];
    return MakeMeeting<Real>(*m_members[vertices], PartOf(x, vertices), PartOf(v, vertices), *m_members[faces],
                             PartOf(x, faces), PartOf(v, faces));
  }

  int FindSubsteps(Integrator integrator, double duration) {
    m_scratch.loads.assign(m_scratch.positions.size(), {});
    int most = AddAllContactLoads(duration);
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const Member<Real>& member = *m_members[i];
      ContactRates rates;
      for (std::size_t vertex = 0; const VertexLoad& load : PartOf(std::span(m_scratch.loads), i)) {
        const double mass = member.blueprint->full.masses[vertex++];
        rates.squareFrequency = std::max(rates.squareFrequency, load.stiffness / mass);
        rates.dampingRate = std::max(rates.dampingRate, load.damping / mass);
      }
      most = std::max(most, ChooseSubsteps<Real>(integrator, *member.blueprint, member.load, member.surfaces,
                                                 *member.state, rates, duration));
    }
    return most;
  }

  int AddAllContactLoads(double duration) {
    int most = 1;
    const std::span<VertexLoad> loads(m_scratch.loads);
    for (const Encounter<Real>& encounter : m_encounters) {
      for (std::size_t side = 0; side < 2; ++side) {
        const Meeting<Real> meeting = Meet(encounter, side, m_scratch.positions, m_scratch.velocities);
        most = std::max(most, AddContactLoads<Real>(encounter.parameters, meeting, *encounter.sides[side], duration,
                                                    PartOf(loads, encounter.members[side]),
                                                    PartOf(loads, encounter.members[1 - side])));
      }
    }
    return most;
  }

  static bool Backtracks(const Member<Real>& member) {
    return member.blueprint->full.contact.law == ContactLaw::kBacktracking && !member.state->contacts.empty();
  }

  void KeepBefore() {
    if (std::none_of(m_members.begin(), m_members.end(), [](const auto* member) { return Backtracks(*member); }))
      return;
    m_scratch.positionsBefore = m_scratch.positions;
    m_scratch.velocitiesBefore = m_scratch.velocities;
  }

  void PutAllBack(Real h) {
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const Member<Real>& member = *m_members[i];
      if (!Backtracks(member)) continue;
      PutBack<Real>(member.blueprint->template Read<Real>(), h, member.surfaces,
                    PartOf(std::span<const Vector3<Real>>(m_scratch.positionsBefore), i),
                    PartOf(std::span<const Vector3<Real>>(m_scratch.velocitiesBefore), i), member.state->contacts,
                    PartOf(std::span(m_scratch.positions), i), PartOf(std::span(m_scratch.velocities), i));
    }
  }

  void UpdateContacts(Real h) {
    const std::span<const Vector3<Real>> x(m_scratch.positions);
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const Member<Real>& member = *m_members[i];
      UpdateAnchors<Real>(member.blueprint->template Read<Real>().contact, member.surfaces, member.state->contacts,
                          PartOf(x, i));
    }
    for (const Encounter<Real>& encounter : m_encounters) {
      for (std::size_t side = 0; side < 2; ++side) {
        UpdateBodyContacts<Real>(encounter.parameters, Meet(encounter, side, x, m_scratch.velocities), h,
                                 *encounter.sides[side]);
      }
    }
  }

  std::span<Member<Real>* const> m_members;
  std::span<const Encounter<Real>> m_encounters;
  GroupScratch<Real>& m_scratch;
};

}  // namespace

template <class Real>
Meeting<Real> MakeMeeting(const Member<Real>& ofVertices, std::span<const Vector3<Real>> x,
                          std::span<const Vector3<Real>> v, const Member<Real>& ofFaces,
                          std::span<const Vector3<Real>> shellX, std::span<const Vector3<Real>> shellV) {
  const Vector3d shift = ofVertices.state->origin - ofFaces.state->origin;
  return {x,
          v,
          ofVertices.blueprint->template Read<Real>().contactShares,
          {ofFaces.blueprint->template Read<Real>().faces, &ofFaces.blueprint->topology, shellX},
          shellV,
          shift.cast<Real>()};
}

template <class Real>
int StepGroup(std::span<Member<Real>* const> members, std::span<const Encounter<Real>> encounters, double duration,
              GroupScratch<Real>& scratch) {
  return Group<Real>(members, encounters, scratch).Step(duration);
}

#define WOBBLE_INSTANTIATE(Real)                                                                            \
  template Meeting<Real> MakeMeeting<Real>(const Member<Real>&, std::span<const Vector3<Real>>,             \
                                           std::span<const Vector3<Real>>, const Member<Real>&,             \
                                           std::span<const Vector3<Real>>, std::span<const Vector3<Real>>); \
  template int StepGroup<Real>(std::span<Member<Real>* const>, std::span<const Encounter<Real>>, double,    \
                               GroupScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
