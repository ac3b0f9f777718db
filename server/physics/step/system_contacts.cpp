// Contacts lie in blocks of sixteen regardless of their pair. Each stage gathers the points that a block's contacts
// depend on from the members' arrays into rows on the stack, four points a contact, and hands them to the kernel. The
// kernel marks contacts whose vertex has left its face as `left`, about one in a hundred; plain code computes those one
// by one.
//
// The contact pairs' lists are kept up to date after every substep, so that code that reads contacts between ticks,
// between tries or for energies sees them as the plain code would have left them.
#include "server/physics/step/system_contacts.h"

#include <array>
#include <bit>

#include "server/physics/kernels/contact/contact_limits.h"
#include "server/physics/lanes/vertex_rows.h"
#include "server/physics/skins/body_contact_update.h"

namespace wobble::physics {
namespace {

// Blocks that a thread gets at once: one alone takes less than a microsecond, too little to hand over.
constexpr std::size_t kBlocksAtOnce = 8;

template <class Real>
void Gather(const VectorView<Real>& values, std::uint16_t index, std::size_t lane, ContactRow<Real> (&rows)[3]) {
  const Vector3<Real>& value = values[index];
  rows[0][lane] = value[0];
  rows[1][lane] = value[1];
  rows[2][lane] = value[2];
}

// Points that are spread at once.
constexpr std::size_t kAtOnce = 4;
template <class Real>
using PointsAtOnce = std::array<const MovingPoint<Real>*, kAtOnce>;

// Writes positions and velocities of contacts from `lane` on to their rows, by transposition in registers.
inline __attribute__((always_inline)) void Spread(const PointsAtOnce<float>& from, std::size_t lane,
                                                  ContactRow<float> (&x)[3], ContactRow<float> (&v)[3]) {
  RowsOf<float>::Lanes rows[kAtOnce];
  for (std::size_t i = 0; i < kAtOnce; ++i) rows[i] = LoadLanes(from[i]->x.data());
  Transpose(rows);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    StoreRow(FindRow(rows[axis], false), x[axis] + lane);
    StoreRow(FindRow(rows[axis], true), v[axis] + lane);
  }
}
inline __attribute__((always_inline)) void Spread(const PointsAtOnce<double>& from, std::size_t lane,
                                                  ContactRow<double> (&x)[3], ContactRow<double> (&v)[3]) {
  RowsOf<double>::Lanes rows[kAtOnce];
  for (std::size_t i = 0; i < kAtOnce; ++i) rows[i] = LoadLanes(from[i]->x.data());
  Transpose(rows);
  for (std::size_t axis = 0; axis < 3; ++axis) StoreLanes(rows[axis], x[axis] + lane);
  for (std::size_t i = 0; i < kAtOnce; ++i) rows[i] = LoadLanes(from[i]->v.data());
  Transpose(rows);
  for (std::size_t axis = 0; axis < 3; ++axis) StoreLanes(rows[axis], v[axis] + lane);
}

}  // namespace

template <class Real>
void SystemContacts<Real>::Reserve(std::size_t contacts, std::size_t bodies) {
  const std::size_t blocks = contacts / kContactsInBlock + 1;
  m_sides.reserve(16 * bodies);  // a body seldom has more than eight neighbours
  m_sidesOf.reserve(32 * bodies);
  m_sidesBegin.reserve(bodies + 1);
  m_entries.reserve(contacts);
  m_leftTo.reserve(contacts);
  m_blocks.reserve(blocks);
  m_forces.reserve(blocks);
}

template <class Real>
void SystemContacts<Real>::Build(std::span<const ContactPair<Real>> contactPairs,
                                 std::span<Member<Real>* const> members, const BodyContactKernel<Real>& kernel) {
  m_kernel = kernel;
  m_sides.clear();
  m_entries.clear();
  for (const ContactPair<Real>& contactPair : contactPairs) {
    for (std::size_t s = 0; s < 2; ++s) {
      const std::uint32_t ofVertices = contactPair.members[s];
      const std::uint32_t ofFaces = contactPair.members[1 - s];
      m_sides.push_back(
          {.ofVertices = ofVertices,
           .ofFaces = ofFaces,
           .contacts = contactPair.sides[s],
           .begin = m_entries.size(),
           .parameters = contactPair.parameters,
           .meeting = MakeMeeting<Real>(*members[ofVertices], {}, {}, *members[ofFaces], {}, {}, contactPair.gap)});
      m_entries.resize(m_entries.size() + contactPair.sides[s]->size(),
                       {.side = static_cast<std::uint32_t>(m_sides.size() - 1)});
    }
  }
  m_leftTo.resize(m_entries.size());
  m_forces.resize((m_entries.size() + kContactsInBlock - 1) / kContactsInBlock);
  m_blocks.assign(m_forces.size(), {});
  for (std::size_t contact = 0; contact < m_entries.size(); ++contact) WriteConstants(contact);
  ListSidesOfMembers(members.size());
  ReadLists();
}

