// Bodies that touch are one system of equations: their states stand behind one another in one array, so that each stage
// of RK4 sees all of them at the same moment, and forces between them are equal and opposite at every stage.
#include "server/physics/group_step.h"

#include <algorithm>
#include <cmath>

#include "server/physics/stability.h"
#include "server/physics/step_choice.h"

namespace wobble::physics {
namespace {

// Times that a tick which missed its error is stepped again: the first guess from a bad tick may fall short.
constexpr int kMaxRedos = 2;
// Times that a tick which left a body in a state that cannot be is stepped again, each in twice the substeps.
constexpr int kMaxRescues = 4;
// Acceleration that the energy check takes for the least in its M g R, m/s²: without gravity a body at rest would have
// no energy to compare with.
constexpr double kLeastGravity = 1;

template <class Real>
double FindRms(std::span<const Vector3<Real>> values) {
  double sum = 0;
  for (const Vector3<Real>& value : values) sum += double{value.squaredNorm()};
  return std::sqrt(sum / static_cast<double>(values.size()));
}

template <class Real>
double FindRmsOfDifference(std::span<const Vector3<Real>> a, std::span<const Vector3<Real>> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double{(a[i] - b[i]).squaredNorm()};
  return std::sqrt(sum / static_cast<double>(a.size()));
}

template <class Real>
class Group {
 public:
  Group(std::span<Member<Real>* const> members, std::span<const Encounter<Real>> encounters, const StepRules& rules,
        Threads* threads, GroupScratch<Real>& scratch)
      : m_members(members), m_encounters(encounters), m_rules(rules), m_threads(threads), m_scratch(scratch) {}

  GroupOutcome Step() {
    Gather();
    SaveContacts();
    GroupOutcome outcome;
    int redos = 0;
    int rescues = 0;
    for (int next = FindSubsteps(); next > 0;) {
      if (outcome.substeps > 0) StartAgain();
      Integrate(next);
      outcome.substeps = next;
      outcome.allSubsteps += next;
      if (!FindBadMembers()) {
        next = redos++ < kMaxRedos ? FindFinerSubsteps(outcome.substeps) : 0;
      } else {
        next = rescues++ < kMaxRescues && !BlameThoseWhoBeganBad() ? 2 * outcome.substeps : 0;
      }
    }
    Scatter();
    return outcome;
  }

 private:
  template <class Visit>
  void ForEach(std::size_t count, const Visit& visit) const {
    if (m_threads != nullptr) {
      m_threads->ForEach(count, visit);
    } else {
      for (std::size_t i = 0; i < count; ++i) visit(i);
    }
  }

  template <class Value>
  std::span<Value> PartOf(std::span<Value> values, std::size_t member) const {
    const std::size_t begin = m_scratch.begins[member];
    return values.subspan(begin, m_scratch.begins[member + 1] - begin);
  }
  template <class Value>
  std::span<const Value> PartOf(const std::vector<Value>& values, std::size_t member) const {
    return PartOf(std::span<const Value>(values), member);
  }

  // The bodies' own states stay as the tick found them until Scatter.
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
      Member<Real>& member = *m_members[i];
      State<Real>& state = *member.state;
      const auto positions = PartOf(m_scratch.positions, i);
      const auto velocities = PartOf(m_scratch.velocities, i);
      member.speed = FindRms<Real>(velocities);
      member.acceleration = FindRmsOfDifference<Real>(velocities, state.velocities) / m_rules.duration;
      std::copy(positions.begin(), positions.end(), state.positions.begin());
      std::copy(velocities.begin(), velocities.end(), state.velocities.begin());
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
  }

  Meeting<Real> Meet(const Encounter<Real>& encounter, std::size_t side, std::span<const Vector3<Real>> x,
                     std::span<const Vector3<Real>> v) const {
    const std::uint32_t vertices = encounter.members[side];
    const std::uint32_t faces = encounter.members[1 - side];
    return MakeMeeting<Real>(*m_members[vertices], PartOf(x, vertices), PartOf(v, vertices), *m_members[faces],
                             PartOf(x, faces), PartOf(v, faces));
  }

  int FindSubsteps() {
    m_scratch.loads.assign(m_scratch.positions.size(), {});
    int most = AddAllContactLoads();
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const Member<Real>& member = *m_members[i];
      ContactRates rates;
      for (std::size_t vertex = 0; const VertexLoad& load : PartOf(m_scratch.loads, i)) {
        const double mass = member.blueprint->full.masses[vertex++];
        rates.squareFrequency = std::max(rates.squareFrequency, load.stiffness / mass);
        rates.dampingRate = std::max(rates.dampingRate, load.damping / mass);
      }
      const int forStability =
          ChooseSubsteps<Real>(*member.blueprint, member.load, member.surfaces, *member.state, rates, m_rules.duration);
      most = std::max({most, forStability, std::min(member.substepsForError, m_rules.maxSubsteps)});
    }
    return most;
  }

