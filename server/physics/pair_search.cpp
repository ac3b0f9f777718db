// Boxes first, by the broad phase; then vertices against faces, side by side for all pairs. A pair's contacts remember
// their history from tick to tick: the lists of pairs and of overlaps both ascend, so one walk along them finds the
// history of every pair.
#include "server/physics/pair_search.h"

#include <algorithm>
#include <iterator>

#include "server/physics/kernels/contact/contact_limits.h"
#include "server/physics/skins/skin_gap.h"

namespace wobble::physics {
namespace {

// A pair's contact list is given room for so many contacts when two bodies meet. More are rare; the list then grows.
constexpr std::size_t kLikelyContacts = 128;

// For which contacts of skins that are in one another remember on which side of an open skin their vertices were, s.
// Longer, of 1,000 random worlds twice as many triangles were in others.
constexpr double kTimeOfMemory = 0.15;

// Whether they may forget it. A closed body knows inside from outside by itself: what a sheet holds of it must not
// fall through, as of 64 balls in a bag of cloth four did.
bool MayForgetSides(const Blueprint& first, const Blueprint& second) {
  return first.full.planar || second.full.planar || (first.topology.isOpen && second.topology.isOpen);
}

// A pair without any is dropped, and with it the time until its next look for triangles that intersect: such a pair is
// looked at in every tick. To look in turn made the slowest ticks of 16 players in `goals` three times as long, and why
// was not found.
template <class Real>
bool HasContacts(const BodyPair<Real>& pair) {
  return !pair.sides[0].empty() || !pair.sides[1].empty() || !pair.edges.empty() || pair.tangle.ticks > 0;
}

template <class Real>
Skin<Real> FindSkin(const Member<Real>& member) {
  return {member.blueprint->template Read<Real>().faces, &member.blueprint->topology, member.state->positions};
}

template <class Real>
ContactParameters<Real> FindParameters(const Member<Real>& a, const Member<Real>& b) {
  return Combine(a.blueprint->template Read<Real>().contact, b.blueprint->template Read<Real>().contact);
}

// The vertices that are behind the open skin itself by more than those that it carries. radius: of the vertices, m.
template <class Real>
void ListBehind(const Topology& skin, double radius, std::span<const BodyContact<Real>> contacts,
                std::vector<std::uint16_t>& behind) {
  behind.clear();
  const auto least = static_cast<Real>(radius + kArmingDepth);
  for (const BodyContact<Real>& contact : contacts) {
    if (IsBehind(skin, contact) && contact.depth + contact.leap > least) behind.push_back(contact.vertex);
  }
}

// contacts: of the other body's vertices with faces of this one.
template <class Real>
SkinSeen<Real> SeeSkin(const Blueprint& body, std::span<const BodyContact<Real>> contacts) {
  if (body.full.faces.empty() || !body.topology.isOpen) return {};
  return {.topology = &body.topology, .faces = body.full.faces, .contacts = contacts};
}

}  // namespace

template <class Real>
void PairSearch<Real>::FindPairs() {
  ReserveSkins();
  m_lists.awake.swap(m_lists.before);
  m_lists.awake.clear();
  m_lists.overlaps.clear();
  const std::span<const std::uint32_t> awake = m_table.roster.FindAwake();
  m_lists.awakeBoxes.clear();
  for (const std::uint32_t body : awake) m_lists.awakeBoxes.push_back(m_work.boxes[body]);
  for (const auto& [a, b] : m_lists.broadPhase.FindOverlaps(m_lists.awakeBoxes)) {
    m_lists.overlaps.push_back({awake[a], awake[b]});
  }
  const std::size_t amongAwake = m_lists.overlaps.size();
  for (const std::uint32_t body : awake) AddOverlapsWithSleepers(body);
  for (const std::uint32_t place : awake) AddOverlapWithSelf(place);
  if (m_lists.overlaps.size() > amongAwake) std::sort(m_lists.overlaps.begin(), m_lists.overlaps.end());
  TakeRestingPairs();
  AddPairs();
}

template <class Real>
void PairSearch<Real>::AddOverlapsWithSleepers(std::uint32_t body) {
  m_table.roster.Sleepers().VisitOverlaps(m_work.boxes[body], [&](std::uint32_t sleeper) {
    m_lists.overlaps.push_back({std::min(body, sleeper), std::max(body, sleeper)});
  });
}

template <class Real>
SelfSearch<Real> PairSearch<Real>::MakeSelfSearch(const Member<Real>& member) const {
  return {.rest = member.blueprint->rest,
          .bounds = member.survey.bounds,
          .margin = static_cast<Real>(kNearMargin),
          .agitation = member.survey.agitation,
          .duration = static_cast<Real>(m_duration)};
}

// Counts down the body's selfRoom by what the last tick can have used of it, and lists the body with itself once what
// is left may be used up within this one.
template <class Real>
void PairSearch<Real>::AddOverlapWithSelf(std::uint32_t place) {
  Body& body = m_table.bodies[place];
  const Member<Real>& member = m_work.members[place];
  if (!(member.blueprint->selfRadius > 0)) return;
  const double agitation = double{member.survey.agitation};
  body.selfRoom -= 2 * m_duration * std::max(body.selfAgitation, agitation);
  body.selfAgitation = agitation;
  if (!(body.selfRoom > double{MakeSelfSearch(member).FindReach()})) m_lists.overlaps.push_back({place, place});
}

// Adds the pairs that woken bodies had when they fell asleep to the pairs of the last tick.
template <class Real>
void PairSearch<Real>::TakeRestingPairs() {
  if (m_lists.wakesSeen == m_table.roster.CountWakes()) return;
  m_lists.wakesSeen = m_table.roster.CountWakes();
  const auto sleeps = [this](const BodyPair<Real>& pair) {
    return IsAsleep(pair.places[0]) && IsAsleep(pair.places[1]);
  };
  const auto woken = std::partition(m_lists.resting.begin(), m_lists.resting.end(), sleeps);
  if (woken == m_lists.resting.end()) return;
  std::move(woken, m_lists.resting.end(), std::back_inserter(m_lists.before));
  m_lists.resting.erase(woken, m_lists.resting.end());
  std::sort(m_lists.before.begin(), m_lists.before.end(), ComesBefore<Real>);
}

// Appends a pair for every overlap, with the history of the pair in `before` if it is there. What is left in `before`
// has separated; unless a sheet holds a vertex back, its lists are recycled.
template <class Real>
void PairSearch<Real>::AddPairs() {
  auto before = m_lists.before.begin();
  for (const auto& [a, b] : m_lists.overlaps) {
    BodyPair<Real> pair;
    pair.first = m_table.bodies[a].id;
    pair.second = m_table.bodies[b].id;
    pair.places = {a, b};
    for (; before != m_lists.before.end() && ComesBefore(*before, pair); ++before) Separate(*before);
    const bool known = before != m_lists.before.end() && !ComesBefore(pair, *before);
    for (std::size_t side = 0; side < 2; ++side) {
      pair.sides[side] = known ? std::move(before->sides[side]) : TakeSpareList();
    }
    if (known) pair.edges = std::move(before->edges);
    if (!known && !m_lists.spareEdgeLists.empty()) {
      pair.edges = std::move(m_lists.spareEdgeLists.back());
      m_lists.spareEdgeLists.pop_back();
      pair.edges.clear();
    }
    if (known) pair.core = before->core;
    if (known) pair.gap = before->gap;
    if (known) pair.tangle = before->tangle;
    if (known) pair.pulls = std::move(before->pulls);
    if (known) ++before;
    for (const std::uint32_t body : pair.places) AttachSleeper(body);
    m_lists.awake.push_back(std::move(pair));
  }
  for (; before != m_lists.before.end(); ++before) Separate(*before);
  m_lists.before.clear();
}

// A pair whose boxes are apart.
template <class Real>
void PairSearch<Real>::Separate(BodyPair<Real>& pair) {
  for (std::size_t side = 0; side < 2; ++side) {
    pair.places[side] = FindPlace(side == 0 ? pair.first : pair.second);
  }
  const auto holdsBack = [&](std::size_t side) {
    const Topology& skin = m_table.blueprints[m_table.bodies[pair.places[1 - side]].blueprint].topology;
    return std::ranges::any_of(pair.sides[side], [&](const auto& contact) { return IsBehind(skin, contact); });
  };
  if (!holdsBack(0) && !holdsBack(1)) return Recycle(pair);
  pair.met = false;
  for (const std::uint32_t body : pair.places) AttachSleeper(body);
  m_lists.awake.push_back(std::move(pair));
}

// Bodies stand by ascending id.
template <class Real>
std::uint32_t PairSearch<Real>::FindPlace(BodyId id) const {
  const auto at = std::ranges::lower_bound(m_table.bodies, id, {}, &Body::id);
  return static_cast<std::uint32_t>(at - m_table.bodies.begin());
}

// The lists of bodies and blueprints may have been moved in memory since the body was awake.
template <class Real>
void PairSearch<Real>::AttachSleeper(std::uint32_t body) {
  if (!IsAsleep(body)) return;
  m_work.members[body].blueprint = &m_table.blueprints[m_table.bodies[body].blueprint];
  m_work.members[body].state = &std::get<State<Real>>(m_table.bodies[body].state);
}

template <class Real>
void PairSearch<Real>::Recycle(BodyPair<Real>& pair) {
  for (auto& side : pair.sides) m_lists.spareLists.push_back(std::move(side));
  if (pair.edges.capacity() > 0) m_lists.spareEdgeLists.push_back(std::move(pair.edges));
}

template <class Real>
std::vector<BodyContact<Real>> PairSearch<Real>::TakeSpareList() {
  std::vector<BodyContact<Real>> list;
  if (!m_lists.spareLists.empty()) {
    list = std::move(m_lists.spareLists.back());
    m_lists.spareLists.pop_back();
  }
  list.clear();
  list.reserve(kLikelyContacts);
  return list;
}

// Makes room for the skins of bodies that are new in the world.
template <class Real>
void PairSearch<Real>::ReserveSkins() {
  const std::size_t count = m_table.bodies.size();
  m_lists.hasSkin.assign(count, 0);
  m_lists.skinBodies.reserve(count);
  if (m_lists.skins.size() >= count) return;
  m_lists.skins.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    m_lists.skins[i].Reserve(m_table.blueprints[m_table.bodies[i].blueprint].rest.size());
  }
}

