// The true position of every vertex on the server at any moment of the last kKept ticks.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/world.h"

namespace wobble::bench {

// Interpolates between two ticks by the cubic that matches position and velocity at both. The interpolation error is
// measured at every tick by leaving that tick out: over twice the time, hence about sixteen times as large.
class Truth {
 public:
  explicit Truth(double tickSeconds) : m_tickSeconds(tickSeconds) {}

  // Records the world; call it after every tick.
  void Add(const physics::World& world);

  // Writes the vertices of body `place` at `time`, m. False when the moment is no longer or not yet recorded.
  [[nodiscard]] bool Find(double time, std::size_t place, std::vector<physics::Vector3d>& vertices) const;

  // RMS over vertices of the error at ticks that are interpolated from the ticks before and after them, m.
  [[nodiscard]] double ErrorOfHalf() const;

 private:
  static constexpr std::size_t kKept = 1024;  // ticks
  struct Body {
    std::vector<physics::Vector3d> positions;
    std::vector<physics::Vector3d> velocities;
  };
  struct Tick {
    std::uint32_t tick = 0;  // 0: none
    std::vector<Body> bodies;
  };

  [[nodiscard]] const Tick* FindTick(std::uint32_t tick) const;
  void NoteError(std::uint32_t newest);

  double m_tickSeconds;
  std::vector<Tick> m_ticks{kKept};
  double m_squares = 0;
  std::uint64_t m_count = 0;
};

}  // namespace wobble::bench
