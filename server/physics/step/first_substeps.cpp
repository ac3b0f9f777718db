// Contacts between members raise the frequencies of both bodies: their stiffness and damping are summed for each vertex
// of the island first, then the largest rates of each member are added to its own modes (methods/stability.h).
#include "server/physics/step/first_substeps.h"

#include <algorithm>

#include "server/physics/methods/stability.h"

namespace wobble::physics {
namespace {

// The largest rates that contacts with other members add to the body. loads: one a vertex.
template <class Real>
ContactRates FindLargestRates(const Member<Real>& member, std::span<const VertexLoad> loads) {
  ContactRates rates;
  for (std::size_t vertex = 0; const VertexLoad& load : loads) {
    const double mass = member.blueprint->full.masses[vertex++];
    rates.squareFrequency = std::max(rates.squareFrequency, load.stiffness / mass);
    rates.dampingRate = std::max(rates.dampingRate, load.damping / mass);
  }
  return rates;
}

// The spring between two cores swings each body as a whole, and so each of its vertices.
template <class Real>
void AddCoreLoads(const CoreContact& core, const Member<Real>& first, const Member<Real>& second,
                  std::span<VertexLoad> loads, std::span<VertexLoad> otherLoads) {
  const double square = FindSquareCoreFrequency(core, first.blueprint->totalMass, second.blueprint->totalMass);
  if (!(square > 0)) return;
  const auto add = [square](const Member<Real>& member, std::span<VertexLoad> of) {
    for (std::size_t i = 0; i < of.size(); ++i) of[i].stiffness += square * member.blueprint->full.masses[i];
  };
  add(first, loads);
  add(second, otherLoads);
}

// Adds what the contacts ask of each vertex to `loads` and returns the substeps that the fastest contact asks for.
// begins: of each member's vertices in `loads`.
template <class Real>
int AddAllContactLoads(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
                       double duration, std::span<const std::size_t> begins, std::span<VertexLoad> loads) {
  int most = 1;
  const auto loadsOf = [&](std::size_t i) { return loads.subspan(begins[i], begins[i + 1] - begins[i]); };
  for (const ContactPair<Real>& contactPair : contactPairs) {
    for (std::size_t side = 0; side < 2; ++side) {
      const std::uint32_t vertices = contactPair.members[side];
      const std::uint32_t faces = contactPair.members[1 - side];
      most =
          std::max(most, AddContactLoads<Real>(contactPair.parameters,
                                               MakeMeeting<Real>(*members[vertices], *members[faces], contactPair.gap),
                                               *contactPair.sides[side], duration, loadsOf(vertices), loadsOf(faces)));
    }
    const auto [first, second] = contactPair.members;
    if (contactPair.core != nullptr)
      AddCoreLoads<Real>(*contactPair.core, *members[first], *members[second], loadsOf(first), loadsOf(second));
    if (contactPair.edges == nullptr) continue;
    most = std::max(most,
                    AddEdgeContactLoads<Real>(contactPair.parameters,
                                              MakeEdgeMeeting<Real>(*members[first], *members[second], contactPair.gap),
                                              *contactPair.edges, duration, loadsOf(first), loadsOf(second)));
  }
  return most;
}

}  // namespace

template <class Real>
Integrator FindIntegrator(std::span<Member<Real>* const> members) {
  const Integrator first = members[0]->blueprint->integrator;
  const auto isFirst = [first](const Member<Real>* member) { return member->blueprint->integrator == first; };
  return std::all_of(members.begin(), members.end(), isFirst) ? first : Integrator::kRungeKutta4;
}

template <class Real>
int FindFirstSubsteps(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
                      const StepRules& rules, std::vector<VertexLoad>& loads, std::vector<std::size_t>& begins) {
  begins.assign(1, 0);
  for (const Member<Real>* member : members) begins.push_back(begins.back() + member->state->positions.size());
  loads.assign(contactPairs.empty() ? 0 : begins.back(), {});
  int most = AddAllContactLoads(members, contactPairs, rules.duration, begins, loads);
  most = std::max(most, rules.leastSubsteps);
  const Integrator integrator = FindIntegrator(members);
  for (std::size_t i = 0; i < members.size(); ++i) {
    const Member<Real>& member = *members[i];
    ContactRates fromBodies;
    if (!loads.empty()) {
      fromBodies = FindLargestRates<Real>(member, std::span(loads).subspan(begins[i], begins[i + 1] - begins[i]));
    }
    const int forStability = ChooseSubsteps<Real>(integrator, *member.blueprint, member.load, *member.state,
                                                  member.demands, fromBodies, rules.duration);
    most = std::max({most, forStability, std::min(member.substepsForError, rules.maxSubsteps)});
  }
  return most;
}

#define WOBBLE_INSTANTIATE(Real)                                                                           \
  template Integrator FindIntegrator<Real>(std::span<Member<Real>* const>);                                \
  template int FindFirstSubsteps<Real>(std::span<Member<Real>* const>, std::span<const ContactPair<Real>>, \
                                       const StepRules&, std::vector<VertexLoad>&, std::vector<std::size_t>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
