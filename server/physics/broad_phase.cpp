// A uniform grid without a table: boxes are sorted by the cell that their middle lies in. The cell is as large as the
// largest box, so boxes that overlap have their middles in the same or in adjoining cells, and one look at half of the
// 26 neighbours finds each pair once. Cells of a row follow one another in the order, so a row of three is one search.
//
// Few boxes that are much larger than most would make all cells too large: they are compared with every other instead.
// Sweeping along one axis was found to grow with the square of bodies side by side (physics.md: 11 ms for 10,000).
#include "server/physics/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wobble::physics {
namespace {

// Times the mean box, from which on a box is one of the large.
constexpr double kLargeRatio = 4;
constexpr std::int64_t kCellsEachWay = std::int64_t{1} << 20;  // 21 bits of the key an axis

struct Placed {
  std::uint64_t cell;
  std::uint32_t box;
};

double FindExtent(const Box& box) { return (box.high - box.low).maxCoeff(); }

bool Overlap(const Box& a, const Box& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

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
    return static_cast<std::int64_t>(std::floor(std::clamp(value, -kLimit, kLimit - 1)));
  };
  return {whole(middle.x()), whole(middle.y()), whole(middle.z())};
}

void AddPair(std::span<const Box> boxes, std::uint32_t a, std::uint32_t b, std::vector<IndexPair>& pairs) {
  if (Overlap(boxes[a], boxes[b])) pairs.push_back({std::min(a, b), std::max(a, b)});
}

// Every placed box after `first` whose cell is one of the three from (x - 1, y, z) on.
void AddRow(std::span<const Box> boxes, std::span<const Placed> placed, std::size_t first, const Cell& middle,
            std::vector<IndexPair>& pairs) {
  const std::uint64_t from = PackCell(middle.x - 1, middle.y, middle.z);
  const std::uint64_t to = PackCell(middle.x + 1, middle.y, middle.z);
  auto other = std::lower_bound(placed.begin() + static_cast<std::ptrdiff_t>(first) + 1, placed.end(), from,
                                [](const Placed& each, std::uint64_t cell) { return each.cell < cell; });
  for (; other != placed.end() && other->cell <= to; ++other) AddPair(boxes, placed[first].box, other->box, pairs);
}

}  // namespace

void FindOverlaps(std::span<const Box> boxes, std::vector<IndexPair>& pairs) {
  pairs.clear();
  if (boxes.size() < 2) return;
  double sum = 0;
  for (const Box& box : boxes) sum += FindExtent(box);
  const double limit = kLargeRatio * sum / static_cast<double>(boxes.size());

  double size = 0;
  std::vector<std::uint32_t> large;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const double extent = FindExtent(boxes[i]);
    if (extent > limit) {
      large.push_back(i);
    } else {
      size = std::max(size, extent);
    }
  }
  std::vector<Placed> placed;
  placed.reserve(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (FindExtent(boxes[i]) > limit) continue;
    const Cell cell = FindCell(boxes[i], size);
    placed.push_back({PackCell(cell.x, cell.y, cell.z), i});
  }
  std::sort(placed.begin(), placed.end(),
            [](const Placed& a, const Placed& b) { return a.cell != b.cell ? a.cell < b.cell : a.box < b.box; });

  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Cell at = FindCell(boxes[placed[i].box], size);
    AddRow(boxes, placed, i, at, pairs);
    AddRow(boxes, placed, i, {at.x, at.y + 1, at.z}, pairs);
    for (int y = -1; y <= 1; ++y) AddRow(boxes, placed, i, {at.x, at.y + y, at.z + 1}, pairs);
  }
  for (std::size_t i = 0; i < large.size(); ++i) {
    for (const Placed& other : placed) AddPair(boxes, large[i], other.box, pairs);
    for (std::size_t j = i + 1; j < large.size(); ++j) AddPair(boxes, large[i], large[j], pairs);
  }
  std::sort(pairs.begin(), pairs.end());
}

void FindGroups(std::size_t count, std::span<const IndexPair> pairs, Groups& groups) {
  std::vector<std::uint32_t> parent(count);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto findRoot = [&parent](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [a, b] : pairs) {
    const std::uint32_t one = findRoot(a);
    const std::uint32_t other = findRoot(b);
    parent[std::max(one, other)] = std::min(one, other);  // so the least member is the root
  }
  groups.begins.clear();
  groups.members.resize(count);
  std::iota(groups.members.begin(), groups.members.end(), 0U);
  for (std::uint32_t i = 0; i < count; ++i) parent[i] = findRoot(i);
  std::stable_sort(groups.members.begin(), groups.members.end(),
                   [&parent](std::uint32_t a, std::uint32_t b) { return parent[a] < parent[b]; });
  for (std::uint32_t i = 0; i < count; ++i) {
    if (i == 0 || parent[groups.members[i]] != parent[groups.members[i - 1]]) groups.begins.push_back(i);
  }
  groups.begins.push_back(static_cast<std::uint32_t>(count));
}

}  // namespace wobble::physics
