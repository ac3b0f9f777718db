// The elements of solid bodies: tetrahedra with linear shape functions, and the material that all of a body share. The
// force law is that of methods/elasticity.h.
#pragma once

#include <array>
#include <cstdint>

namespace wobble::physics {

template <class Real>
struct Tetrahedron {
  std::array<std::uint16_t, 4> vertices{};
  // gᵢ, 1/m, of corners 1, 2, 3: with them the deformation gradient is F = Σ (xᵢ − x₀) gᵢᵀ. Corner 0 has −g₁ − g₂ − g₃.
  std::array<std::array<Real, 3>, 3> gradients{};
  Real volume = 0;  // at rest, m³
};

// Constants of the stable neo-Hookean material, from Lamé's two by MakeSolidMaterial.
template <class Real>
struct SolidMaterial {
  Real shear = 0;      // μ, Pa
  Real bulk = 0;       // λ, Pa
  Real restRatio = 1;  // α: the ratio of volumes at which the term in J alone would rest
  Real viscosity = 0;  // η, Pa·s
};

}  // namespace wobble::physics
