// The force terms, each by itself, in either precision: the plain reference that every faster kernel is tested against.
//
// Positions are in the body's local coordinates (see state.h), so single precision resolves a body wherever it is.
// Every sum has one fixed order and nothing is contracted: equal input gives equal bits on every compiler.
#pragma once

#include <span>

#include "server/physics/blueprint.h"
#include "server/physics/contact.h"
#include "server/physics/vector.h"

namespace wobble::physics {

// What differs from body to body and stays constant through a tick.
template <class Real>
struct Load {
  Vector3<Real> acceleration = Vector3<Real>::Zero();  // gravity and what the player pushes, m/s²
  Real gasFactor = 1;                                  // times the blueprint's gas
  Real stiffnessFactor = 1;                            // times every spring's stiffness and damping
};

template <class Real>
void AddSprings(std::span<const Spring<Real>> springs, Real stiffnessFactor, std::span<const Vector3<Real>> x,
                std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// Volume inside a closed surface by the divergence theorem, ⅙ Σ a·(b × c) over its faces, m³. Taken about the first
// vertex: the sum does not depend on the point, but its rounding does. Negative when the surface is inside out.
template <class Real>
[[nodiscard]] Real ComputeVolume(std::span<const Face> faces, std::span<const Vector3<Real>> x);
template <class Real>
[[nodiscard]] Real ComputeVolume(const std::vector<Face>& faces, const std::vector<Vector3<Real>>& x) {
  return ComputeVolume<Real>(std::span<const Face>(faces), std::span<const Vector3<Real>>(x));
}

// Pressure of an ideal gas, nRT/V, Pa. Below `floorVolume` V_c it goes on along its tangent, (nRT/V_c)(2 − V/V_c): the
// hyperbola would let the force grow without bound within one step of a body that is being crushed.
template <class Real>
[[nodiscard]] Real ComputePressure(Real gas, Real volume, Real floorVolume) {
  return volume > floorVolume ? gas / volume : gas / floorVolume * (Real(2) - volume / floorVolume);
}
inline constexpr double kFloorVolumeShare = 0.1;  // V_c as a share of the rest volume

// (P − P₀)·A n of every face, a third to each of its vertices. On a closed surface this is exactly the gradient of
// nRT ln V − P₀ V, since ∂V/∂xᵢ is a third of the area vectors around vertex i.
template <class Real>
void AddGas(const Coefficients<Real>& body, Real gasFactor, std::span<const Vector3<Real>> x,
            std::span<Vector3<Real>> forces);

// All forces that act on the body but those of other bodies and the load's, N.
template <class Real>
void ComputeForces(const Coefficients<Real>& body, const Load<Real>& load, std::span<const Surface<Real>> surfaces,
                   std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// Turns forces, N, into accelerations, m/s², the load's added.
template <class Real>
void DivideByMasses(const Coefficients<Real>& body, const Load<Real>& load, std::span<Vector3<Real>> forces);

// Both: everything that acts on a body which meets no other, as accelerations, m/s².
template <class Real>
void ComputeAccelerations(const Coefficients<Real>& body, const Load<Real>& load,
                          std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                          std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                          std::span<Vector3<Real>> accelerations);

// Energies, for health checks, tests and the laboratory. J.
[[nodiscard]] double ComputeSpringEnergy(const Coefficients<double>& body, std::span<const Vector3d> x);
// P₀V − nRT ln(V/V₀), with V₀ = 1 m³: the work that the gas has left to do, up to a constant; below the floor volume
// what the tangent's pressure leaves of it.
[[nodiscard]] double ComputeGasEnergy(const Coefficients<double>& body, std::span<const Vector3d> x,
                                      double gasFactor = 1);
[[nodiscard]] double ComputeKineticEnergy(const Coefficients<double>& body, std::span<const Vector3d> v);

}  // namespace wobble::physics
