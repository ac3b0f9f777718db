// The force terms, one by one, in either precision: the plain reference that every faster kernel is tested against.
//
// x: positions, m, in the body's local coordinates (state.h), so that single precision resolves a body wherever it is.
// v: velocities, m/s. forces: N; Add... functions add to them. All three hold one vector a vertex. Every sum has one
// fixed order and no multiply-add is contracted: equal input gives equal bits on every compiler.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/contact/contact.h"
#include "server/physics/contact/rod_contact.h"
#include "server/physics/methods/elasticity.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// What multiplies the forces that bring a body back to its shape (methods/recovery.h). All 0: it has its shape as the
// tick begins.
struct RecoveryFactors {
  double fold = 0;  // of the cells of a lattice
  double aim = 0;   // of the aim for the rest shape

  [[nodiscard]] bool Act() const { return fold > 0 || aim > 0; }
};

// The external load on one body, constant through a tick: what acts on it besides contacts, and how its springs and gas
// are scaled.
template <class Real>
struct Load {
  Vector3<Real> acceleration = Vector3<Real>::Zero();  // gravity and the player's moving, m/s²
  Real gasFactor = 1;                                  // multiplies the blueprint's gas
  Real stiffnessFactor = 1;                            // multiplies stiffness and damping of springs, elements, hinges
  Stiffening stiffening;                               // of a solid's elements, strained as the tick begins
  RecoveryFactors recovery;
  Vector3<Real> wind = Vector3<Real>::Zero();  // velocity of the medium that drags at faces, m/s
  std::span<const VertexForce<Real>> pushes;
  std::span<const NearRod> rods;       // springs of a body without faces, near obstacles
  std::span<const std::uint8_t> torn;  // State::torn: not 0 where a spring has torn; empty: none has
};

// Springs and their dashpots. Springs that are marked in `torn` (State::torn) are skipped.
template <class Real>
void AddSprings(std::span<const Spring<Real>> springs, Real stiffnessFactor, std::span<const Vector3<Real>> x,
                std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces,
                std::span<const std::uint8_t> torn = {});

// Pushes the ends of each whole spring apart with K_r/d⁴, K_r = repulsion, N·m⁴, at distance d. Below
// kRepulsionFloorShare of the rest length the force stays constant: the hyperbola would let the force of two vertices
// that meet grow without bound.
template <class Real>
void AddRepulsion(std::span<const Spring<Real>> springs, Real repulsion, std::span<const Vector3<Real>> x,
                  std::span<Vector3<Real>> forces, std::span<const std::uint8_t> torn = {});

// Volume inside a closed surface, m³, by the divergence theorem: ⅙ Σ a·(b × c) over its faces. Taken about the first
// vertex: the sum does not depend on the point, but its rounding does. Negative when the surface is inside out.
template <class Real>
[[nodiscard]] Real ComputeVolume(std::span<const Face> faces, std::span<const Vector3<Real>> x);
template <class Real>
[[nodiscard]] Real ComputeVolume(const std::vector<Face>& faces, const std::vector<Vector3<Real>>& x) {
  return ComputeVolume<Real>(std::span<const Face>(faces), std::span<const Vector3<Real>>(x));
}

// Area inside a closed outline, m², by Green's theorem: ½ Σ (xₐ z_b − x_b zₐ) over its edges. Like the volume, it is
// taken about a vertex and negative when inside out.
template <class Real>
[[nodiscard]] Real ComputeArea(std::span<const std::array<std::uint16_t, 2>> outline, std::span<const Vector3<Real>> x);
template <class Real>
[[nodiscard]] Real ComputeArea(const std::vector<std::array<std::uint16_t, 2>>& outline,
                               const std::vector<Vector3<Real>>& x) {
  return ComputeArea<Real>(std::span<const std::array<std::uint16_t, 2>>(outline), std::span<const Vector3<Real>>(x));
}

// What a closed skin, or the outline of a planar body with gas, encloses, m³ (planar: m²).
template <class Real>
[[nodiscard]] Real ComputeEnclosed(const Coefficients<Real>& body, std::span<const Vector3<Real>> x);

// Whether the gas of a body has no volume (planar: area) left. Always false for a body without gas.
template <class Real>
[[nodiscard]] bool IsInsideOut(const Coefficients<Real>& body, std::span<const Vector3<Real>> x);

// Pressure of an ideal gas, nRT/V, Pa. Below V_c = floorVolume it continues along its tangent, (nRT/V_c)(2 − V/V_c):
// the hyperbola would let the force grow without bound within one step of a body that is being crushed. Below 0 it is
// that of 0: a body that is inside out is to turn out, and the tangent would throw it tens of metres up. gas: nRT, J.
template <class Real>
[[nodiscard]] Real ComputePressure(Real gas, Real volume, Real floorVolume) {
  if (volume > floorVolume) return gas / volume;
  return gas / floorVolume * (Real(2) - std::max(volume, Real(0)) / floorVolume);
}
inline constexpr double kFloorVolumeShare = 0.1;  // V_c as a share of the rest volume

// Adds (P − P₀) A n of every face, a third to each of its vertices. On a closed surface this is exactly the gradient
// of nRT ln V − P₀ V, since ∂V/∂xᵢ is a third of the area vectors around vertex i. Planar: (P − P₀) n dl of every edge
// of the outline, half to each end, the gradient of nRT ln A − P₀ A. Only for a body with gas.
template <class Real>
void AddGas(const Coefficients<Real>& body, Real gasFactor, std::span<const Vector3<Real>> x,
            std::span<Vector3<Real>> forces);

// Drag of a medium that moves at `wind`, m/s: drag · A |uₙ| uₙ n on a face of area A and unit normal n, a third to each
// of its vertices, where uₙ is the part along n of the wind's velocity against the face's. drag: ½ρC, kg/m³. Both sides
// of a face drag alike, and flow along it does not drag: so a sheet sails, flutters and falls like a leaf.
template <class Real>
void AddDrag(std::span<const Face> faces, Real drag, const Vector3<Real>& wind, std::span<const Vector3<Real>> x,
             std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// Fills in all forces on the body, N, except those of other bodies and of the load's acceleration.
template <class Real>
void ComputeForces(const Coefficients<Real>& body, const Load<Real>& load, std::span<const Surface<Real>> surfaces,
                   std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// Turns forces, N, into accelerations, m/s², and adds the load's. Fixed vertices, and planar bodies across their plane,
// get none.
template <class Real>
void DivideByMasses(const Coefficients<Real>& body, const Load<Real>& load, std::span<Vector3<Real>> forces);

// ComputeForces, then DivideByMasses: the accelerations, m/s², of a body that touches no other.
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
// P₀V − nRT ln(V/V₀), with V₀ = 1 m³ (planar: 1 m²): the work that the gas can still do, up to a constant; below the
// floor volume the integral of ComputePressure.
[[nodiscard]] double ComputeGasEnergy(const Coefficients<double>& body, std::span<const Vector3d> x,
                                      double gasFactor = 1);
[[nodiscard]] double ComputeKineticEnergy(const Coefficients<double>& body, std::span<const Vector3d> v);

}  // namespace wobble::physics
