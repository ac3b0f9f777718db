// A random generator with the same draws on every compiler and library; the distributions of the standard library
// differ. An expression draws once: the order of two operands or arguments is the compiler's.
#pragma once

#include <cmath>
#include <cstdint>

#include "server/physics/model/vector.h"

namespace wobble::bench {

// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : m_state(seed) {}
  double Draw(double least, double most) {
    std::uint64_t z = m_state += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return least + (most - least) * static_cast<double>((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
  }
  // Uniform in the logarithm.
  double DrawMagnitude(double least, double most) { return least * std::pow(most / least, Draw(0, 1)); }
  // 0 to count - 1.
  std::size_t Choose(std::size_t count) { return static_cast<std::size_t>(Draw(0, static_cast<double>(count))); }
  // Both included.
  int DrawWhole(int least, int most) {
    return least + static_cast<int>(Choose(static_cast<std::size_t>(most - least + 1)));
  }
  bool Happens(double probability) { return Draw(0, 1) < probability; }
  // In a box: z first, x last, since compilers differ in the order of a call's arguments. What low and high share takes
  // no draw.
  physics::Vector3d DrawWithin(const physics::Vector3d& low, const physics::Vector3d& high) {
    physics::Vector3d at = low;
    for (int axis = 2; axis >= 0; --axis) {
      if (low[axis] < high[axis]) at[axis] = Draw(low[axis], high[axis]);
    }
    return at;
  }
  physics::Vector3d DrawDirection() {
    constexpr double kTurn = 2 * 3.14159265358979323846;
    const double z = Draw(-1, 1);
    const double angle = Draw(0, kTurn);
    const double across = std::sqrt(1 - z * z);
    return {across * std::cos(angle), across * std::sin(angle), z};
  }

 private:
  std::uint64_t m_state;
};

}  // namespace wobble::bench
