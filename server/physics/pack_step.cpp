// The bodies' own states stay as they are, one body behind the other: a pack is filled from them for a try of a tick
// and read back after it, which costs a few nanoseconds a vertex and leaves nothing to be kept in step when bodies
// wake, touch or change. Forces from outside the sweep (contacts, pushes) are found before each stage, at its
// positions, and wait for it in an array of their own.
#include "server/physics/pack_step.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/physics/group_tick.h"

namespace wobble::physics {
namespace {

template <class Real>
const SweepKernel<Real>& FindNarrowest(std::span<const SweepKernel<Real>> kernels, std::size_t bodies) {
  return *std::find_if(kernels.begin(), kernels.end(), [bodies](const SweepKernel<Real>& kernel) {
    return static_cast<std::size_t>(kernel.width) >= bodies;
  });
}

// The bodies of a pack that are stepped together through one try of a tick, [place][k][lane]. Lanes to spare repeat the
// first body: they cost nothing more, and numbers that are none would.
template <class Real>
class Pack {
 public:
  Pack(const Blueprint& blueprint, std::span<Group<Real>* const> groups, std::span<const SweepKernel<Real>> kernels,
       PackScratch<Real>& scratch)
      : m_plan(blueprint.ReadPlan<Real>()),
        m_body(blueprint.Read<Real>()),
        m_tables(m_plan.Tables()),
        m_groups(groups),
        m_kernel(FindNarrowest(kernels, groups.size())),
        m_contactKernel(kernels.back().computeContacts),
        m_scratch(scratch),
        m_width(static_cast<std::size_t>(m_kernel.width)) {
    LayOut();
    for (std::size_t lane = 0; lane < m_width; ++lane) LoadBody(lane, GroupIn(lane));
    LoadVertices();
    m_kernel.computeVolume(m_tables, m_lanes);
    m_scratch.contacts.Clear(m_body);
    for (std::size_t lane = 0; lane < m_groups.size() && IsBulkLaw(m_body.contact.law); ++lane) {
      m_scratch.contacts.Add(MemberOf(*m_groups[lane]), lane, m_plan.places);
    }
    m_scratch.contacts.Close();
  }

  // Leaves positions, velocities and errors of the tick in the groups and their members.
  void Integrate(double duration, int substeps) {
    const double step = duration / substeps;
    for (Group<Real>* group : m_groups) MemberOf(*group).error = 0;
    for (int substep = 0; substep < substeps; ++substep) {
      for (int stage = 0; stage < 4; ++stage) {
        FindOuterForces(stage == 0 ? m_lanes.state : m_lanes.stage);
        m_kernel.stages[stage](m_tables, m_lanes, static_cast<Real>(step));
        if (stage == 0 && substep > 0) {
          AddErrors(m_lanes.accelerationErrors, step / 6 * (duration - substep * step));
        }
      }
      AddErrors(m_lanes.velocityErrors, step / 6);
      UpdateAllAnchors();
    }
    for (std::size_t lane = 0; lane < m_groups.size(); ++lane) {
      MemberOf(*m_groups[lane]).error *= kErrorShare / substeps;
    }
    StoreVertices();
  }

 private:
  const Group<Real>& GroupIn(std::size_t lane) const { return *m_groups[lane < m_groups.size() ? lane : 0]; }
  static Member<Real>& MemberOf(const Group<Real>& group) { return *group.Members()[0]; }