// Reads the skins of the bodies that are to meet others and have not met any in this tick.
template <class Real>
void PairSearch<Real>::ReadSkins() {
  m_lists.skinBodies.clear();
  for (const BodyPair<Real>& pair : m_lists.awake) {
    if (!AreToMeet(pair) || pair.IsSelf()) continue;
    for (const std::uint32_t body : pair.places) {
      if (m_lists.hasSkin[body] == 0) m_lists.skinBodies.push_back(body);
      m_lists.hasSkin[body] = 1;
    }
  }
  m_threads.ForEach(m_lists.skinBodies.size(), [this](std::size_t i) {
    const std::uint32_t body = m_lists.skinBodies[i];
    m_lists.skins[body].Read(FindSkin(m_work.members[body]), m_work.members[body].state->velocities);
  });
}

template <class Real>
bool PairSearch<Real>::AreToMeet(const BodyPair<Real>& pair) const {
  return !pair.met && !(IsAsleep(pair.places[0]) && IsAsleep(pair.places[1]));
}

template <class Real>
void PairSearch<Real>::MeetAll() {
  ReadSkins();
  m_threads.ForEach(m_lists.awake.size(), [this](std::size_t i) {
    BodyPair<Real>& pair = m_lists.awake[i];
    if (!AreToMeet(pair)) return;
    pair.met = true;
    Meet(pair);
  });
}

