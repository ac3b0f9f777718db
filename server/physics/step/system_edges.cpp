// Pairs with edge contacts are kept in a list of their own, so a system without any does nothing here.
#include "server/physics/step/system_edges.h"

#include <algorithm>

namespace wobble::physics {

template <class Real>
void SystemEdges<Real>::Build(std::span<const ContactPair<Real>> contactPairs, std::span<Member<Real>* const> members) {
  m_pairs.clear();
  m_before.clear();
  for (std::size_t i = 0; i < contactPairs.size(); ++i) {
    const ContactPair<Real>& contactPair = contactPairs[i];
    if (contactPair.edges == nullptr || contactPair.edges->empty()) continue;
    const auto [first, second] = contactPair.members;
    const std::size_t begin = m_before.size();
    m_before.insert(m_before.end(), contactPair.edges->begin(), contactPair.edges->end());
    m_pairs.push_back(
        {.contactPair = i,
         .members = contactPair.members,
         .contacts = contactPair.edges,
         .begin = begin,
         .end = m_before.size(),
         .parameters = contactPair.parameters,
         .meeting = MakeEdgeMeeting<Real>(*members[first], {}, {}, *members[second], {}, {}, contactPair.gap)});
  }
  if (m_pairs.empty()) return;
  m_forces.resize(m_before.size());
  m_sidesBegin.assign(members.size() + 1, 0);
  for (const Pair& pair : m_pairs) {
    for (const std::uint32_t member : pair.members) ++m_sidesBegin[member + 1U];
  }
  for (std::size_t i = 0; i < members.size(); ++i) m_sidesBegin[i + 1] += m_sidesBegin[i];
  m_sides.clear();
  for (std::size_t side = 0; side < 2 * m_pairs.size(); ++side) m_sides.push_back(side);
  std::sort(m_sides.begin(), m_sides.end(), [this](std::size_t a, std::size_t b) {
    const std::uint32_t ofA = m_pairs[a / 2].members[a % 2];
    const std::uint32_t ofB = m_pairs[b / 2].members[b % 2];
    return ofA != ofB ? ofA < ofB : a < b;
  });
}

template <class Real>
EdgeMeeting<Real> SystemEdges<Real>::Meet(const Pair& pair, std::span<const Motion<Real>> motions) {
  EdgeMeeting<Real> meeting = pair.meeting;
  meeting.first.x = motions[pair.members[0]].x;
  meeting.first.v = motions[pair.members[0]].v;
  meeting.second.x = motions[pair.members[1]].x;
  meeting.second.v = motions[pair.members[1]].v;
  return meeting;
}

template <class Real>
template <class Visit>
void SystemEdges<Real>::ForEachPair(Threads* threads, const Visit& visit) const {
  if (threads != nullptr && m_pairs.size() > 1) {
    threads->ForEach(m_pairs.size(), [&](std::size_t i) { visit(m_pairs[i]); });
  } else {
    for (const Pair& pair : m_pairs) visit(pair);
  }
}

template <class Real>
void SystemEdges<Real>::ComputeForces(std::span<const Motion<Real>> motions, Threads* threads) {
  ForEachPair(threads, [&](const Pair& pair) {
    ComputeEdgeContacts<Real>(pair.parameters, Meet(pair, motions), *pair.contacts,
                              std::span(m_forces).subspan(pair.begin, pair.end - pair.begin));
  });
}

template <class Real>
void SystemEdges<Real>::Update(std::span<const Motion<Real>> motions, Real h, Threads* threads) const {
  ForEachPair(threads, [&](const Pair& pair) {
    UpdateEdgeContacts<Real>(pair.parameters, Meet(pair, motions), h, *pair.contacts);
  });
}

template <class Real>
void SystemEdges<Real>::PutBack(std::size_t begin, std::size_t end) const {
  for (const Pair& pair : m_pairs) {
    if (pair.contactPair < begin || pair.contactPair >= end) continue;
    std::copy(m_before.begin() + static_cast<std::ptrdiff_t>(pair.begin),
              m_before.begin() + static_cast<std::ptrdiff_t>(pair.end), pair.contacts->begin());
  }
}

template class SystemEdges<float>;
template class SystemEdges<double>;

}  // namespace wobble::physics
