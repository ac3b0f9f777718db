// Boxes first, by the broad phase; then vertices against faces, side by side for all pairs. What a pair's contacts
// remember lives on from tick to tick: both lists ascend, so one walk along them finds each pair's past.
#include "server/physics/pair_search.h"

namespace wobble::physics {
namespace {

// Room for so many contacts is made when two bodies meet: more seldom come, and a list that is full grows.
constexpr std::size_t kLikelyContacts = 128;

template <class Real>
bool ComesBefore(const BodyPair<Real>& a, const BodyPair<Real>& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

template <class Real>
bool HasContacts(const BodyPair<Real>& pair) {
  return !pair.sides[0].empty() || !pair.sides[1].empty();
}

}  // namespace

template <class Real>
void PairSearch<Real>::FindPairs() {
  m_work.pairs.swap(m_work.pairsBefore);
  m_work.pairs.clear();
  m_work.pairIndices.clear();
  auto before = m_work.pairsBefore.begin();
  for (const auto& [a, b] : m_work.broadPhase.FindOverlaps(m_work.boxes)) {
    if (HasNoFaces(a) || HasNoFaces(b)) continue;
    BodyPair<Real> pair{m_bodies[a].id, m_bodies[b].id, {}};
    for (; before != m_work.pairsBefore.end() && ComesBefore(*before, pair); ++before) Recycle(*before);
    const bool known = before != m_work.pairsBefore.end() && !ComesBefore(pair, *before);
    for (std::size_t side = 0; side < 2; ++side) {
      pair.sides[side] = known ? std::move(before->sides[side]) : TakeSpareList();
    }
    if (known) ++before;
    m_work.pairs.push_back(std::move(pair));
    m_work.pairIndices.push_back({a, b});
  }
  for (; before != m_work.pairsBefore.end(); ++before) Recycle(*before);
}

template <class Real>
void PairSearch<Real>::Recycle(BodyPair<Real>& pair) {
  for (auto& side : pair.sides) m_work.spareLists.push_back(std::move(side));
}

template <class Real>
std::vector<BodyContact<Real>> PairSearch<Real>::TakeSpareList() {
  std::vector<BodyContact<Real>> list;
  if (!m_work.spareLists.empty()) {
    list = std::move(m_work.spareLists.back());
    m_work.spareLists.pop_back();
  }
  list.clear();
  list.reserve(kLikelyContacts);
  return list;
}

template <class Real>
bool PairSearch<Real>::HasNoFaces(std::uint32_t body) const {
  return m_work.members[body].blueprint->full.faces.empty();
}

template <class Real>
void PairSearch<Real>::MeetAll() {
  m_threads.ForEach(m_work.pairs.size(), [this](std::size_t i) {
    const auto [a, b] = m_work.pairIndices[i];
    if (m_work.pairs[i].met || (m_bodies[a].asleep && m_bodies[b].asleep)) return;
    m_work.pairs[i].met = true;
    Meet(i);
  });
}

template <class Real>
void PairSearch<Real>::Meet(std::size_t pair) {
  for (std::size_t side = 0; side < 2; ++side) {
    const Member<Real>& vertices = m_work.members[m_work.pairIndices[pair][side]];
    const Member<Real>& faces = m_work.members[m_work.pairIndices[pair][1 - side]];
    const Meeting<Real> meeting = MakeMeeting<Real>(vertices, vertices.state->positions, vertices.state->velocities,
                                                    faces, faces.state->positions, faces.state->velocities);
    Bounds<Real> near = faces.bounds;
    near.speed += vertices.bounds.speed;
    const Real fat = static_cast<Real>(kNearMargin) + near.speed * static_cast<Real>(m_duration);
    near.low.array() -= fat;
    near.high.array() += fat;
    const Shell<Real> own{vertices.blueprint->template Read<Real>().faces, &vertices.blueprint->topology,
                          vertices.state->positions};
    const ContactParameters<Real> both =
        Combine(vertices.blueprint->template Read<Real>().contact, faces.blueprint->template Read<Real>().contact);
    FindBodyContacts<Real>(both, meeting, own, near, static_cast<Real>(kNearMargin), static_cast<Real>(m_duration),
                           m_work.pairs[pair].sides[side], m_work.scratch.local().bodyContacts);
  }
}

template <class Real>
bool PairSearch<Real>::WakeTouched() {
  m_work.woken.clear();
  for (std::size_t i = 0; i < m_work.pairs.size(); ++i) {
    const auto [a, b] = m_work.pairIndices[i];
    if (m_bodies[a].asleep == m_bodies[b].asleep || !HasContacts(m_work.pairs[i])) continue;
    const std::uint32_t sleeper = m_bodies[a].asleep ? a : b;
    WakeUp(m_bodies[sleeper]);
    m_work.woken.push_back(sleeper);
  }
  return !m_work.woken.empty();
}

template <class Real>
void PairSearch<Real>::DropPairsApart() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < m_work.pairs.size(); ++i) {
    if (!HasContacts(m_work.pairs[i])) {
      Recycle(m_work.pairs[i]);
      continue;
    }
    if (kept != i) {
      m_work.pairs[kept] = std::move(m_work.pairs[i]);
      m_work.pairIndices[kept] = m_work.pairIndices[i];
    }
    ++kept;
  }
  m_work.pairs.resize(kept);
  m_work.pairIndices.resize(kept);
}

template class PairSearch<float>;
template class PairSearch<double>;

}  // namespace wobble::physics