template <class Real>
void PairSearch<Real>::Meet(BodyPair<Real>& pair) {
  if (pair.IsSelf()) return MeetSelf(pair);
  const Blueprint& first = *m_work.members[pair.places[0]].blueprint;
  const Blueprint& second = *m_work.members[pair.places[1]].blueprint;
  // In their common plane the faces of planar bodies look past one another.
  const bool byFaces = !(first.full.planar && second.full.planar);
  const double fullGap = FindFullGap(first, second);
  if (byFaces) {
    FindWithGap(fullGap, m_duration, pair.gap, pair.sides, [&](std::size_t side) { MeetFaces(side, fullGap, pair); });
    LookForTangle(pair);
    if (pair.tangle.ticks * m_duration > kTimeOfMemory && MayForgetSides(first, second)) ForgetSides(pair);
  }
  if (MeetByEdges(first, second)) MeetEdges(pair);
  if (first.coreRadius > 0 && second.coreRadius > 0) MeetCores(pair);
}

// Drops the contacts that hold vertices behind an open skin back, and with them the way out that is wrong for skins
// that have crossed: the tension of their contour (skins/untangling.h) finds another.
template <class Real>
void PairSearch<Real>::ForgetSides(BodyPair<Real>& pair) {
  for (std::size_t side = 0; side < 2; ++side) {
    const Topology& skin = m_work.members[pair.places[1 - side]].blueprint->topology;
    std::erase_if(pair.sides[side], [&](const BodyContact<Real>& contact) { return IsBehind(skin, contact); });
  }
}