template <class Real>
void SystemContacts<Real>::ListSidesOfMembers(std::size_t members) {
  m_sidesBegin.assign(members + 1, 0);
  for (const Side& side : m_sides) {
    ++m_sidesBegin[side.ofVertices + 1U];
    ++m_sidesBegin[side.ofFaces + 1U];
  }
  for (std::size_t i = 0; i < members; ++i) m_sidesBegin[i + 1] += m_sidesBegin[i];
  m_sidesOf.resize(2 * m_sides.size());
  for (std::size_t i = m_sides.size(); i-- > 0;) {
    m_sidesOf[--m_sidesBegin[m_sides[i].ofVertices + 1U]] = static_cast<std::uint32_t>(i);
    m_sidesOf[--m_sidesBegin[m_sides[i].ofFaces + 1U]] = static_cast<std::uint32_t>(i);
  }
  // The loop has counted each member's end down to its begin, one place too far right: shift them left.
  m_sidesBegin.erase(m_sidesBegin.begin());
  m_sidesBegin.push_back(m_sidesOf.size());
}

template <class Real>
void SystemContacts<Real>::WriteConstants(std::size_t contact) {
  BodyContactBlock<Real>& block = m_blocks[contact / kContactsInBlock];
  const std::size_t lane = contact % kContactsInBlock;
  const Side& side = m_sides[m_entries[contact].side];
  const BodyContact<Real>& known = ContactOf(contact);
  const bool isOpen = side.meeting.skin.topology->isOpen;
  WriteRows(side.meeting.shift, lane, block.shift);
  block.stiffness[lane] = side.parameters.stiffness;
  block.fadeDepth[lane] = side.parameters.fadeDepth;
  block.perFadeDepth[lane] = Real(1) / side.parameters.fadeDepth;
  block.damping[lane] = side.parameters.damping;
  block.stickStiffness[lane] = side.parameters.stickStiffness;
  block.stickDamping[lane] = side.parameters.stickDamping;
  block.friction[lane] = side.parameters.friction;
  block.share[lane] = side.meeting.shares[known.vertex];
  block.offset[lane] = side.meeting.skin.offset;
  block.freeDepth[lane] = isOpen ? static_cast<Real>(kArmingDepth) : FindFreeDepth(side.parameters);
  block.open[lane] = isOpen ? Real(1) : Real(0);
  WriteRows(known.outward, lane, block.outward);
}

template <class Real>
void SystemContacts<Real>::ReadLists() {
  for (std::size_t contact = 0; contact < m_entries.size(); ++contact) ReadList(contact);
}

template <class Real>
void SystemContacts<Real>::ReadList(std::size_t contact) {
  BodyContactBlock<Real>& block = m_blocks[contact / kContactsInBlock];
  const std::size_t lane = contact % kContactsInBlock;
  const BodyContact<Real>& known = ContactOf(contact);
  Entry& entry = m_entries[contact];
  const Skin<Real>& skin = m_sides[entry.side].meeting.skin;
  entry.vertex = known.vertex;
  entry.corners = skin.faces[known.face];
  entry.across = skin.topology->across[known.face];
  block.side[lane] = known.side == SkinSide::kBack ? Real(-1) : Real(1);
  block.maxDepth[lane] = MayPush(known.phase) ? known.maxDepth : Real(-1);
  block.depth[lane] = known.depth;
  block.leap[lane] = known.leap;
  block.touching[lane] = known.phase == ContactPhase::kTouching ? Real(1) : Real(0);
  WriteRows(known.foot, lane, block.foot);
  WriteRows(known.slip, lane, block.slip);
}