  int AddAllContactLoads() {
    int most = 1;
    const std::span<VertexLoad> loads(m_scratch.loads);
    for (const Encounter<Real>& encounter : m_encounters) {
      for (std::size_t side = 0; side < 2; ++side) {
        const Meeting<Real> meeting = Meet(encounter, side, m_scratch.positions, m_scratch.velocities);
        most = std::max(most, AddContactLoads<Real>(encounter.parameters, meeting, *encounter.sides[side],
                                                    m_rules.duration, PartOf(loads, encounter.members[side]),
                                                    PartOf(loads, encounter.members[1 - side])));
      }
    }
    return most;
  }

  // RK4, with each member's error estimated as step_choice.h says.
  void Integrate(int substeps) {
    const double step = m_rules.duration / substeps;
    const auto h = static_cast<Real>(step);
    for (Member<Real>* member : m_members) member->error = 0;
    m_scratch.stages.Resize(m_scratch.positions.size());
    for (int substep = 0; substep < substeps; ++substep) {
      for (std::size_t stage = 0; stage < 4; ++stage) {
        Accelerate(stage, h);
        if (stage == 0 && substep > 0) AddAccelerationErrors(step, m_rules.duration - substep * step);
      }
      FinishSubstep(step);
    }
    for (Member<Real>* member : m_members) member->error *= kErrorShare / substeps;
  }

  void Accelerate(std::size_t stage, Real h) {
    auto& stages = m_scratch.stages;
    const std::span<const Vector3<Real>> x(stages.positions);
    const std::span<const Vector3<Real>> v(stages.velocities[stage]);
    const std::span<Vector3<Real>> a(stages.accelerations[stage]);
    ForEach(m_members.size(), [&](std::size_t i) {
      CombineStage<Real>(kClassicRungeKutta, stage, h, m_scratch.positions, m_scratch.velocities, m_scratch.begins[i],
                         m_scratch.begins[i + 1], stages);
      const Member<Real>& member = *m_members[i];
      ComputeForces<Real>(member.blueprint->template Read<Real>(), member.load, member.surfaces, member.state->contacts,
                          PartOf(x, i), PartOf(v, i), PartOf(a, i));
    });
    for (const Encounter<Real>& encounter : m_encounters) {
      for (std::size_t side = 0; side < 2; ++side) {
        AddBodyContacts<Real>(encounter.parameters, Meet(encounter, side, x, v), *encounter.sides[side],
                              PartOf(a, encounter.members[side]), PartOf(a, encounter.members[1 - side]));
      }
    }
    ForEach(m_members.size(), [&](std::size_t i) {
      DivideByMasses<Real>(m_members[i]->blueprint->template Read<Real>(), m_members[i]->load, PartOf(a, i));
    });
  }

  void FinishSubstep(double step) {
    auto& stages = m_scratch.stages;
    const auto h = static_cast<Real>(step);
    const std::span<const Vector3<Real>> x(m_scratch.positions);
    const std::span<const Vector3<Real>> v(m_scratch.velocities);
    ForEach(m_members.size(), [&](std::size_t i) {
      AddIncrements<Real>(kClassicRungeKutta, h, m_scratch.begins[i], m_scratch.begins[i + 1], stages,
                          m_scratch.positions, m_scratch.velocities);
      Member<Real>& member = *m_members[i];
      member.error += step / 6 * FindRmsOfDifference<Real>(PartOf(stages.velocities[3], i), PartOf(v, i));
      UpdateAnchors<Real>(member.blueprint->template Read<Real>().contact, member.surfaces, member.state->contacts,
                          PartOf(x, i));
    });
    for (const Encounter<Real>& encounter : m_encounters) {
      for (std::size_t side = 0; side < 2; ++side) {
        UpdateBodyContacts<Real>(encounter.parameters, Meet(encounter, side, x, v), h, *encounter.sides[side]);
      }
    }
  }

  // a₄ of the substep before still stands in its place when the first stage of the next one is known.
  void AddAccelerationErrors(double step, double timeLeft) {
    const auto& accelerations = m_scratch.stages.accelerations;
    ForEach(m_members.size(), [&](std::size_t i) {
      m_members[i]->error +=
          step / 6 * FindRmsOfDifference<Real>(PartOf(accelerations[3], i), PartOf(accelerations[0], i)) * timeLeft;
    });
  }

  // More substeps for a tick that missed its error by far; 0 when none did, or none are to be had.
  int FindFinerSubsteps(int substeps) const {
    int wanted = 0;
    for (const Member<Real>* member : m_members) {
      if (member->error <= kRedoFactor * m_rules.allowedError) continue;
      wanted = std::max(wanted, FindSubstepsForError(member->error, substeps, m_rules.allowedError));
    }
    wanted = std::min(wanted, m_rules.maxSubsteps);
    return wanted > substeps ? wanted : 0;
  }

