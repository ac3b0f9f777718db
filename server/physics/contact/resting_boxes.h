// Boxes of sleeping bodies: added and removed one at a time, and read only where an awake body comes near, so that a
// sleeping body costs nothing in a tick.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "server/physics/contact/broad_phase.h"

namespace wobble::physics {

class RestingBoxes {
 public:
  // Makes room for bodies whose numbers are below `bodies`, so that later calls allocate nothing.
  void Reserve(std::size_t bodies);
  // body: its place in the world; it must not be in yet. Amortised constant time.
  void Add(std::uint32_t body, const Box& box);
  // body: must be in.
  void Remove(std::uint32_t body);
  // Body number `gone`, which must not be in, has left the world: every higher number becomes one less. Linear time.
  void Renumber(std::uint32_t gone);

  [[nodiscard]] std::size_t Count() const { return m_entries.size(); }

  // Calls visit(body) for each body whose box overlaps or touches this one, in no order.
  template <class Visit>
  void VisitOverlaps(const Box& box, const Visit& visit) const {
    if (m_entries.empty()) return;
    const auto check = [&](std::uint32_t entry) {
      if (Overlap(m_entries[entry].box, box)) visit(m_entries[entry].body);
    };
    CellRange range;
    if (!FindRange(box, range)) {
      for (std::uint32_t entry = 0; entry < m_entries.size(); ++entry) check(entry);
      return;
    }
    for (std::int64_t z = range.low[2]; z <= range.high[2]; ++z) {
      for (std::int64_t y = range.low[1]; y <= range.high[1]; ++y) {
        for (std::int64_t x = range.low[0]; x <= range.high[0]; ++x) {
          const Cell cell{x, y, z};
          for (std::uint32_t i = m_heads[FindHead(cell)]; i != kNone; i = m_entries[i].next) {
            if (m_entries[i].cell == cell) check(i);
          }
        }
      }
    }
    for (std::uint32_t i = m_large; i != kNone; i = m_entries[i].next) check(i);
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellRange {
    Cell low, high;
  };
  struct Entry {
    Box box;
    Cell cell{};
    std::uint32_t body = 0;
    std::uint32_t next = kNone;  // in the same chain
    bool isLarge = false;
  };
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  [[nodiscard]] std::size_t FindHead(const Cell& cell) const;
  // The cells in which the middle of an overlapping box may lie. False: too many to go through.
  [[nodiscard]] bool FindRange(const Box& box, CellRange& range) const;
  [[nodiscard]] std::uint32_t& ChainOf(const Entry& entry);
  void Link(std::uint32_t entry);
  void Unlink(std::uint32_t entry);
  void Rebuild();

  std::vector<Entry> m_entries;
  std::vector<std::uint32_t> m_entryOf;  // by body
  std::vector<std::uint32_t> m_heads;    // heads of the chains of cells, by the cell's hash; a power of two of them
  std::uint32_t m_large = kNone;         // head of the chain of boxes that are too large for a cell
  std::size_t m_largeCount = 0;
  double m_cellSize = 1;    // m
  double m_mostExtent = 0;  // largest extent of a box in a cell, at most half the cell's size, m
  std::size_t m_rebuildAt = 0;
};

}  // namespace wobble::physics
