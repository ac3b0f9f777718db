// Finds by trial whether a body near rest is unstable at a given step.
#pragma once

#include <vector>

#include "tests/bench/stability/free_body.h"

namespace wobble::bench {

// A body at rest with a tiny disturbance, rescaled to stay tiny: the experiment measures the growth per step, which is
// linear only for small disturbances.
class Disturbed {
 public:
  // Some vertices must be fixed: free bodies drift and turn for ever, which is no instability. alongX: disturbs along x
  // only; for a pair, whose spring acts in no other direction.
  Disturbed(const physics::Blueprint& blueprint, physics::Integrator integrator, bool alongX);

  // Restarts and takes at most `maxSteps` steps of h. True when the disturbance has become twenty times as large as
  // half as many steps before or, after all steps, has grown by more than `margin` (natural logarithm) over their
  // second half.
  [[nodiscard]] bool Grows(double h, int maxSteps, double margin);

  // Restarts; returns the growth per step of h, natural logarithm, as a mean over the second half of the steps.
  [[nodiscard]] double FindGrowth(double h, int steps);

 private:
  void Begin();
  // Logarithm of the mean square size over that many steps.
  double Step(double h, int steps);
  void Scale(double factor);

  FreeBody m_body;
  double m_frequency;   // weight of positions against velocities, 1/s
  double m_size;        // initial size: frequency times displacement, m/s
  double m_scaled = 0;  // logarithm of the product of all rescalings so far
  std::vector<physics::Vector3d> m_directions;
};

}  // namespace wobble::bench