template <class Real>
void PairSearch<Real>::MeetCores(BodyPair<Real>& pair) {
  const Member<Real>& first = m_work.members[pair.places[0]];
  const Member<Real>& second = m_work.members[pair.places[1]];
  const Vector3d velocity = second.survey.bulk.velocity - first.survey.bulk.velocity;
  const auto describe = [](const Blueprint& body) { return CoreBody{body.totalMass, body.coreRadius}; };
  UpdateCoreContact(describe(*first.blueprint), describe(*second.blueprint), FindApart(first, second), velocity,
                    m_duration, kNearMargin, pair.core);
}

// Contacts of the vertices of the pair's body `side` with the faces of the other, if that has any. fullGap: that the
// pair's gap may widen to, m.
template <class Real>
void PairSearch<Real>::MeetFaces(std::size_t side, double fullGap, BodyPair<Real>& pair) {
  const std::uint32_t ofVertices = pair.places[side];
  const std::uint32_t ofFaces = pair.places[1 - side];
  const Member<Real>& vertices = m_work.members[ofVertices];
  const Member<Real>& faces = m_work.members[ofFaces];
  if (faces.blueprint->full.faces.empty()) return;
  ContactSearch<Real> search{.vertices = &m_lists.skins[ofVertices],
                             .skin = &m_lists.skins[ofFaces],
                             .kernel = m_kernel,
                             .near = faces.survey.bounds,
                             .margin = static_cast<Real>(kNearMargin + vertices.blueprint->rodRadius + fullGap),
                             .duration = static_cast<Real>(m_duration)};
  search.near.speed += vertices.survey.bounds.speed;
  const Real margin = search.margin + search.near.speed * search.duration;
  search.near.low.array() -= margin;
  search.near.high.array() += margin;
  FindBodyContacts<Real>(FindParameters(vertices, faces), MakeMeeting<Real>(vertices, faces, pair.gap),
                         FindSkin(vertices), search, pair.sides[side], m_work.scratch.local().search);
}

template <class Real>
void PairSearch<Real>::MeetEdges(BodyPair<Real>& pair) {
  const Member<Real>& first = m_work.members[pair.places[0]];
  const Member<Real>& second = m_work.members[pair.places[1]];
  Scratch<Real>& scratch = m_work.scratch.local();
  EdgeSearch<Real> search{.first = first.survey.bounds,
                          .second = second.survey.bounds,
                          .margin = static_cast<Real>(kNearMargin),
                          .duration = static_cast<Real>(m_duration)};
  if (MeetByRods(*first.blueprint, *second.blueprint)) {
    ListBehind<Real>(second.blueprint->topology, first.blueprint->rodRadius, pair.sides[0], scratch.firstBehind);
    ListBehind<Real>(first.blueprint->topology, second.blueprint->rodRadius, pair.sides[1], scratch.secondBehind);
    search.firstBehind = scratch.firstBehind;
    search.secondBehind = scratch.secondBehind;
    search.skinOfFirst = SeeSkin<Real>(*first.blueprint, pair.sides[1]);
    search.skinOfSecond = SeeSkin<Real>(*second.blueprint, pair.sides[0]);
  }
  FindEdgeContacts<Real>(FindParameters(first, second), MakeEdgeMeeting<Real>(first, second, pair.gap), search,
                         pair.edges, scratch.edgeSearch);
}

