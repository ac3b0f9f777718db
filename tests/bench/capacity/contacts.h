// Counts contact between players: touching neighbours per body, and the sizes of islands of touching bodies.
#pragma once

#include <cstddef>
#include <vector>

#include "server/physics/world.h"

namespace wobble::bench {

class Contacts {
 public:
  // Counts the contacts of the world as it is; call it between two ticks.
  void Look(const physics::World& world);

  // Means over all looks. An island is a set of bodies connected by contact.
  [[nodiscard]] double Touching() const;             // bodies that touch another one
  [[nodiscard]] double TouchedByEach() const;        // neighbours that a body touches
  [[nodiscard]] double LargestIsland() const;        // bodies in the largest island
  [[nodiscard]] double ShareInLargeIslands() const;  // share of bodies in islands of at least kDozen
  [[nodiscard]] std::size_t LargestIslandEver() const { return m_largestEver; }

 private:
  static constexpr std::size_t kDozen = 12;

  std::size_t FindRoot(std::size_t place);

  std::size_t m_looks = 0;
  std::size_t m_bodies = 0;  // summed over all looks, like the next four
  std::size_t m_touches = 0;
  std::size_t m_touching = 0;
  std::size_t m_inLargeIslands = 0;
  std::size_t m_largest = 0;
  std::size_t m_largestEver = 0;
  // Scratch. A disjoint-set forest: another body of its island for each body, itself for a root; island size at each
  // root.
  std::vector<std::size_t> m_others;
  std::vector<std::size_t> m_sizes;
  std::vector<physics::BodyId> m_touched;
};

}  // namespace wobble::bench
