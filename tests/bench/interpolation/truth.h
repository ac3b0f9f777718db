// Where every vertex truly was on the server, at any moment of the last seconds.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/world.h"

namespace wobble::bench {

// Between two ticks a vertex is on the cubic that has its place and velocity at both. How far that is off is measured
// at every tick by leaving it out: over twice the time, so about sixteen times as far.
class Truth {
 public:
  explicit Truth(double tickSeconds) : m_tickSeconds(tickSeconds) {}

  // After every tick of the world.
  void Add(const physics::World& world);

  // Of body `place`, all vertices, m. False when the moment is not kept (any more, or yet).
  [[nodiscard]] bool Find(double time, std::size_t place, std::vector<physics::Vector3d>& vertices) const;

  // RMS over vertices of ticks found from the ticks before and after them, m.
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