  bool FindBadMembers() {
    bool anyBad = false;
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      Member<Real>& member = *m_members[i];
      const Health health = FindHealth<Real>(member.blueprint->template Read<Real>(), PartOf(m_scratch.positions, i),
                                             PartOf(m_scratch.velocities, i));
      member.health = std::max(member.health, health);
      member.lost = health != Health::kGood;
      anyBad |= member.lost;
    }
    if (anyBad) return true;
    Member<Real>* runaway = FindRunaway();
    if (runaway == nullptr) return false;
    runaway->health = std::max(runaway->health, Health::kRunaway);
    runaway->lost = true;
    return true;
  }

  // No step can help a member that began the tick in a state that cannot be. It alone is lost then, and what it has
  // touched goes back to where it began.
  bool BlameThoseWhoBeganBad() {
    const auto beganBad = [](const Member<Real>* member) {
      const Coefficients<Real>& body = member->blueprint->template Read<Real>();
      return FindHealth<Real>(body, member->state->positions, member->state->velocities) != Health::kGood;
    };
    if (std::none_of(m_members.begin(), m_members.end(), beganBad)) return false;
    StartAgain();
    for (Member<Real>* member : m_members) {
      member->lost = beganBad(member);
      if (!member->lost) member->health = Health::kGood;
    }
    return true;
  }

  // The member that gained most when the group as a whole has gained energy from nowhere. Forces that are constant
  // through the tick have a potential, everything else conserves or dissipates. Elastic energies are looked at only
  // where motion has gained so much, so that a quiet tick costs two sums over its vertices.
  Member<Real>* FindRunaway() const {
    Member<Real>* greatest = nullptr;
    double largest = 0;
    double gained = 0;
    double scale = 0;
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      Member<Real>& member = *m_members[i];
      const Blueprint& blueprint = *member.blueprint;
      const State<Real>& before = *member.state;
      const double gain = ComputeMotionEnergy<Real>(blueprint, member.load, PartOf(m_scratch.positions, i),
                                                    PartOf(m_scratch.velocities, i)) -
                          ComputeMotionEnergy<Real>(blueprint, member.load, before.positions, before.velocities);
      gained += gain;
      if (gain > largest) {
        largest = gain;
        greatest = &member;
      }
      const double gravity = std::max(kLeastGravity, double{member.load.acceleration.norm()});
      scale += blueprint.totalMass * gravity * blueprint.reach +
               ComputeMotionEnergy<Real>(blueprint, {}, before.positions, before.velocities);
    }
    if (greatest == nullptr || gained <= kRunawayShare * scale) return nullptr;
    return gained + FindElasticGain() > kRunawayShare * scale ? greatest : nullptr;
  }

  double FindElasticGain() const {
    double gain = 0;
    auto contactsBefore = std::span<const Contact<Real>>(m_scratch.contacts);
    for (std::size_t i = 0; i < m_members.size(); ++i) {
      const Member<Real>& member = *m_members[i];
      const std::size_t count = member.state->contacts.size();
      gain += ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, member.state->contacts,
                                         PartOf(m_scratch.positions, i), m_scratch.places) -
              ComputeElasticEnergy<Real>(*member.blueprint, member.load, member.surfaces, contactsBefore.first(count),
                                         member.state->positions, m_scratch.places);
      contactsBefore = contactsBefore.subspan(count);
    }
    auto bodyContactsBefore = std::span<const BodyContact<Real>>(m_scratch.bodyContacts);
    for (const Encounter<Real>& encounter : m_encounters) {
      for (std::size_t side = 0; side < 2; ++side) {
        const std::size_t count = encounter.sides[side]->size();
        const Member<Real>& vertices = *m_members[encounter.members[side]];
        const Member<Real>& faces = *m_members[encounter.members[1 - side]];
        const Meeting<Real> before = MakeMeeting<Real>(vertices, vertices.state->positions, vertices.state->velocities,
                                                       faces, faces.state->positions, faces.state->velocities);
        const Meeting<Real> after = Meet(encounter, side, m_scratch.positions, m_scratch.velocities);
        gain += ComputeBodyContactEnergy<Real>(encounter.parameters, after, *encounter.sides[side]) -
                ComputeBodyContactEnergy<Real>(encounter.parameters, before, bodyContactsBefore.first(count));
        bodyContactsBefore = bodyContactsBefore.subspan(count);
      }
    }
    return gain;
  }

  std::span<Member<Real>* const> m_members;
  std::span<const Encounter<Real>> m_encounters;
  const StepRules& m_rules;
  Threads* m_threads;
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
GroupOutcome StepGroup(std::span<Member<Real>* const> members, std::span<const Encounter<Real>> encounters,
                       const StepRules& rules, Threads* threads, GroupScratch<Real>& scratch) {
  return Group<Real>(members, encounters, rules, threads, scratch).Step();
}

#define WOBBLE_INSTANTIATE(Real)                                                                            \
  template Meeting<Real> MakeMeeting<Real>(const Member<Real>&, std::span<const Vector3<Real>>,             \
                                           std::span<const Vector3<Real>>, const Member<Real>&,             \
                                           std::span<const Vector3<Real>>, std::span<const Vector3<Real>>); \
  template GroupOutcome StepGroup<Real>(std::span<Member<Real>* const>, std::span<const Encounter<Real>>,   \
                                        const StepRules&, Threads*, GroupScratch<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