  // One block for all arrays, each of them aligned.
  void LayOut() {
    const std::size_t count = m_tables.count;
    const std::size_t pending = 3 * (m_tables.pendingMask + 1);
    const std::pair<Real**, std::size_t> arrays[] = {// and how many vectors each holds
                                                     {&m_lanes.state, 6 * count},
                                                     {&m_lanes.stage, 6 * count},
                                                     {&m_lanes.nextStage, 6 * count},
                                                     {&m_lanes.increments, 6 * count},
                                                     {&m_outer, 3 * count},
                                                     {&m_lanes.pending, pending},
                                                     {&m_acceleration, 3},
                                                     {&m_gas, 1},
                                                     {&m_stiffnessFactors, 1},
                                                     {&m_lanes.sixVolume, 1},
                                                     {&m_lanes.velocityErrors, 1},
                                                     {&m_lanes.accelerationErrors, 1}};
    using Line = typename PackScratch<Real>::Line;
    const auto countLines = [this](std::size_t vectors) {
      return (vectors * m_width * sizeof(Real) + sizeof(Line) - 1) / sizeof(Line);
    };
    std::size_t lines = 0;
    for (const auto& [array, vectors] : arrays) lines += countLines(vectors);
    if (m_scratch.lines.size() < lines) m_scratch.lines.resize(lines);
    Line* at = m_scratch.lines.data();
    for (const auto& [array, vectors] : arrays) {
      *array = reinterpret_cast<Real*>(at);
      at += countLines(vectors);
    }
    std::fill_n(m_lanes.pending, pending * m_width, Real(0));
    m_lanes.acceleration = m_acceleration;
    m_lanes.gas = m_gas;
    m_lanes.stiffnessFactors = m_stiffnessFactors;
    m_scratch.hasOuter.assign(count, 0);
    m_scratch.outerPlaces.clear();
    m_lanes.hasOuter = m_scratch.hasOuter.data();
    for (auto* ofOneBody : {&m_scratch.positions, &m_scratch.velocities, &m_scratch.forces}) ofOneBody->resize(count);
  }

  Real& At(Real* array, std::size_t place, std::size_t numbers, std::size_t k, std::size_t lane) const {
    return array[(place * numbers + k) * m_width + lane];
  }

  void LoadBody(std::size_t lane, const Group<Real>& group) {
    const physics::Load<Real>& load = MemberOf(group).load;
    for (std::size_t k = 0; k < 3; ++k) m_acceleration[k * m_width + lane] = load.acceleration[static_cast<int>(k)];
    m_gas[lane] = load.gasFactor * m_body.gas;
    m_stiffnessFactors[lane] = load.stiffnessFactor;
  }

  // Lane by lane would go through the whole pack once a body.
  void LoadVertices() {
    Real* to = m_lanes.state;
    for (std::size_t place = 0; place < m_tables.count; ++place, to += 6 * m_width) {
      const std::size_t vertex = m_plan.vertices[place];
      for (std::size_t lane = 0; lane < m_width; ++lane) {
        const Group<Real>& group = GroupIn(lane);
        const Vector3<Real>& x = group.Positions()[vertex];
        const Vector3<Real>& v = group.Velocities()[vertex];
        for (std::size_t k = 0; k < 3; ++k) {
          to[k * m_width + lane] = x[static_cast<int>(k)];
          to[(k + 3) * m_width + lane] = v[static_cast<int>(k)];
        }
      }
    }
  }

  void StoreVertices() const {
    const Real* from = m_lanes.state;
    for (std::size_t place = 0; place < m_tables.count; ++place, from += 6 * m_width) {
      const std::size_t vertex = m_plan.vertices[place];
      for (std::size_t lane = 0; lane < m_groups.size(); ++lane) {
        Vector3<Real>& x = m_groups[lane]->Positions()[vertex];
        Vector3<Real>& v = m_groups[lane]->Velocities()[vertex];
        for (std::size_t k = 0; k < 3; ++k) {
          x[static_cast<int>(k)] = from[k * m_width + lane];
          v[static_cast<int>(k)] = from[(k + 3) * m_width + lane];
        }
      }
    }
  }

  // Pushes and contacts with what stands still, at these positions and velocities.
  void FindOuterForces(Real* from) {
    for (const std::uint32_t place : m_scratch.outerPlaces) m_scratch.hasOuter[place] = 0;
    m_scratch.outerPlaces.clear();
    for (std::size_t lane = 0; lane < m_groups.size(); ++lane) AddOuterForces(lane, from);
    if (!m_scratch.contacts.IsEmpty()) {
      m_scratch.contacts.FindForces(from, m_width, m_contactKernel,
                                    [this](std::size_t place, std::size_t lane, const Vector3<Real>& force) {
                                      AddOuterForce(place, lane, force);
                                    });
    }
    m_lanes.outer = m_scratch.outerPlaces.empty() ? nullptr : m_outer;
  }

