#include "server/physics/methods/health.h"

#include <cmath>

#include "server/physics/methods/bending.h"
#include "server/physics/methods/elasticity.h"
#include "server/physics/methods/recovery.h"

namespace wobble::physics {

Health FindHealth(const BulkMotion& bulk) {
  // Sums of finite coordinates may overflow too; coordinates that large are as bad as non-finite ones.
  return std::isfinite(bulk.kineticEnergy) && bulk.centre.allFinite() ? Health::kGood : Health::kNonFinite;
}

template <class Real>
double ComputeMotionEnergy(const Blueprint& blueprint, const Load<Real>& load, const BulkMotion& bulk,
                           std::span<const Vector3<Real>> x) {
  const Vector3d acceleration = load.acceleration.template cast<double>();
  double energy = bulk.kineticEnergy - blueprint.totalMass * acceleration.dot(bulk.centre);
  for (const VertexForce<Real>& push : load.pushes) {
    energy -= push.force.template cast<double>().dot(x[push.vertex].template cast<double>());
  }
  return energy;
}

template <class Real>
ElasticEnergy ComputeElasticEnergy(const Blueprint& blueprint, const Load<Real>& load,
                                   std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                                   std::span<const Vector3<Real>> x, std::vector<Vector3d>& scratch) {
  scratch.clear();
  for (const Vector3<Real>& place : x) scratch.push_back(place.template cast<double>());
  const Coefficients<double>& full = blueprint.full;
  ElasticEnergy energy;
  energy.stored =
      double{load.stiffnessFactor} * (ComputeSpringEnergy(full, scratch, load.torn) +
                                      ComputeSolidEnergy(full, scratch) + ComputeBendingEnergy(full, scratch)) +
      ComputeRecoveryEnergy(full, load.recovery, scratch) + ComputeRepulsionEnergy(full, scratch, load.torn) +
      ComputeContactEnergy<Real>(blueprint.Read<Real>(), surfaces, contacts, x) +
      ComputeRodContactEnergy<Real>(blueprint.Read<Real>(), surfaces, load.rods, x);
  energy.gas = ComputeGasEnergy(full, scratch, double{load.gasFactor});
  return energy;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                    \
  template double ComputeMotionEnergy<Real>(const Blueprint&, const Load<Real>&, const BulkMotion&,                 \
                                            std::span<const Vector3<Real>>);                                        \
  template ElasticEnergy ComputeElasticEnergy<Real>(const Blueprint&, const Load<Real>&,                            \
                                                    std::span<const Surface<Real>>, std::span<const Contact<Real>>, \
                                                    std::span<const Vector3<Real>>, std::vector<Vector3d>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
