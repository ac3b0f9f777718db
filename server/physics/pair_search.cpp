// Boxes first, by the broad phase; then vertices against faces, side by side for all pairs. What a pair's contacts
// remember lives on from tick to tick: both lists ascend, so one walk along them finds each pair's past.
#include "server/physics/pair_search.h"

#include <algorithm>
#include <iterator>

namespace wobble::physics {
namespace {

// Room for so many contacts is made when two bodies meet: more seldom come, and a list that is full grows.
constexpr std::size_t kLikelyContacts = 128;

template <class Real>
bool HasContacts(const BodyPair<Real>& pair) {
  return !pair.sides[0].empty() || !pair.sides[1].empty();
}

template <class Real>
Skin<Real> FindSkin(const Member<Real>& member) {
  return {member.blueprint->template Read<Real>().faces, &member.blueprint->topology, member.state->positions};
}

}  // namespace

template <class Real>
void PairSearch<Real>::FindPairs() {
  ReserveSurfaces();
  m_work.pairs.swap(m_work.pairsBefore);
  m_work.pairs.clear();
  m_work.overlaps.clear();
  const std::span<const std::uint32_t> awake = m_table.roster.FindAwake();
  m_work.awakeBoxes.clear();
  for (const std::uint32_t body : awake) m_work.awakeBoxes.push_back(m_work.boxes[body]);
  for (const auto& [a, b] : m_work.broadPhase.FindOverlaps(m_work.awakeBoxes)) {
    m_work.overlaps.push_back({awake[a], awake[b]});
  }
  const std::size_t amongAwake = m_work.overlaps.size();
  for (const std::uint32_t body : awake) AddOverlapsWithSleepers(body);
  if (m_work.overlaps.size() > amongAwake) std::sort(m_work.overlaps.begin(), m_work.overlaps.end());
  TakeRestingPairs();
  AddPairs();
}

template <class Real>
void PairSearch<Real>::AddOverlapsWithSleepers(std::uint32_t body) {
  m_table.roster.Sleepers().VisitOverlaps(m_work.boxes[body], [&](std::uint32_t sleeper) {
    m_work.overlaps.push_back({std::min(body, sleeper), std::max(body, sleeper)});
  });
}

// What somebody has woken, not others near them: to the pairs of before.
template <class Real>
void PairSearch<Real>::TakeRestingPairs() {
  if (m_work.wakesSeen == m_table.roster.CountWakes()) return;
  m_work.wakesSeen = m_table.roster.CountWakes();
  const auto sleeps = [this](const BodyPair<Real>& pair) {
    return IsAsleep(pair.places[0]) && IsAsleep(pair.places[1]);
  };
  const auto woken = std::partition(m_work.restingPairs.begin(), m_work.restingPairs.end(), sleeps);
  if (woken == m_work.restingPairs.end()) return;
  std::move(woken, m_work.restingPairs.end(), std::back_inserter(m_work.pairsBefore));
  m_work.restingPairs.erase(woken, m_work.restingPairs.end());
  std::sort(m_work.pairsBefore.begin(), m_work.pairsBefore.end(), ComesBefore<Real>);
}

// Of all overlaps, behind those there are. What is left of the pairs of before has parted.
template <class Real>
void PairSearch<Real>::AddPairs() {
  auto before = m_work.pairsBefore.begin();
  for (const auto& [a, b] : m_work.overlaps) {
    if (HasNoFaces(a) || HasNoFaces(b)) continue;
    BodyPair<Real> pair{m_table.bodies[a].id, m_table.bodies[b].id, {a, b}, {}};
    for (; before != m_work.pairsBefore.end() && ComesBefore(*before, pair); ++before) Recycle(*before);
    const bool known = before != m_work.pairsBefore.end() && !ComesBefore(pair, *before);
    for (std::size_t side = 0; side < 2; ++side) {
      pair.sides[side] = known ? std::move(before->sides[side]) : TakeSpareList();
    }
    if (known) ++before;
    for (const std::uint32_t body : pair.places) AttachSleeper(body);
    m_work.pairs.push_back(std::move(pair));
  }
  for (; before != m_work.pairsBefore.end(); ++before) Recycle(*before);
  m_work.pairsBefore.clear();
}

// Bodies and blueprints may have moved since it was awake.
template <class Real>
void PairSearch<Real>::AttachSleeper(std::uint32_t body) {
  if (!IsAsleep(body)) return;
  m_work.members[body].blueprint = &m_table.blueprints[m_table.bodies[body].blueprint];
  m_work.members[body].state = &std::get<State<Real>>(m_table.bodies[body].state);
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

// Of bodies that are new; the others have theirs.
template <class Real>
void PairSearch<Real>::ReserveSurfaces() {
  const std::size_t count = m_table.bodies.size();
  m_work.hasSurface.assign(count, 0);
  m_work.surfaceBodies.reserve(count);
  if (m_work.surfaces.size() >= count) return;
  m_work.surfaces.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    m_work.surfaces[i].Reserve(m_table.blueprints[m_table.bodies[i].blueprint].rest.size());
  }
}

// Of all that are to meet others and have not met anybody in this tick.
template <class Real>
void PairSearch<Real>::ReadSurfaces() {
  m_work.surfaceBodies.clear();
  for (const BodyPair<Real>& pair : m_work.pairs) {
    if (!AreToMeet(pair)) continue;
    for (const std::uint32_t body : pair.places) {
      if (m_work.hasSurface[body] == 0) m_work.surfaceBodies.push_back(body);
      m_work.hasSurface[body] = 1;
    }
  }
  m_threads.ForEach(m_work.surfaceBodies.size(), [this](std::size_t i) {
    const std::uint32_t body = m_work.surfaceBodies[i];
    m_work.surfaces[body].Read(FindSkin(m_work.members[body]), m_work.members[body].state->velocities);
  });
}

template <class Real>
bool PairSearch<Real>::AreToMeet(const BodyPair<Real>& pair) const {
  return !pair.met && !(IsAsleep(pair.places[0]) && IsAsleep(pair.places[1]));
}

template <class Real>
void PairSearch<Real>::MeetAll() {
  ReadSurfaces();
  m_threads.ForEach(m_work.pairs.size(), [this](std::size_t i) {
    BodyPair<Real>& pair = m_work.pairs[i];
    if (!AreToMeet(pair)) return;
    pair.met = true;
    Meet(pair);
  });
}

template <class Real>
void PairSearch<Real>::Meet(BodyPair<Real>& pair) {
  for (std::size_t side = 0; side < 2; ++side) {
    const std::uint32_t ofVertices = pair.places[side];
    const std::uint32_t ofFaces = pair.places[1 - side];
    const Member<Real>& vertices = m_work.members[ofVertices];
    const Member<Real>& faces = m_work.members[ofFaces];
    ContactSearch<Real> search{
        &m_work.surfaces[ofVertices], &m_work.surfaces[ofFaces],      m_kernel,
        faces.survey.bounds,          static_cast<Real>(kNearMargin), static_cast<Real>(m_duration)};
    search.near.speed += vertices.survey.bounds.speed;
    const Real fat = search.margin + search.near.speed * search.duration;
    search.near.low.array() -= fat;
    search.near.high.array() += fat;
    const ContactParameters<Real> both =
        Combine(vertices.blueprint->template Read<Real>().contact, faces.blueprint->template Read<Real>().contact);
    FindBodyContacts<Real>(both, MakeMeeting<Real>(vertices, faces), FindSkin(vertices), search, pair.sides[side],
                           m_work.scratch.local().search);
  }
}

template <class Real>
bool PairSearch<Real>::WakeTouched() {
  m_work.woken.clear();
  m_work.overlaps.clear();
  for (const BodyPair<Real>& pair : m_work.pairs) {
    const auto [a, b] = pair.places;
    if (IsAsleep(a) == IsAsleep(b) || !HasContacts(pair)) continue;
    const std::uint32_t sleeper = IsAsleep(a) ? a : b;
    WakeUp(m_table.bodies[sleeper]);
    m_table.roster.Wake(sleeper);
    // Of two that wake together the first finds the other, which is still among the sleepers.
    AddOverlapsWithSleepers(sleeper);
    m_work.woken.push_back(sleeper);
  }
  if (m_work.woken.empty()) return false;
  std::sort(m_work.overlaps.begin(), m_work.overlaps.end());
  TakeRestingPairs();
  AddPairs();
  std::sort(m_work.pairs.begin(), m_work.pairs.end(), ComesBefore<Real>);
  return true;
}

// keep(pair): false once it has taken from the pair what is to live on.
template <class Real>
template <class Keep>
void PairSearch<Real>::KeepPairs(const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < m_work.pairs.size(); ++i) {
    if (!keep(m_work.pairs[i])) continue;
    if (kept != i) m_work.pairs[kept] = std::move(m_work.pairs[i]);
    ++kept;
  }
  m_work.pairs.resize(kept);
}

template <class Real>
void PairSearch<Real>::DropPairsApart() {
  m_work.pairIndices.clear();
  KeepPairs([this](BodyPair<Real>& pair) {
    const bool keep = HasContacts(pair);
    if (keep) m_work.pairIndices.push_back(pair.places);
    if (!keep) Recycle(pair);
    return keep;
  });
}

template <class Real>
void PairSearch<Real>::LetPairsRest() {
  KeepPairs([this](BodyPair<Real>& pair) {
    const bool keep = !IsAsleep(pair.places[0]);
    if (!keep) m_work.restingPairs.push_back(std::move(pair));
    return keep;
  });
}

template class PairSearch<float>;
template class PairSearch<double>;

}  // namespace wobble::physics