  void AddOuterForces(std::size_t lane, Real* from) {
    const Member<Real>& member = MemberOf(*m_groups[lane]);
    for (const VertexForce<Real>& push : member.load.pushes) {
      AddOuterForce(m_plan.places[push.vertex], lane, push.force);
    }
    const std::vector<Contact<Real>>& contacts = member.state->contacts;
    if (IsBulkLaw(m_body.contact.law) || contacts.empty()) return;
    for (const Contact<Real>& contact : contacts) {
      CopyVertex(contact.vertex, lane, from);
      m_scratch.forces[contact.vertex].setZero();
    }
    AddContacts<Real>(m_body.contact, m_body.contactShares, member.surfaces, contacts, m_scratch.positions,
                      m_scratch.velocities, m_scratch.forces);
    for (const Contact<Real>& contact : contacts) {
      Vector3<Real>& force = m_scratch.forces[contact.vertex];
      if (!force.isZero(Real(0))) AddOuterForce(m_plan.places[contact.vertex], lane, force);
      force.setZero();  // a vertex may have several contacts
    }
  }

  void AddOuterForce(std::size_t place, std::size_t lane, const Vector3<Real>& force) {
    if (m_scratch.hasOuter[place] == 0) {
      std::fill_n(m_outer + 3 * place * m_width, 3 * m_width, Real(0));
      m_scratch.hasOuter[place] = 1;
      m_scratch.outerPlaces.push_back(static_cast<std::uint32_t>(place));
    }
    for (int k = 0; k < 3; ++k) At(m_outer, place, 3, static_cast<std::size_t>(k), lane) += force[k];
  }

  void CopyVertex(std::size_t vertex, std::size_t lane, Real* from) {
    const std::size_t place = m_plan.places[vertex];
    for (int k = 0; k < 3; ++k) {
      m_scratch.positions[vertex][k] = At(from, place, 6, static_cast<std::size_t>(k), lane);
      m_scratch.velocities[vertex][k] = At(from, place, 6, static_cast<std::size_t>(k) + 3, lane);
    }
  }

  // sums: of squares over a body's vertices.
  void AddErrors(const Real* sums, double weight) {
    for (std::size_t lane = 0; lane < m_groups.size(); ++lane) {
      MemberOf(*m_groups[lane]).error += weight * std::sqrt(double{sums[lane]} / m_tables.count);
    }
  }

  void UpdateAllAnchors() {
    m_scratch.contacts.Update(m_lanes.state, m_width);
    if (IsBulkLaw(m_body.contact.law)) return;
    for (std::size_t lane = 0; lane < m_groups.size(); ++lane) {
      const Member<Real>& member = MemberOf(*m_groups[lane]);
      for (const Contact<Real>& contact : member.state->contacts) CopyVertex(contact.vertex, lane, m_lanes.state);
      UpdateAnchors<Real>(m_body.contact, member.surfaces, member.state->contacts, m_scratch.positions);
    }
  }

  const SweepPlan<Real>& m_plan;
  const Coefficients<Real>& m_body;
  SweepTables<Real> m_tables;
  std::span<Group<Real>* const> m_groups;
  const SweepKernel<Real>& m_kernel;
  ContactKernel<Real> m_contactKernel;
  PackScratch<Real>& m_scratch;
  std::size_t m_width;
  SweepLanes<Real> m_lanes;
  Real* m_outer = nullptr;
  Real* m_acceleration = nullptr;
  Real* m_gas = nullptr;
  Real* m_stiffnessFactors = nullptr;
};

template <class Real>
struct Seat {
  Seat(Member<Real>*& member, const StepRules& rules, GroupScratch<Real>& scratch)
      : group({&member, 1}, {}, nullptr, scratch), tick(group, rules) {}

