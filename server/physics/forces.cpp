#include "server/physics/forces.h"

#include <cmath>

namespace wobble::physics {

template <class Real>
void AddSprings(std::span<const Spring<Real>> springs, Real stiffnessFactor, std::span<const Vector3<Real>> x,
                std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  for (const Spring<Real>& spring : springs) {
    const Vector3<Real> l = x[spring.a] - x[spring.b];
    const Real length = std::sqrt(l.dot(l));
    if (!(length > Real(0))) continue;  // two vertices in one place: no direction to push in
    const Vector3<Real> direction = l / length;
    const Real rate = (v[spring.a] - v[spring.b]).dot(direction);
    const Real tension = stiffnessFactor * (spring.stiffness * (length - spring.restLength) + spring.damping * rate);
    const Vector3<Real> force = tension * direction;
    forces[spring.a] -= force;
    forces[spring.b] += force;
  }
}

template <class Real>
Real ComputeVolume(std::span<const Face> faces, std::span<const Vector3<Real>> x) {
  const Vector3<Real> point = x[0];
  Real sum = 0;
  for (const Face& face : faces) {
    const Vector3<Real> a = x[face[0]] - point;
    const Vector3<Real> b = x[face[1]] - point;
    const Vector3<Real> c = x[face[2]] - point;
    sum += a.dot(b.cross(c));
  }
  return sum / Real(6);
}

template <class Real>
void AddGas(const Coefficients<Real>& body, Real gasFactor, std::span<const Vector3<Real>> x,
            std::span<Vector3<Real>> forces) {
  const Real volume = ComputeVolume<Real>(body.faces, x);
  const Real pressure = ComputePressure(gasFactor * body.gas, volume, body.floorVolume) - body.ambientPressure;
  const Real share = pressure / Real(6);  // ½ for the triangle's area, ⅓ for each of its vertices
  for (const Face& face : body.faces) {
    const Vector3<Real> a = x[face[0]];
    const Vector3<Real> force = share * (x[face[1]] - a).cross(x[face[2]] - a);
    forces[face[0]] += force;
    forces[face[1]] += force;
    forces[face[2]] += force;
  }
}

template <class Real>
void ComputeForces(const Coefficients<Real>& body, const Load<Real>& load, std::span<const Surface<Real>> surfaces,
                   std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  for (Vector3<Real>& force : forces) force.setZero();
  AddSprings<Real>(body.springs, load.stiffnessFactor, x, v, forces);
  if (body.gas > Real(0)) AddGas<Real>(body, load.gasFactor, x, forces);
  AddContacts<Real>(body.contact, body.contactShares, surfaces, contacts, x, v, forces);
}

template <class Real>
void DivideByMasses(const Coefficients<Real>& body, const Load<Real>& load, std::span<Vector3<Real>> forces) {
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = forces[i] * body.inverseMasses[i] + load.acceleration;
}

template <class Real>
void ComputeAccelerations(const Coefficients<Real>& body, const Load<Real>& load,
                          std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                          std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                          std::span<Vector3<Real>> accelerations) {
  ComputeForces<Real>(body, load, surfaces, contacts, x, v, accelerations);
  DivideByMasses<Real>(body, load, accelerations);
}

double ComputeSpringEnergy(const Coefficients<double>& body, std::span<const Vector3d> x) {
  double energy = 0;
  for (const Spring<double>& spring : body.springs) {
    const double stretch = (x[spring.a] - x[spring.b]).norm() - spring.restLength;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  }
  return energy;
}

double ComputeGasEnergy(const Coefficients<double>& body, std::span<const Vector3d> x, double gasFactor) {
  if (!(body.gas > 0)) return 0;
  const double volume = ComputeVolume<double>(body.faces, x);
  const double gas = gasFactor * body.gas;
  if (volume > body.floorVolume) return body.ambientPressure * volume - gas * std::log(volume);
  // From the floor V_c on: ∫ (nRT/V_c)(2 − V/V_c) dV from V to V_c = nRT (3/2 − 2u + u²/2) with u = V/V_c.
  const double u = volume / body.floorVolume;
  return body.ambientPressure * volume - gas * (std::log(body.floorVolume) - (1.5 - 2 * u + u * u / 2));
}

double ComputeKineticEnergy(const Coefficients<double>& body, std::span<const Vector3d> v) {
  double energy = 0;
  for (std::size_t i = 0; i < v.size(); ++i) energy += 0.5 * body.masses[i] * v[i].squaredNorm();
  return energy;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                    \
  template void AddSprings<Real>(std::span<const Spring<Real>>, Real, std::span<const Vector3<Real>>,               \
                                 std::span<const Vector3<Real>>, std::span<Vector3<Real>>);                         \
  template Real ComputeVolume<Real>(std::span<const Face>, std::span<const Vector3<Real>>);                         \
  template void AddGas<Real>(const Coefficients<Real>&, Real, std::span<const Vector3<Real>>,                       \
                             std::span<Vector3<Real>>);                                                             \
  template void ComputeForces<Real>(const Coefficients<Real>&, const Load<Real>&, std::span<const Surface<Real>>,   \
                                    std::span<const Contact<Real>>, std::span<const Vector3<Real>>,                 \
                                    std::span<const Vector3<Real>>, std::span<Vector3<Real>>);                      \
  template void DivideByMasses<Real>(const Coefficients<Real>&, const Load<Real>&, std::span<Vector3<Real>>);       \
  template void ComputeAccelerations<Real>(                                                                         \
      const Coefficients<Real>&, const Load<Real>&, std::span<const Surface<Real>>, std::span<const Contact<Real>>, \
      std::span<const Vector3<Real>>, std::span<const Vector3<Real>>, std::span<Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
