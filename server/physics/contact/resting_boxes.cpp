// A hash table of cells. A box lies in the cell of its middle; the cell is twice as large as the largest box, so that a
// box of that size looks into two cells along each axis. A few boxes that are much larger than most are in no cell, and
// every search compares with them.
//
// Rejected: sorted boxes as for awake bodies (broad_phase.cpp), since each change would move half of them; cells as
// large as the largest box, 27 of which have to be looked into, which took longer.
#include "server/physics/contact/resting_boxes.h"

#include <algorithm>
#include <bit>

namespace wobble::physics {
namespace {

// With more large boxes than this plus a quarter of all, the size of cells is chosen anew, which always leaves fewer.
constexpr std::size_t kFewLarge = 8;
constexpr std::size_t kLeastHeads = 64;
// With more cells than this to look into, it is cheaper to look at every box.
constexpr double kMostCells = 512;

}  // namespace

std::size_t RestingBoxes::FindHead(const Cell& cell) const {
  const auto part = [&](int axis) { return static_cast<std::uint64_t>(cell[static_cast<std::size_t>(axis)]); };
  // Odd factors with well mixed bits: the upper half of the products depends on all bits of each coordinate.
  const std::uint64_t mixed =
      part(0) * 0x9E3779B97F4A7C15U + part(1) * 0xC2B2AE3D27D4EB4FU + part(2) * 0x165667B19E3779F9U;
  return (mixed ^ mixed >> 32) & (m_heads.size() - 1);
}

bool RestingBoxes::FindRange(const Box& box, CellRange& range) const {
  const Vector3d reach = Vector3d::Constant(m_mostExtent / 2);
  const Vector3d low = ((box.low - reach) / m_cellSize).array().floor();
  const Vector3d high = ((box.high + reach) / m_cellSize).array().floor();
  const double cells = (high - low + Vector3d::Ones()).prod();
  // Written so that a NaN, of a body that is about to be reset, looks at every box.
  if (!(cells <= kMostCells) || !(low.cwiseAbs().maxCoeff() < 1e15)) return false;
  for (int axis = 0; axis < 3; ++axis) {
    range.low[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(low[axis]);
    range.high[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(high[axis]);
  }
  return true;
}

std::uint32_t& RestingBoxes::ChainOf(const Entry& entry) {
  return entry.isLarge ? m_large : m_heads[FindHead(entry.cell)];
}

void RestingBoxes::Link(std::uint32_t entry) {
  Entry& fresh = m_entries[entry];
  const Vector3d middle = (fresh.box.low + fresh.box.high) / 2;
  const double extent = FindExtent(fresh.box);
  fresh.isLarge = !(extent <= m_cellSize / 2) || !(middle.cwiseAbs().maxCoeff() < 1e15 * m_cellSize);
  if (fresh.isLarge) {
    ++m_largeCount;
  } else {
    m_mostExtent = std::max(m_mostExtent, extent);
    for (int axis = 0; axis < 3; ++axis) {
      fresh.cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(middle[axis] / m_cellSize));
    }
  }
  std::uint32_t& chain = ChainOf(fresh);
  fresh.next = chain;
  chain = entry;
}

void RestingBoxes::Unlink(std::uint32_t entry) {
  std::uint32_t* link = &ChainOf(m_entries[entry]);
  while (*link != entry) link = &m_entries[*link].next;
  *link = m_entries[entry].next;
  if (m_entries[entry].isLarge) --m_largeCount;
}

// Chooses the size of cells anew and makes room for twice as many boxes.
void RestingBoxes::Rebuild() {
  double sum = 0;
  for (const Entry& entry : m_entries) sum += FindExtent(entry.box);
  const double limit = kLargeRatio * sum / static_cast<double>(m_entries.size());
  double most = 0;
  for (const Entry& entry : m_entries) {
    const double extent = FindExtent(entry.box);
    if (extent <= limit) most = std::max(most, extent);
  }
  m_cellSize = most > 0 ? 2 * most : 1;
  m_mostExtent = 0;
  m_large = kNone;
  m_largeCount = 0;
  m_rebuildAt = 2 * m_entries.size();
  std::size_t heads = kLeastHeads;
  while (heads < 2 * m_rebuildAt) heads *= 2;
  m_heads.assign(heads, kNone);
  for (std::uint32_t entry = 0; entry < m_entries.size(); ++entry) Link(entry);
}

void RestingBoxes::Add(std::uint32_t body, const Box& box) {
  if (body >= m_entryOf.size()) m_entryOf.resize(body + std::size_t{1}, kNone);
  m_entryOf[body] = static_cast<std::uint32_t>(m_entries.size());
  m_entries.push_back({box, {}, body});
  if (m_entries.size() > m_rebuildAt) {
    Rebuild();
    return;
  }
  Link(m_entryOf[body]);
  if (m_largeCount > kFewLarge + m_entries.size() / 4) Rebuild();
}

void RestingBoxes::Reserve(std::size_t bodies) {
  m_entries.reserve(bodies);
  m_entryOf.reserve(bodies);
  m_heads.reserve(std::max<std::size_t>(kLeastHeads, std::bit_ceil(4 * bodies)));  // the most that Rebuild takes
}

void RestingBoxes::Remove(std::uint32_t body) {
  const std::uint32_t entry = m_entryOf[body];
  m_entryOf[body] = kNone;
  Unlink(entry);
  const auto last = static_cast<std::uint32_t>(m_entries.size() - 1);
  if (entry != last) {
    Unlink(last);
    m_entries[entry] = m_entries[last];
    m_entryOf[m_entries[entry].body] = entry;
    Link(entry);
  }
  m_entries.pop_back();
}

void RestingBoxes::Renumber(std::uint32_t gone) {
  if (gone < m_entryOf.size()) m_entryOf.erase(m_entryOf.begin() + gone);
  for (Entry& entry : m_entries) entry.body -= entry.body > gone ? 1 : 0;
}

}  // namespace wobble::physics
