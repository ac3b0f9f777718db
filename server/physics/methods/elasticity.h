// Elasticity of tetrahedra: the stable neo-Hookean material of Smith, de Goes & Kim (2018), with a viscosity beside it.
// Plain code in either precision, the reference for the lanes.
//
// F is the deformation gradient of an element, constant in it; F_c are its columns, C its cofactor matrix (columns
// F₂×F₃, F₃×F₁, F₁×F₂), J = det F, I = Σ F_c·F_c. The energy of a unit of volume at rest,
//   Ψ = μ/2 (I − 3) − μ/2 ln((I + 1)/4) + λ/2 [(J − α)² − (1 − α)²],
// has the gradient P = ∂Ψ/∂F = μ (1 − 1/(I + 1)) F + λ (J − α) C. It needs no singular values and no inverse, and is
// finite for any F, also flat (J = 0) and inside out (J < 0). Along the thinnest direction of an element that is flat
// or inside out both terms push towards J > 0; so it always comes back, and no such state is at rest. The logarithm
// does that for an element squeezed to a point: without it that state would be a minimum, for ν = 0 as deep as rest.
//
// α and the meaning of μ and λ: with F = 1 + h, h small, dI = 2 tr h, dJ = tr h, dC = tr h 1 − hᵀ, so
//   P = [¾ μ + λ (1 − α)] 1 + ¾ μ h + (λ + μ/8) tr h 1 + λ (1 − α)(tr h 1 − hᵀ).
// No stress at rest asks for α = 1 + 3μ/4λ, and then P = ¾ μ (h + hᵀ) + (λ − ⅝ μ) tr h 1. This is Hooke's law with
// Lamé's constants μ_L = ¾ μ and λ_L = λ − ⅝ μ, hence μ = 4/3 μ_L and λ = λ_L + 5/6 μ_L.
//
// Rejected: corotated linear elasticity, which needs a polar decomposition, and one by singular values where elements
// are inside out.
//
// The viscous stress is 2 η F Ė with Ė = ½ (Fᵀ Ḟ + Ḟᵀ F), the rate of Green's strain. Turning the body as a whole
// changes nothing in it, and its power 2 η Ė:Ė is never negative. At rest it is Newton's 2 η times the rate of strain.
//
// Forces are −V P gᵢ on corner i. Those of an element add up to zero, and, since P Fᵀ is symmetric, so do their
// torques.
#pragma once

#include <span>

#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// youngModulus E > 0, Pa; poissonRatio 0 <= ν < ½; viscosity η, Pa·s.
[[nodiscard]] SolidMaterial<double> MakeSolidMaterial(double youngModulus, double poissonRatio, double viscosity);

// The element of these four vertices at rest, which must enclose a positive volume: (x₁ − x₀)·((x₂ − x₀)×(x₃ − x₀)) >
// 0.
[[nodiscard]] Tetrahedron<double> MakeTetrahedron(const std::array<std::uint16_t, 4>& vertices,
                                                  std::span<const Vector3d> rest);

// Adds the forces of all elements, elastic and viscous. stiffnessFactor multiplies both.
template <class Real>
void AddTetrahedra(std::span<const Tetrahedron<Real>> tetrahedra, const SolidMaterial<Real>& material,
                   Real stiffnessFactor, std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                   std::span<Vector3<Real>> forces);

// The energy stored in all elements, J; 0 at rest and never below.
[[nodiscard]] double ComputeSolidEnergy(const Coefficients<double>& body, std::span<const Vector3d> x);

// How much the square of the highest frequency and the highest damping rate of a body's elements grow by strain, both
// at least 1: the ratio of bounds of ∂²Ψ/∂F², μ + √3 λ |Cᵀ C| + 2 λ |J − α| √(I/3), at x and at rest, and the square of
// the largest stretch, with some slack. 1 for a body without tetrahedra.
struct Stiffening {
  double squareFrequency = 1;
  double dampingRate = 1;
};
template <class Real>
[[nodiscard]] Stiffening FindStiffening(const Coefficients<Real>& body, std::span<const Vector3<Real>> x);
// The same in lanes, an element each.
template <class Real>
[[nodiscard]] Stiffening FindStiffening(const Blueprint& blueprint, std::span<const Vector3<Real>> x);

}  // namespace wobble::physics
