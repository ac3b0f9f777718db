#include "server/physics/health.h"

namespace wobble::physics {

template <class Real>
Health FindHealth(const Coefficients<Real>& body, std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v) {
  // A sum of what is finite may overflow, but not these: places and speeds that large are no better than none.
  Vector3<Real> sum = Vector3<Real>::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i].cwiseAbs() + v[i].cwiseAbs();
  if (!sum.allFinite()) return Health::kNonFinite;
  return IsInsideOut<Real>(body, x) ? Health::kInverted : Health::kGood;
}

template <class Real>
double ComputeMotionEnergy(const Blueprint& blueprint, const Load<Real>& load, std::span<const Vector3<Real>> x,
                           std::span<const Vector3<Real>> v) {
  const Coefficients<Real>& body = blueprint.Read<Real>();
  const Vector3d acceleration = load.acceleration.template cast<double>();
  double energy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double kinetic = v[i].template cast<double>().squaredNorm() / 2;
    energy += double{body.masses[i]} * (kinetic - acceleration.dot(x[i].template cast<double>()));
  }
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
  energy.stored = double{load.stiffnessFactor} * ComputeSpringEnergy(full, scratch, load.torn) +
                  ComputeRepulsionEnergy(full, scratch, load.torn) +
                  ComputeContactEnergy<Real>(blueprint.Read<Real>(), surfaces, contacts, x);
  energy.gas = ComputeGasEnergy(full, scratch, double{load.gasFactor});
  return energy;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                    \
  template Health FindHealth<Real>(const Coefficients<Real>&, std::span<const Vector3<Real>>,                       \
                                   std::span<const Vector3<Real>>);                                                 \
  template double ComputeMotionEnergy<Real>(const Blueprint&, const Load<Real>&, std::span<const Vector3<Real>>,    \
                                            std::span<const Vector3<Real>>);                                        \
  template ElasticEnergy ComputeElasticEnergy<Real>(const Blueprint&, const Load<Real>&,                            \
                                                    std::span<const Surface<Real>>, std::span<const Contact<Real>>, \
                                                    std::span<const Vector3<Real>>, std::vector<Vector3d>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
