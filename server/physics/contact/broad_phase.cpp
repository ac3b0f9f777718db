// A uniform grid without a table: boxes are sorted by the cell that their middle lies in. The cell is as large as the
// largest box, so boxes that overlap have their middles in the same or in adjoining cells, and a look at half of the 26
// neighbours finds each pair once. Cells of a row are adjacent in the order, so a row of three cells is one search.
//
// A few boxes that are much larger than most would make all cells too large; they are compared with every other box
// instead. Rejected: sweeping along one axis, whose time grows with the square of bodies side by side (11 ms for
// 10,000).
#include "server/physics/contact/broad_phase.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

constexpr std::int64_t kCellsEachWay = std::int64_t{1} << 20;  // 21 bits of the key an axis

std::uint64_t PackCell(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto part = [](std::int64_t i) {
    return static_cast<std::uint64_t>(std::clamp(i, -kCellsEachWay, kCellsEachWay - 1) + kCellsEachWay);
  };
  return part(z) << 42 | part(y) << 21 | part(x);
}

struct Cell {
  std::int64_t x, y, z;
};

Cell FindCell(const Box& box, double size) {
  const Vector3d middle = (box.low + box.high) / (2 * size);
  const auto whole = [](double value) {
    constexpr auto kLimit = static_cast<double>(kCellsEachWay);
    // Written so that a NaN, of a body that is about to be reset, has a cell as well.
    return static_cast<std::int64_t>(std::floor(value > -kLimit ? std::min(value, kLimit - 1) : -kLimit));
  };
  return {whole(middle.x()), whole(middle.y()), whole(middle.z())};
}

}  // namespace

void BroadPhase::AddPair(std::uint32_t a, std::uint32_t b) {
  if (Overlap(m_boxes[a], m_boxes[b])) m_pairs.push_back({std::min(a, b), std::max(a, b)});
}

// Pairs the box of `first` with every placed box after it whose cell is one of the three from (x - 1, y, z) on.
void BroadPhase::AddRow(std::size_t first, std::int64_t x, std::int64_t y, std::int64_t z) {
  const std::uint64_t from = PackCell(x - 1, y, z);
  const std::uint64_t to = PackCell(x + 1, y, z);
  auto other = std::lower_bound(m_placed.begin() + static_cast<std::ptrdiff_t>(first) + 1, m_placed.end(), from,
                                [](const Placed& each, std::uint64_t cell) { return each.cell < cell; });
  for (; other != m_placed.end() && other->cell <= to; ++other) AddPair(m_placed[first].box, other->box);
}

std::span<const IndexPair> BroadPhase::FindOverlaps(std::span<const Box> boxes) {
  m_boxes = boxes;
  m_pairs.clear();
  m_placed.clear();
  m_large.clear();
  double sum = 0;
  for (const Box& box : boxes) sum += FindExtent(box);
  const double limit = kLargeRatio * sum / static_cast<double>(boxes.size());

  double size = 0;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const double extent = FindExtent(boxes[i]);
    if (extent > limit) {
      m_large.push_back(i);
    } else {
      m_placed.push_back({0, i});
      size = std::max(size, extent);
    }
  }
  for (Placed& placed : m_placed) {
    const Cell cell = FindCell(boxes[placed.box], size);
    placed.cell = PackCell(cell.x, cell.y, cell.z);
  }
  std::sort(m_placed.begin(), m_placed.end(),
            [](const Placed& a, const Placed& b) { return a.cell != b.cell ? a.cell < b.cell : a.box < b.box; });

  for (std::size_t i = 0; i < m_placed.size(); ++i) {
    const Cell at = FindCell(boxes[m_placed[i].box], size);
    AddRow(i, at.x, at.y, at.z);
    AddRow(i, at.x, at.y + 1, at.z);
    for (int y = -1; y <= 1; ++y) AddRow(i, at.x, at.y + y, at.z + 1);
  }
  for (std::size_t i = 0; i < m_large.size(); ++i) {
    for (const Placed& other : m_placed) AddPair(m_large[i], other.box);
    for (std::size_t j = i + 1; j < m_large.size(); ++j) AddPair(m_large[i], m_large[j]);
  }
  std::sort(m_pairs.begin(), m_pairs.end());
  return m_pairs;
}

void Islands::Find(std::span<const std::uint32_t> bodies, std::span<const IndexPair> pairs) {
  std::vector<std::uint32_t>& parent = m_islandOf;
  if (!bodies.empty()) parent.resize(std::max(parent.size(), bodies.back() + std::size_t{1}));
  for (const std::uint32_t i : bodies) parent[i] = i;
  const auto findRoot = [&parent](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [a, b] : pairs) {
    const std::uint32_t one = findRoot(a);
    const std::uint32_t other = findRoot(b);
    parent[std::max(one, other)] = std::min(one, other);  // so the least member is the root
  }
  for (const std::uint32_t i : bodies) parent[i] = findRoot(i);
  // A root comes before its members, so its place in parent can take the island's number on the way.
  std::uint32_t islands = 0;
  for (const std::uint32_t i : bodies) m_islandOf[i] = parent[i] == i ? islands++ : m_islandOf[parent[i]];

  m_begins.assign(islands + 1U, 0);
  for (const std::uint32_t i : bodies) ++m_begins[m_islandOf[i] + 1U];
  for (std::uint32_t island = 0; island < islands; ++island) m_begins[island + 1U] += m_begins[island];
  m_members.resize(bodies.size());
  for (std::size_t i = bodies.size(); i-- > 0;) m_members[--m_begins[m_islandOf[bodies[i]] + 1U]] = bodies[i];
  // Filling has counted each island's end, m_begins[i + 1], down to its begin: drop the first entry and append the end.
  m_begins.erase(m_begins.begin());
  m_begins.push_back(static_cast<std::uint32_t>(bodies.size()));
}

}  // namespace wobble::physics
