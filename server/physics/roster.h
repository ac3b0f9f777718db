// Who of a world's bodies is awake, so that a tick need not ask those who sleep. Bodies go by their places in the
// world.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/contact/resting_boxes.h"

namespace wobble::physics {

class Roster {
 public:
  // One more behind the others, awake.
  void Add();
  // Those behind it move up by one.
  void Remove(std::uint32_t body, bool asleep);
  // Of a body that sleeps.
  void Wake(std::uint32_t body);
  // Of bodies that are awake, ascending, each with its box among `boxes`, where it is to be found by others.
  void LetSleep(std::span<const std::uint32_t> bodies, std::span<const Box> boxes);

  // Ascending. Calls of the others spoil it.
  std::span<const std::uint32_t> FindAwake();
  [[nodiscard]] std::uint64_t CountWakes() const { return m_wakes; }  // since ever
  [[nodiscard]] const RestingBoxes& Sleepers() const { return m_sleepers; }

 private:
  std::vector<std::uint32_t> m_awake;  // ascending
  std::vector<std::uint32_t> m_woken;  // to be added to these
  RestingBoxes m_sleepers;
  std::uint32_t m_count = 0;
  std::uint64_t m_wakes = 0;
};

}  // namespace wobble::physics
