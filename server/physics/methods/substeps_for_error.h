// The number of substeps that keeps a body's error within what the scene allows, learnt from the ticks before.
//
// The estimate costs two sums a substep, over stages that RK4 computes anyway. Replacing the fourth stage's velocity v₄
// and acceleration a₄ by the new ones gives a method of one order less, so
//   E = Σ over substeps of (h/6) RMS(v₄ − v_new) + (h/6) RMS(a₄ − a₁,next) · (time left in the tick)
// is the error of such a method: the first term in position, the second in a velocity that goes on to the tick's end.
// The error of RK4 itself is kErrorShare E/n. Measured against step doubling, the median of true over estimated error
// is 0.87 to 1.12 on balls, lattices and cloth. Rejected: step doubling on sampled ticks, which misses impacts.
//
// RK4's error is proportional to n⁻⁴, so c = error · n⁴ predicts the error at any other number n of substeps.
//
// In contact the error is larger than that by a factor of 2 (median) to 4 (one body in ten) at 1 mm/s: a vertex that
// touches, leaves, slides or sticks makes a kink in the force, and at a kink RK4 is of order 2, which no difference of
// stages shows. Rejected: letting the error of a body in contact fall with n⁻² beyond four substeps. At 0.1 mm/s it
// brought 0.63 of body-seconds within the target instead of 0.33, for 2.4 times the substeps, and at 1 mm/s, where all
// are within it anyway, it took 1.6 times as many. Balls pressed together in a pit took 41, and 4 of 10 still missed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace wobble::physics {

inline constexpr double kErrorShare = 0.58;

// The substeps that one body asks for, from the errors of its last ticks. Errors are RMS over its vertices, m.
class StepHistory {
 public:
  static constexpr std::size_t kTicks = 6;

  // All that it remembers, to be stored.
  struct Memory {
    std::array<double, kTicks> coefficients{};  // c of the last ticks, m
    std::uint8_t next = 0;                      // place of the oldest, below kTicks
    double error = 0;                           // m
    int substeps = 1;
    int ticksBelow = 0;  // in a row so far for which a lower rung would have sufficed
  };

  StepHistory() = default;
  explicit StepHistory(const Memory& memory) : m_memory(memory) {}
  [[nodiscard]] const Memory& Read() const { return m_memory; }

  // Substeps for the next tick, on the ladder.
  [[nodiscard]] int Substeps() const { return m_memory.substeps; }

  // The error of the last tick that was recorded, m.
  [[nodiscard]] double Error() const { return m_memory.error; }

  // Records the error of a tick in so many substeps. allowed: error allowed in one tick, m.
  void Record(double error, int substeps, double allowed);

 private:
  Memory m_memory;
};

// A tick with this many times the allowed error is stepped again.
inline constexpr double kRedoFactor = 4;

// The least rung of the ladder at which a tick with `error` at `substeps` would have been within `allowed`, m.
[[nodiscard]] int FindSubstepsForError(double error, int substeps, double allowed);

}  // namespace wobble::physics