template <class Real>
void SystemContacts<Real>::WriteList(std::size_t contact, bool armed, bool touching) {
  BodyContactBlock<Real>& block = m_blocks[contact / kContactsInBlock];
  const std::size_t lane = contact % kContactsInBlock;
  BodyContact<Real>& known = ContactOf(contact);
  if (!armed) {
    known.phase = ContactPhase::kWaiting;
  } else {
    known.phase = touching ? ContactPhase::kTouching : ContactPhase::kArmed;
  }
  known.maxDepth = block.maxDepth[lane];
  known.depth = touching ? block.depth[lane] : std::min(block.depth[lane], Real(0));
  known.leap = block.leap[lane];
  known.foot = ReadRows(block.foot, lane);
  known.slip = ReadRows(block.slip, lane);
  block.maxDepth[lane] = armed ? known.maxDepth : Real(-1);
  block.depth[lane] = known.depth;
  block.touching[lane] = touching ? Real(1) : Real(0);
}

template <class Real>
template <class Visit>
void SystemContacts<Real>::ForEachBlock(Threads* threads, const Visit& visit) const {
  const std::size_t count = m_blocks.size();
  const auto visitRange = [&](std::size_t range) {
    const std::size_t end = std::min(count, (range + 1) * kBlocksAtOnce);
    for (std::size_t block = range * kBlocksAtOnce; block < end; ++block) visit(block);
  };
  const std::size_t ranges = (count + kBlocksAtOnce - 1) / kBlocksAtOnce;
  if (threads != nullptr) {
    threads->ForEach(ranges, visitRange);
  } else {
    for (std::size_t range = 0; range < ranges; ++range) visitRange(range);
  }
}

template <class Real>
Meeting<Real> SystemContacts<Real>::Meet(const Side& side, std::span<const Motion<Real>> motions) const {
  Meeting<Real> meeting = side.meeting;
  meeting.x = motions[side.ofVertices].x;
  meeting.v = motions[side.ofVertices].v;
  meeting.skin.x = motions[side.ofFaces].x;
  meeting.skinV = motions[side.ofFaces].v;
  return meeting;
}

template <class Real>
void SystemContacts<Real>::GatherPoints(std::size_t block, std::span<const Motion<Real>> motions,
                                        BodyContactPoints<Real>& points) const {
  if (motions[m_sides[m_entries[block * kContactsInBlock].side].ofFaces].points != nullptr) {
    SpreadPoints(block, motions, points);
    return;
  }
  const std::size_t count = CountInBlock(block);
  if (count < kContactsInBlock) points = {};
  for (std::size_t lane = 0; lane < count; ++lane) {
    const Entry& entry = m_entries[block * kContactsInBlock + lane];
    const Side& side = m_sides[entry.side];
    const Motion<Real>& ofVertices = motions[side.ofVertices];
    const Motion<Real>& ofFaces = motions[side.ofFaces];
    Gather(ofVertices.x, entry.vertex, lane, points.x[0]);
    Gather(ofVertices.v, entry.vertex, lane, points.v[0]);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Gather(ofFaces.x, entry.corners[corner], lane, points.x[1 + corner]);
      Gather(ofFaces.v, entry.corners[corner], lane, points.v[1 + corner]);
    }
  }
}

template <class Real>
void SystemContacts<Real>::GatherAcross(std::size_t block, std::span<const Motion<Real>> motions,
                                        BodyContactPoints<Real>& points) const {
  if (motions[m_sides[m_entries[block * kContactsInBlock].side].ofFaces].points != nullptr) {
    SpreadAcross(block, motions, points);
    return;
  }
  const std::size_t count = CountInBlock(block);
  for (std::size_t lane = 0; lane < count; ++lane) {
    const Entry& entry = m_entries[block * kContactsInBlock + lane];
    const Motion<Real>& ofFaces = motions[m_sides[entry.side].ofFaces];
    for (std::size_t i = 0; i < 3; ++i) Gather(ofFaces.x, entry.across[i], lane, points.across[i]);
  }
}

// Lanes without a contact repeat the block's last one: nothing reads what comes of them, but the numbers are finite.
template <class Real>
void SystemContacts<Real>::SpreadPoints(std::size_t block, std::span<const Motion<Real>> motions,
                                        BodyContactPoints<Real>& points) const {
  const std::size_t first = block * kContactsInBlock;
  const std::size_t last = CountInBlock(block) - 1;
  for (std::size_t lane = 0; lane < kContactsInBlock; lane += kAtOnce) {
    std::array<PointsAtOnce<Real>, 4> four;  // of each contact: its vertex and the corners of its face
    for (std::size_t i = 0; i < kAtOnce; ++i) {
      const Entry& entry = m_entries[first + std::min(lane + i, last)];
      const Side& side = m_sides[entry.side];
      const MovingPoint<Real>* const ofFaces = motions[side.ofFaces].points;
      four[0][i] = motions[side.ofVertices].points + entry.vertex;
      for (std::size_t corner = 0; corner < 3; ++corner) four[1 + corner][i] = ofFaces + entry.corners[corner];
    }
    for (std::size_t k = 0; k < four.size(); ++k) Spread(four[k], lane, points.x[k], points.v[k]);
  }
}

