// The force terms, each by itself, in either precision: the plain reference that every faster kernel is tested against.
//
// Positions are in the body's local coordinates (see state.h), so single precision resolves a body wherever it is.
// Every sum has one fixed order and nothing is contracted: equal input gives equal bits on every compiler.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/contact/contact.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// A force on one vertex from outside, N: a hand that drags it.
template <class Real>
struct VertexForce {
  std::uint16_t vertex = 0;
  Vector3<Real> force = Vector3<Real>::Zero();
};

// What differs from body to body and stays constant through a tick.
template <class Real>
struct Load {
  Vector3<Real> acceleration = Vector3<Real>::Zero();  // gravity and what the player pushes, m/s²
  Real gasFactor = 1;                                  // times the blueprint's gas
  Real stiffnessFactor = 1;                            // times every spring's stiffness and damping
  Vector3<Real> wind = Vector3<Real>::Zero();          // of the medium that drags at faces, m/s
  std::span<const VertexForce<Real>> pushes;
  std::span<const std::uint8_t> torn;  // State::torn: not 0 where a spring has torn; empty: none has
};

// Springs that `torn` names are skipped.
template <class Real>
void AddSprings(std::span<const Spring<Real>> springs, Real stiffnessFactor, std::span<const Vector3<Real>> x,
                std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces,
                std::span<const std::uint8_t> torn = {});

// K_r/d⁴ that pushes the ends of each spring apart. Below kRepulsionFloorShare of the rest length it stays what it is
// there: the hyperbola would let the force of two vertices that meet grow without bound.
template <class Real>
void AddRepulsion(std::span<const Spring<Real>> springs, Real repulsion, std::span<const Vector3<Real>> x,
                  std::span<Vector3<Real>> forces, std::span<const std::uint8_t> torn = {});

// Volume inside a closed surface by the divergence theorem, ⅙ Σ a·(b × c) over its faces, m³. Taken about the first
// vertex: the sum does not depend on the point, but its rounding does. Negative when the surface is inside out.
template <class Real>
[[nodiscard]] Real ComputeVolume(std::span<const Face> faces, std::span<const Vector3<Real>> x);
template <class Real>
[[nodiscard]] Real ComputeVolume(const std::vector<Face>& faces, const std::vector<Vector3<Real>>& x) {
  return ComputeVolume<Real>(std::span<const Face>(faces), std::span<const Vector3<Real>>(x));
}

// Area inside a closed outline by Green's theorem, ½ Σ (xₐ z_b − x_b zₐ) over its edges, m². As for the volume: taken
// about a vertex, negative when inside out.
template <class Real>
[[nodiscard]] Real ComputeArea(std::span<const std::array<std::uint16_t, 2>> outline, std::span<const Vector3<Real>> x);
template <class Real>
[[nodiscard]] Real ComputeArea(const std::vector<std::array<std::uint16_t, 2>>& outline,
                               const std::vector<Vector3<Real>>& x) {
  return ComputeArea<Real>(std::span<const std::array<std::uint16_t, 2>>(outline), std::span<const Vector3<Real>>(x));
}

// Whether the gas of a body is inside out: no volume (planar: area) is left to it. Never without gas.
template <class Real>
[[nodiscard]] bool IsInsideOut(const Coefficients<Real>& body, std::span<const Vector3<Real>> x);

// Pressure of an ideal gas, nRT/V, Pa. Below `floorVolume` V_c it goes on along its tangent, (nRT/V_c)(2 − V/V_c): the
// hyperbola would let the force grow without bound within one step of a body that is being crushed.
template <class Real>
[[nodiscard]] Real ComputePressure(Real gas, Real volume, Real floorVolume) {
  return volume > floorVolume ? gas / volume : gas / floorVolume * (Real(2) - volume / floorVolume);
}
inline constexpr double kFloorVolumeShare = 0.1;  // V_c as a share of the rest volume

// (P − P₀)·A n of every face, a third to each of its vertices. On a closed surface this is exactly the gradient of
// nRT ln V − P₀ V, since ∂V/∂xᵢ is a third of the area vectors around vertex i. Planar: (P − P₀) n dl of every edge of
// the outline, half to each end, the gradient of nRT ln A − P₀ A.
template <class Real>
void AddGas(const Coefficients<Real>& body, Real gasFactor, std::span<const Vector3<Real>> x,
            std::span<Vector3<Real>> forces);

// Drag of a medium that moves at `wind`: drag · A |uₙ| uₙ n on a face of area A and unit normal n, a third to each of
// its vertices, with uₙ the part along n of the wind's speed against the face's. A face has two sides and what runs
// along it does not drag: so a sheet sails, flutters and falls like a leaf.
template <class Real>
void AddDrag(std::span<const Face> faces, Real drag, const Vector3<Real>& wind, std::span<const Vector3<Real>> x,
             std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// All forces that act on the body but those of other bodies and the load's acceleration, N.
template <class Real>
void ComputeForces(const Coefficients<Real>& body, const Load<Real>& load, std::span<const Surface<Real>> surfaces,
                   std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// Turns forces, N, into accelerations, m/s², the load's added; fixed vertices and what is across a plane have none.
template <class Real>
void DivideByMasses(const Coefficients<Real>& body, const Load<Real>& load, std::span<Vector3<Real>> forces);

// Both: everything that acts on a body which meets no other, as accelerations, m/s².
template <class Real>
void ComputeAccelerations(const Coefficients<Real>& body, const Load<Real>& load,
                          std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                          std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                          std::span<Vector3<Real>> accelerations);

// Energies, for health checks, tests and the laboratory. J.
[[nodiscard]] double ComputeSpringEnergy(const Coefficients<double>& body, std::span<const Vector3d> x,
                                         std::span<const std::uint8_t> torn = {});
[[nodiscard]] double ComputeRepulsionEnergy(const Coefficients<double>& body, std::span<const Vector3d> x,
                                            std::span<const std::uint8_t> torn = {});
// P₀V − nRT ln(V/V₀), with V₀ = 1 m³ (planar: m²): the work that the gas has left to do, up to a constant; below the
// floor volume what the tangent's pressure leaves of it.
[[nodiscard]] double ComputeGasEnergy(const Coefficients<double>& body, std::span<const Vector3d> x,
                                      double gasFactor = 1);
[[nodiscard]] double ComputeKineticEnergy(const Coefficients<double>& body, std::span<const Vector3d> v);

}  // namespace wobble::physics
