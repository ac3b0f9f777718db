// Bodies whose cores meet are few and so for a moment, so a system without any does nothing here.
#include "server/physics/step/system_cores.h"

namespace wobble::physics {
namespace {

// Of mass, in the body's local coordinates, m.
template <class Real>
Vector3d FindCentre(const Blueprint& blueprint, const VectorView<Real>& x) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < blueprint.rest.size(); ++i) {
    sum += blueprint.full.masses[i] * x[i].template cast<double>();
  }
  return sum / blueprint.totalMass;
}

}  // namespace

template <class Real>
void SystemCores<Real>::Build(std::span<const ContactPair<Real>> contactPairs, std::span<Member<Real>* const> members) {
  m_members = members;
  m_pairs.clear();
  for (const ContactPair<Real>& pair : contactPairs) {
    if (pair.core == nullptr || !pair.core->MayAct()) continue;
    const auto [first, second] = pair.members;
    m_pairs.push_back({.members = pair.members,
                       .contact = *pair.core,
                       .shift = members[second]->state->origin - members[first]->state->origin,
                       .force = Vector3d::Zero()});
  }
}

template <class Real>
void SystemCores<Real>::ComputeForces(std::span<const Motion<Real>> motions) {
  for (Pair& pair : m_pairs) {
    const auto [first, second] = pair.members;
    const Vector3d apart = pair.shift + FindCentre(*m_members[second]->blueprint, motions[second].x) -
                           FindCentre(*m_members[first]->blueprint, motions[first].x);
    pair.force = FindCoreForce(pair.contact, apart);
    pair.acts = (pair.force.array() != 0).any();
  }
}

template class SystemCores<float>;
template class SystemCores<double>;

}  // namespace wobble::physics