  Group<Real> group;
  GroupTick<Real> tick;
  int next = 0;  // substeps of its next try; 0: it has had the last
};

}  // namespace

template <class Real>
void PackScratch<Real>::Reserve(std::size_t vertices) {
  lines.reserve((6 * 4 + 3 + 6) * vertices * kWidestPack * sizeof(Real) / sizeof(Line) + 16 * kWidestPack);
  hasOuter.reserve(vertices);
  outerPlaces.reserve(vertices);
  positions.reserve(vertices);
  velocities.reserve(vertices);
  forces.reserve(vertices);
  contacts.Reserve(kWidestPack * vertices);
  for (GroupScratch<Real>& each : groups) each.Reserve(vertices, 1);
}

template <class Real>
bool CanGoInPack(const Blueprint& blueprint) {
  return blueprint.integrator == Integrator::kRungeKutta4 && blueprint.full.contact.law != ContactLaw::kBacktracking &&
         !blueprint.ReadPlan<Real>().vertices.empty();
}

template <class Real>
int FindFirstSubsteps(const Member<Real>& member, const StepRules& rules) {
  return FindSubstepsOf<Real>(member, member.blueprint->integrator, {}, rules);
}

template <class Real>
void IntegratePack(std::span<Member<Real>*> members, double duration, int substeps,
                   std::span<const SweepKernel<Real>> kernels, PackScratch<Real>& scratch) {
  std::array<std::optional<Group<Real>>, kWidestPack> groups;
  std::array<Group<Real>*, kWidestPack> pointers{};
  for (std::size_t i = 0; i < members.size(); ++i) {
    pointers[i] =
        &groups[i].emplace(members.subspan(i, 1), std::span<const Encounter<Real>>(), nullptr, scratch.groups[i]);
  }
  Pack<Real>(*members[0]->blueprint, std::span(pointers).first(members.size()), kernels, scratch)
      .Integrate(duration, substeps);
  for (std::size_t i = 0; i < members.size(); ++i) groups[i]->Scatter();
}

template <class Real>
void StepPack(std::span<Member<Real>*> members, int substeps, const StepRules& rules,
              std::span<const SweepKernel<Real>> kernels, PackScratch<Real>& scratch,
              std::span<GroupOutcome> outcomes) {
  std::array<std::optional<Seat<Real>>, kWidestPack> seats;
  for (std::size_t i = 0; i < members.size(); ++i) {
    seats[i].emplace(members[i], rules, scratch.groups[i]);
    seats[i]->next = substeps;
  }
  for (;;) {
    // All but the first try are of few bodies: each has its own number of substeps then.
    std::array<Group<Real>*, kWidestPack> groups{};
    std::array<std::size_t, kWidestPack> whose{};
    std::size_t count = 0;
    int next = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (seats[i]->next == 0 || (next != 0 && seats[i]->next != next)) continue;
      next = seats[i]->next;
      whose[count] = i;
      groups[count++] = &seats[i]->group;
    }
    if (count == 0) break;
    Pack<Real>(*members[0]->blueprint, std::span(groups).first(count), kernels, scratch)
        .Integrate(rules.duration, next);
    for (std::size_t i = 0; i < count; ++i) seats[whose[i]]->next = seats[whose[i]]->tick.Judge(next);
  }
  for (std::size_t i = 0; i < members.size(); ++i) outcomes[i] = seats[i]->tick.Finish();
}

#define WOBBLE_INSTANTIATE(Real)                                                                                    \
  template struct PackScratch<Real>;                                                                                \
  template bool CanGoInPack<Real>(const Blueprint&);                                                                \
  template int FindFirstSubsteps<Real>(const Member<Real>&, const StepRules&);                                      \
  template void IntegratePack<Real>(std::span<Member<Real>*>, double, int, std::span<const SweepKernel<Real>>,      \
                                    PackScratch<Real>&);                                                            \
  template void StepPack<Real>(std::span<Member<Real>*>, int, const StepRules&, std::span<const SweepKernel<Real>>, \
                               PackScratch<Real>&, std::span<GroupOutcome>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
