// Plain loops over springs and faces. Sums run in the order of the lists; the kernels of kernels/ are tested against
// them.
#include "server/physics/methods/forces.h"

#include <algorithm>
#include <cmath>

#include "server/physics/methods/bending.h"
#include "server/physics/methods/elasticity.h"
#include "server/physics/methods/recovery.h"

namespace wobble::physics {

namespace {

template <class Real>
void AddSpring(const Spring<Real>& spring, Real stiffnessFactor, std::span<const Vector3<Real>> x,
               std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  const Vector3<Real> l = x[spring.a] - x[spring.b];
  const Real length = std::sqrt(l.dot(l));
  if (!(length > Real(0))) return;  // two vertices in one place: no direction to push in
  const Vector3<Real> direction = l / length;
  const Real rate = (v[spring.a] - v[spring.b]).dot(direction);
  const Real tension = stiffnessFactor * (spring.stiffness * (length - spring.restLength) + spring.damping * rate);
  const Vector3<Real> force = tension * direction;
  forces[spring.a] -= force;
  forces[spring.b] += force;
}

// Calls add(spring) for the springs that have not torn. A body without torn springs pays for no test a spring.
template <class Real, class Add>
void ForWhole(std::span<const Spring<Real>> springs, std::span<const std::uint8_t> torn, Add&& add) {
  if (torn.empty()) {
    for (const Spring<Real>& spring : springs) add(spring);
    return;
  }
  for (std::size_t i = 0; i < springs.size(); ++i) {
    if (torn[i] == 0) add(springs[i]);
  }
}

template <class Real>
void AddVolumeGas(const Coefficients<Real>& body, Real gas, std::span<const Vector3<Real>> x,
                  std::span<Vector3<Real>> forces) {
  const Real volume = ComputeVolume<Real>(body.faces, x);
  const Real pressure = ComputePressure(gas, volume, body.floorVolume) - body.ambientPressure;
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
void AddAreaGas(const Coefficients<Real>& body, Real gas, std::span<const Vector3<Real>> x,
                std::span<Vector3<Real>> forces) {
  const Real area = ComputeArea<Real>(body.outline, x);
  const Real share = (ComputePressure(gas, area, body.floorVolume) - body.ambientPressure) / Real(2);
  for (const auto& [a, b] : body.outline) {
    const Vector3<Real> along = x[b] - x[a];
    const Vector3<Real> force(share * along.z(), 0, -share * along.x());
    forces[a] += force;
    forces[b] += force;
  }
}

}  // namespace

template <class Real>
void AddSprings(std::span<const Spring<Real>> springs, Real stiffnessFactor, std::span<const Vector3<Real>> x,
                std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces, std::span<const std::uint8_t> torn) {
  ForWhole<Real>(springs, torn,
                 [&](const Spring<Real>& spring) { AddSpring<Real>(spring, stiffnessFactor, x, v, forces); });
}

template <class Real>
void AddRepulsion(std::span<const Spring<Real>> springs, Real repulsion, std::span<const Vector3<Real>> x,
                  std::span<Vector3<Real>> forces, std::span<const std::uint8_t> torn) {
  ForWhole<Real>(springs, torn, [&](const Spring<Real>& spring) {
    const Vector3<Real> l = x[spring.a] - x[spring.b];
    const Real length = std::sqrt(l.dot(l));
    if (!(length > Real(0))) return;
    const Real bounded = std::max(length, static_cast<Real>(kRepulsionFloorShare) * spring.restLength);
    const Real squared = bounded * bounded;
    const Vector3<Real> force = repulsion / (squared * squared * length) * l;
    forces[spring.a] += force;
    forces[spring.b] -= force;
  });
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
Real ComputeArea(std::span<const std::array<std::uint16_t, 2>> outline, std::span<const Vector3<Real>> x) {
  const Vector3<Real> point = x[outline.front()[0]];
  Real sum = 0;
  for (const auto& [first, second] : outline) {
    const Vector3<Real> a = x[first] - point;
    const Vector3<Real> b = x[second] - point;
    sum += a.x() * b.z() - b.x() * a.z();
  }
  return sum / Real(2);
}

template <class Real>
Real ComputeEnclosed(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  return body.outline.empty() ? ComputeVolume<Real>(body.faces, x) : ComputeArea<Real>(body.outline, x);
}

template <class Real>
bool IsInsideOut(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  return body.gas > Real(0) && !(ComputeEnclosed<Real>(body, x) > Real(0));
}

template <class Real>
void AddGas(const Coefficients<Real>& body, Real gasFactor, std::span<const Vector3<Real>> x,
            std::span<Vector3<Real>> forces) {
  if (body.outline.empty()) {
    AddVolumeGas<Real>(body, gasFactor * body.gas, x, forces);
  } else {
    AddAreaGas<Real>(body, gasFactor * body.gas, x, forces);
  }
}

template <class Real>
void AddDrag(std::span<const Face> faces, Real drag, const Vector3<Real>& wind, std::span<const Vector3<Real>> x,
             std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  for (const auto& [i, j, k] : faces) {
    const Vector3<Real> doubleArea = (x[j] - x[i]).cross(x[k] - x[i]);
    const Real squared = doubleArea.dot(doubleArea);
    if (!(squared > Real(0))) continue;
    const Real through = (wind - (v[i] + v[j] + v[k]) / Real(3)).dot(doubleArea);
    // With S = 2A n, A |uₙ| uₙ n = |u·S| (u·S) S / 2 S²; each vertex gets a third.
    const Vector3<Real> force = drag * std::fabs(through) * through / (Real(6) * squared) * doubleArea;
    forces[i] += force;
    forces[j] += force;
    forces[k] += force;
  }
}

template <class Real>
void ComputeForces(const Coefficients<Real>& body, const Load<Real>& load, std::span<const Surface<Real>> surfaces,
                   std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  for (Vector3<Real>& force : forces) force.setZero();
  AddSprings<Real>(body.springs, load.stiffnessFactor, x, v, forces, load.torn);
  if (body.repulsion > Real(0)) AddRepulsion<Real>(body.springs, body.repulsion, x, forces, load.torn);
  if (!body.tetrahedra.empty()) {
    AddTetrahedra<Real>(body.tetrahedra, body.solid, load.stiffnessFactor, x, v, forces);
  }
  if (!body.hinges.empty()) {
    AddHinges<Real>(body.hinges, body.hingeFloorSquare, load.stiffnessFactor, x, v, forces);
  }
  if (load.recovery.Act()) AddRecovery<Real>(body, load.recovery, x, v, forces);
  if (body.gas > Real(0)) AddGas<Real>(body, load.gasFactor, x, forces);
  if (body.drag > Real(0)) AddDrag<Real>(body.faces, body.drag, load.wind, x, v, forces);
  for (const VertexForce<Real>& push : load.pushes) forces[push.vertex] += push.force;
  AddContacts<Real>(body.contact, body.contactShares, surfaces, contacts, x, v, forces);
  if (!load.rods.empty()) AddRodContacts<Real>(body, surfaces, load.rods, x, v, forces);
}

template <class Real>
void DivideByMasses(const Coefficients<Real>& body, const Load<Real>& load, std::span<Vector3<Real>> forces) {
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = forces[i] * body.inverseMasses[i] + load.acceleration;
  for (const std::uint16_t vertex : body.fixed) forces[vertex].setZero();
  if (!body.planar) return;
  for (Vector3<Real>& acceleration : forces) acceleration.y() = 0;
}

template <class Real>
void ComputeAccelerations(const Coefficients<Real>& body, const Load<Real>& load,
                          std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                          std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                          std::span<Vector3<Real>> accelerations) {
  ComputeForces<Real>(body, load, surfaces, contacts, x, v, accelerations);
  DivideByMasses<Real>(body, load, accelerations);
}

double ComputeSpringEnergy(const Coefficients<double>& body, std::span<const Vector3d> x,
                           std::span<const std::uint8_t> torn) {
  double energy = 0;
  ForWhole(std::span<const Spring<double>>(body.springs), torn, [&](const Spring<double>& spring) {
    const double stretch = (x[spring.a] - x[spring.b]).norm() - spring.restLength;
    energy += 0.5 * spring.stiffness * stretch * stretch;
  });
  return energy;
}

double ComputeRepulsionEnergy(const Coefficients<double>& body, std::span<const Vector3d> x,
                              std::span<const std::uint8_t> torn) {
  double energy = 0;
  if (!(body.repulsion > 0)) return energy;
  ForWhole(std::span<const Spring<double>>(body.springs), torn, [&](const Spring<double>& spring) {
    const double length = (x[spring.a] - x[spring.b]).norm();
    const double floor = kRepulsionFloorShare * spring.restLength;
    const double bounded = std::max(length, floor);
    energy += body.repulsion / (3 * bounded * bounded * bounded);
    if (length < floor) energy += body.repulsion * (floor - length) / (floor * floor * floor * floor);
  });
  return energy;
}

double ComputeGasEnergy(const Coefficients<double>& body, std::span<const Vector3d> x, double gasFactor) {
  if (!(body.gas > 0)) return 0;
  const double volume =
      body.outline.empty() ? ComputeVolume<double>(body.faces, x) : ComputeArea<double>(body.outline, x);
  const double gas = gasFactor * body.gas;
  if (volume > body.floorVolume) return body.ambientPressure * volume - gas * std::log(volume);
  // Below the floor V_c: ∫ (nRT/V_c)(2 − V/V_c) dV from V to V_c = nRT (3/2 − 2u + u²/2) with u = V/V_c; below 0
  // without the square.
  const double u = volume / body.floorVolume;
  const double bounded = std::max(u, 0.0);
  return body.ambientPressure * volume - gas * (std::log(body.floorVolume) - (1.5 - 2 * u + bounded * bounded / 2));
}

double ComputeKineticEnergy(const Coefficients<double>& body, std::span<const Vector3d> v) {
  double energy = 0;
  for (std::size_t i = 0; i < v.size(); ++i) energy += 0.5 * body.masses[i] * v[i].squaredNorm();
  return energy;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                    \
  template void AddSprings<Real>(std::span<const Spring<Real>>, Real, std::span<const Vector3<Real>>,               \
                                 std::span<const Vector3<Real>>, std::span<Vector3<Real>>,                          \
                                 std::span<const std::uint8_t>);                                                    \
  template void AddRepulsion<Real>(std::span<const Spring<Real>>, Real, std::span<const Vector3<Real>>,             \
                                   std::span<Vector3<Real>>, std::span<const std::uint8_t>);                        \
  template Real ComputeVolume<Real>(std::span<const Face>, std::span<const Vector3<Real>>);                         \
  template Real ComputeArea<Real>(std::span<const std::array<std::uint16_t, 2>>, std::span<const Vector3<Real>>);   \
  template Real ComputeEnclosed<Real>(const Coefficients<Real>&, std::span<const Vector3<Real>>);                   \
  template bool IsInsideOut<Real>(const Coefficients<Real>&, std::span<const Vector3<Real>>);                       \
  template void AddDrag<Real>(std::span<const Face>, Real, const Vector3<Real>&, std::span<const Vector3<Real>>,    \
                              std::span<const Vector3<Real>>, std::span<Vector3<Real>>);                            \
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
