// How much players are in one another's way: by how many others each is touched, and how many hang together.
#pragma once

#include <cstddef>
#include <vector>

#include "server/physics/world.h"

namespace wobble::bench {

class Contacts {
 public:
  // At some moment, between two ticks.
  void Look(const physics::World& world);

  // Over all looks. A group: bodies each of which touches another of them.
  [[nodiscard]] double Touching() const;            // bodies that touch another, mean
  [[nodiscard]] double TouchedByEach() const;       // others that a body touches, mean
  [[nodiscard]] double LargestIsland() const;       // bodies in it, mean
  [[nodiscard]] double ShareInLargeGroups() const;  // of all bodies, those in groups of a dozen and more
  [[nodiscard]] std::size_t LargestIslandEver() const { return m_largestEver; }

 private:
  static constexpr std::size_t kDozen = 12;

  std::size_t FindRoot(std::size_t place);

  std::size_t m_looks = 0;
  std::size_t m_bodies = 0;  // of all looks, as are the next four
  std::size_t m_touches = 0;
  std::size_t m_touching = 0;
  std::size_t m_inLargeGroups = 0;
  std::size_t m_largest = 0;
  std::size_t m_largestEver = 0;
  // Scratch: of each body another of its group, or itself; how many are in the group of which it is the root.
  std::vector<std::size_t> m_others;
  std::vector<std::size_t> m_sizes;
  std::vector<physics::BodyId> m_touched;
};

}  // namespace wobble::bench
