// The minimal system for StepOnce: a world's island of one body, without contacts.
#include "tests/bench/stability/free_body.h"
#include "server/physics/shapes/finish_blueprint.h"

#include <cmath>

namespace wobble::bench {

using namespace physics;

FreeBody::FreeBody(const Blueprint& made, Integrator integrator) : blueprint(made), x(made.rest) {
  SetIntegrator(blueprint, integrator);
  v.assign(x.size(), Vector3d::Zero());
}

void FreeBody::Accelerate(std::span<const Vector3d> atX, std::span<const Vector3d> atV, std::span<Vector3d> a,
                          bool springs) const {
  Load<double> own = load;
  if (!springs) own.stiffnessFactor = 0;
  ComputeAccelerations<double>(blueprint.full, own, {}, {}, atX, atV, a);
}

double FindDisplacement(const FreeBody& body) {
  double sum = 0;
  for (std::size_t i = 0; i < body.x.size(); ++i) sum += (body.x[i] - body.blueprint.rest[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(body.x.size()));
}

}  // namespace wobble::bench