template <class Real>
void SystemContacts<Real>::SpreadAcross(std::size_t block, std::span<const Motion<Real>> motions,
                                        BodyContactPoints<Real>& points) const {
  const std::size_t first = block * kContactsInBlock;
  const std::size_t last = CountInBlock(block) - 1;
  for (std::size_t lane = 0; lane < kContactsInBlock; lane += kAtOnce) {
    std::array<PointsAtOnce<Real>, 3> three;
    for (std::size_t i = 0; i < kAtOnce; ++i) {
      const Entry& entry = m_entries[first + std::min(lane + i, last)];
      const MovingPoint<Real>* const ofFaces = motions[m_sides[entry.side].ofFaces].points;
      for (std::size_t k = 0; k < three.size(); ++k) three[k][i] = ofFaces + entry.across[k];
    }
    ContactRow<Real> unused[3];
    for (std::size_t k = 0; k < three.size(); ++k) Spread(three[k], lane, points.across[k], unused);
  }
}

template <class Real>
void SystemContacts<Real>::ComputeForces(std::span<const Motion<Real>> motions, Threads* threads) {
  ForEachBlock(threads, [&](std::size_t block) { ComputeForcesOf(block, motions); });
}

template <class Real>
void SystemContacts<Real>::ComputeForcesOf(std::size_t block, std::span<const Motion<Real>> motions) {
  BodyContactPoints<Real> points;
  GatherPoints(block, motions, points);
  BodyContactForces<Real>& forces = m_forces[block];
  m_kernel.computeForces(m_blocks[block], points, forces);
  const std::uint32_t inUse = (1U << CountInBlock(block)) - 1;
  for (std::uint32_t left = forces.left & inUse; left != 0; left &= left - 1) {
    ComputeForceOfLeft(block * kContactsInBlock + static_cast<std::size_t>(std::countr_zero(left)), motions);
  }
}

template <class Real>
void SystemContacts<Real>::ComputeForceOfLeft(std::size_t contact, std::span<const Motion<Real>> motions) {
  const Side& side = m_sides[m_entries[contact].side];
  ContactForce<Real> force;
  ComputeBodyContacts<Real>(side.parameters, Meet(side, motions), {&ContactOf(contact), 1}, {&force, 1});
  if (!force.acts) return;
  BodyContactForces<Real>& forces = m_forces[contact / kContactsInBlock];
  const std::size_t lane = contact % kContactsInBlock;
  forces.acts |= 1U << lane;
  m_leftTo[contact] = force.corners;
  WriteRows(force.onVertex, lane, forces.onVertex);
  for (std::size_t i = 0; i < 3; ++i) WriteRows(force.onCorners[i], lane, forces.onCorners[i]);
}

template <class Real>
void SystemContacts<Real>::Update(std::span<const Motion<Real>> motions, Real h, Threads* threads) {
  ForEachBlock(threads, [&](std::size_t block) { Update(block, motions, h); });
}

template <class Real>
void SystemContacts<Real>::Update(std::size_t block, std::span<const Motion<Real>> motions, Real h) {
  BodyContactPoints<Real> points;
  GatherPoints(block, motions, points);
  GatherAcross(block, motions, points);
  const BodyContactChange change = m_kernel.update(points, h, m_blocks[block]);
  for (std::size_t lane = 0; lane < CountInBlock(block); ++lane) {
    const std::size_t contact = block * kContactsInBlock + lane;
    if ((change.left >> lane & 1U) == 0) {
      WriteList(contact, (change.armed >> lane & 1U) != 0, (change.touching >> lane & 1U) != 0);
      continue;
    }
    const Side& side = m_sides[m_entries[contact].side];
    UpdateBodyContacts<Real>(side.parameters, Meet(side, motions), h, {&ContactOf(contact), 1});
    ReadList(contact);
  }
}

template class SystemContacts<float>;
template class SystemContacts<double>;

}  // namespace wobble::physics
