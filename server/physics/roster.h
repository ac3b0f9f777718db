// The places of a world's awake bodies, and the boxes of its sleeping ones, so that a tick costs nothing for bodies
// that sleep. Bodies are named by their places in the world's list.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/contact/resting_boxes.h"

namespace wobble::physics {

class Roster {
 public:
  // Appends a body, awake.
  void Add();
  // The bodies behind it move up by one place.
  void Remove(std::uint32_t body, bool asleep);
  // body: asleep.
  void Wake(std::uint32_t body);
  // bodies: awake, ascending. boxes: of all bodies, by place; where awake bodies will look for the sleeping ones.
  void LetSleep(std::span<const std::uint32_t> bodies, std::span<const Box> boxes);

  // Ascending; valid until the next call of another function that changes the roster.
  std::span<const std::uint32_t> FindAwake();
  [[nodiscard]] std::uint64_t CountWakes() const { return m_wakes; }  // since the world began
  [[nodiscard]] const RestingBoxes& Sleepers() const { return m_sleepers; }

 private:
  std::vector<std::uint32_t> m_awake;  // ascending
  std::vector<std::uint32_t> m_woken;  // to be merged into m_awake
  RestingBoxes m_sleepers;
  std::uint32_t m_count = 0;
  std::uint64_t m_wakes = 0;
};

}  // namespace wobble::physics