template <class Real>
void PairSearch<Real>::MeetSelf(BodyPair<Real>& pair) {
  const std::uint32_t place = pair.places[0];
  const Member<Real>& member = m_work.members[place];
  const Real room = FindSelfContacts<Real>(FindParameters(member, member), MakeEdgeMeeting<Real>(member, member, 0),
                                           MakeSelfSearch(member), pair.edges, m_work.scratch.local().selfSearch);
  m_table.bodies[place].selfRoom = std::max(0.0, double{room});
  // On its way back a body that is inside out or folded goes through itself.
  if (member.load.recovery.Act()) {
    pair.edges.clear();
    pair.tangle = {};
    pair.pulls = {};
  } else if (!member.blueprint->full.planar) {
    LookForTangle(pair);
  }
  const bool isClosed = member.blueprint->restVolume > 0;
  if (pair.edges.empty() || !isClosed) return;
  const auto& body = member.blueprint->template Read<Real>();
  if (!(ComputeEnclosed<Real>(body, member.state->positions) > Real(0))) pair.edges.clear();
}

template <class Real>
void PairSearch<Real>::LookForTangle(BodyPair<Real>& pair) {
  const Member<Real>& first = m_work.members[pair.places[0]];
  const Member<Real>& second = m_work.members[pair.places[1]];
  if (first.blueprint->full.faces.empty() || second.blueprint->full.faces.empty()) return;
  const auto see = [](const Member<Real>& member) {
    return TangledSkin<Real>{.blueprint = member.blueprint,
                             .x = member.state->positions,
                             .bounds = member.survey.bounds,
                             .velocity = member.survey.bulk.velocity,
                             .agitation = double{member.survey.agitation}};
  };
  Untangle<Real>(see(first), see(second), second.state->origin - first.state->origin, m_duration,
                 m_work.scratch.local().untangling, pair.tangle, pair.pulls);
}

template <class Real>
void PairSearch<Real>::PullApart() {
  for (const BodyPair<Real>& pair : m_lists.awake) {
    for (std::size_t side = 0; side < 2; ++side) {
      const std::vector<VertexForce<Real>>& pulls = pair.pulls[side];
      if (pulls.empty()) continue;
      Member<Real>& member = m_work.members[pair.places[side]];
      member.pushes.insert(member.pushes.end(), pulls.begin(), pulls.end());
      member.load.pushes = member.pushes;
    }
  }
}

template <class Real>
bool PairSearch<Real>::WakeTouched() {
  m_lists.woken.clear();
  m_lists.overlaps.clear();
  for (const BodyPair<Real>& pair : m_lists.awake) {
    const auto [a, b] = pair.places;
    if (IsAsleep(a) == IsAsleep(b) || !HasContacts(pair)) continue;
    const std::uint32_t sleeper = IsAsleep(a) ? a : b;
    WakeUp(m_table.bodies[sleeper]);
    m_table.roster.Wake(sleeper);
    // Of two bodies that wake together the first one finds the other, which is still among the sleeping ones.
    AddOverlapsWithSleepers(sleeper);
    AddOverlapWithSelf(sleeper);
    m_lists.woken.push_back(sleeper);
  }
  if (m_lists.woken.empty()) return false;
  std::sort(m_lists.overlaps.begin(), m_lists.overlaps.end());
  TakeRestingPairs();
  AddPairs();
  std::sort(m_lists.awake.begin(), m_lists.awake.end(), ComesBefore<Real>);
  return true;
}

// Erases the pairs for which keep(pair) returns false. `keep` may move a pair's lists elsewhere before it does so.
template <class Real>
template <class Keep>
void PairSearch<Real>::KeepPairs(const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < m_lists.awake.size(); ++i) {
    if (!keep(m_lists.awake[i])) continue;
    if (kept != i) m_lists.awake[kept] = std::move(m_lists.awake[i]);
    ++kept;
  }
  m_lists.awake.resize(kept);
}

template <class Real>
void PairSearch<Real>::DropPairsApart() {
  m_lists.places.clear();
  KeepPairs([this](BodyPair<Real>& pair) {
    const bool keep = HasContacts(pair);
    if (keep) m_lists.places.push_back(pair.places);
    if (!keep) Recycle(pair);
    return keep;
  });
}

template <class Real>
void PairSearch<Real>::LetPairsRest() {
  KeepPairs([this](BodyPair<Real>& pair) {
    const bool keep = !IsAsleep(pair.places[0]);
    if (!keep) m_lists.resting.push_back(std::move(pair));
    return keep;
  });
}

template class PairSearch<float>;
template class PairSearch<double>;

}  // namespace wobble::physics
