// Steps take a sixth of the fastest period, and friction is near critical for the slow modes. Forces are those of a
// body without dashpots: they do not change the equilibrium, and strong ones (a damping ratio of 0.6) would make steps
// of this length unstable.
#include "server/physics/shapes/relax.h"

#include <algorithm>

#include "server/physics/methods/forces.h"

namespace wobble::physics {

bool RelaxRest(Blueprint& blueprint, double tolerance, int maxSteps) {
  const std::size_t count = blueprint.rest.size();
  const Load<double> load;
  const std::vector<Vector3d> still(count, Vector3d::Zero());
  std::vector<Vector3d> v(count, Vector3d::Zero());
  std::vector<Vector3d> a(count);
  const double step = 1 / blueprint.angularFrequency;
  for (int iteration = 0; iteration < maxSteps; ++iteration) {
    ComputeAccelerations<double>(blueprint.full, load, {}, {}, blueprint.rest, still, a);
    double worst = 0;
    for (std::size_t i = 0; i < count; ++i) {
      worst = std::max(worst, a[i].cwiseAbs().maxCoeff());
      v[i] = 0.9 * v[i] + step * a[i];
      blueprint.rest[i] += step * v[i];
    }
    if (worst < tolerance) return true;
  }
  return false;
}

}  // namespace wobble::physics
