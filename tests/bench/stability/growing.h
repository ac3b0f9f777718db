// Whether a step lets a body near rest run away, found by trying.
#pragma once

#include <vector>

#include "tests/bench/stability/free_body.h"

namespace wobble::bench {

// A body at rest with a tiny disturbance, which is kept tiny: what is looked for is what one step does to it after
// another, and that is linear as long as it is small.
class Disturbed {
 public:
  // Bodies that may drift or turn do so for ever, which is no instability: some of the vertices must be fixed.
  // alongX: only along x, for a pair, which its spring holds in no other direction.
  Disturbed(const physics::Blueprint& blueprint, physics::Integrator integrator, bool alongX);

  // Begins anew and takes steps of h, at most that many. Growth is believed when the disturbance has become twenty
  // times as large as it was half as many steps before, or, when all steps are done, has grown by `margin` through the
  // second half of them (natural logarithm).
  [[nodiscard]] bool Grows(double h, int maxSteps, double margin);

  // Begins anew; by how much it grows in a step of h, natural logarithm, as a mean over the second half of the steps.
  [[nodiscard]] double FindGrowth(double h, int steps);

 private:
  void Begin();
  // The mean, over that many steps, of the square of its size, as a logarithm.
  double Step(double h, int steps);
  void Scale(double factor);

  FreeBody m_body;
  double m_frequency;   // that positions are weighed by against velocities, 1/s
  double m_size;        // to begin with, of frequency times way, m/s
  double m_scaled = 0;  // logarithm of what the disturbance has been divided by so far
  std::vector<physics::Vector3d> m_directions;
};

}  // namespace wobble::bench
