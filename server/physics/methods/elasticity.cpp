// Columns of matrices are vectors, and every sum is written out: no order of a sum is left to a library.
#include "server/physics/methods/elasticity.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/physics/kernels/kernels.h"

namespace wobble::physics {
namespace {

template <class Real>
using MatrixColumns = std::array<Vector3<Real>, 3>;

// Σ (yᵢ − y₀) gᵢᵀ: F of positions, Ḟ of velocities.
template <class Real>
MatrixColumns<Real> FindGradient(const Tetrahedron<Real>& element, std::span<const Vector3<Real>> y) {
  const auto& [i, j, k, l] = element.vertices;
  const Vector3<Real> first = y[j] - y[i];
  const Vector3<Real> second = y[k] - y[i];
  const Vector3<Real> third = y[l] - y[i];
  const auto& g = element.gradients;
  MatrixColumns<Real> columns;
  for (std::size_t c = 0; c < 3; ++c) columns[c] = g[0][c] * first + g[1][c] * second + g[2][c] * third;
  return columns;
}

template <class Real>
MatrixColumns<Real> FindCofactors(const MatrixColumns<Real>& f) {
  return {f[1].cross(f[2]), f[2].cross(f[0]), f[0].cross(f[1])};
}

template <class Real>
Real FindSquare(const MatrixColumns<Real>& f) {  // I of F
  return f[0].dot(f[0]) + f[1].dot(f[1]) + f[2].dot(f[2]);
}

template <class Real>
MatrixColumns<Real> FindElasticStress(const SolidMaterial<Real>& material, const MatrixColumns<Real>& f) {
  const MatrixColumns<Real> cofactors = FindCofactors(f);
  const Real ofShape = material.shear * (Real(1) - Real(1) / (FindSquare(f) + Real(1)));
  const Real ofVolume = material.bulk * (f[0].dot(cofactors[0]) - material.restRatio);
  MatrixColumns<Real> stress;
  for (std::size_t c = 0; c < 3; ++c) stress[c] = ofShape * f[c] + ofVolume * cofactors[c];
  return stress;
}

// Adds 2 η F Ė, whose column c is η Σ_d F_d (F_d·Ḟ_c + F_c·Ḟ_d).
template <class Real>
void AddViscousStress(Real viscosity, const MatrixColumns<Real>& f, const MatrixColumns<Real>& rates,
                      MatrixColumns<Real>& stress) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t d = 0; d < 3; ++d) {
      stress[c] += viscosity * (f[d].dot(rates[c]) + f[c].dot(rates[d])) * f[d];
    }
  }
}

// √3 times Frobenius' norm of Cᵀ C: 3 for C = 1, at least |C|², and nearer to what one long direction alone makes
// stiff.
template <class Real>
Real BoundSquare(const MatrixColumns<Real>& c) {
  const Real along[] = {c[0].dot(c[0]), c[1].dot(c[1]), c[2].dot(c[2])};
  const Real across[] = {c[0].dot(c[1]), c[1].dot(c[2]), c[2].dot(c[0])};
  const Real squares = along[0] * along[0] + along[1] * along[1] + along[2] * along[2];
  const Real products = across[0] * across[0] + across[1] * across[1] + across[2] * across[2];
  return std::sqrt(Real(3) * (squares + Real(2) * products));
}

template <class Real>
Real BoundStiffness(const SolidMaterial<Real>& material, const MatrixColumns<Real>& f) {
  const MatrixColumns<Real> cofactors = FindCofactors(f);
  const Real ofVolume = std::fabs(f[0].dot(cofactors[0]) - material.restRatio);
  return material.shear +
         material.bulk * (BoundSquare(cofactors) + Real(2) * ofVolume * std::sqrt(FindSquare(f) / Real(3)));
}

// A bound of the square of the largest stretch, which is the largest eigenvalue of FᵀF: of all that have this sum and
// this sum of squares (Samuelson's inequality). Exact where the two other stretches are equal. Rejected: I − 2, which
// is below it where the others are squeezed; a ball drawn out to 4.5 times its length became infinite by that.
template <class Real>
Real BoundSquareStretch(const MatrixColumns<Real>& f) {
  const Real sum = FindSquare(f);
  const Real bound = BoundSquare(f);
  return (sum + std::sqrt(std::max(Real(0), Real(2) * (bound * bound - sum * sum)))) / Real(3);
}

// Neither bound is as tight for a strained element as for one at rest, hence kLooseness, by the tests that compare them
// with rates. Of the viscous term, 2 η Ė:Ė <= 2 η λ² Ḟ:Ḟ with λ the largest stretch, because at rest only the symmetric
// part of Ḟ counts: the ball above grew by 23.2 at λ² = 20.3.
double FindGrowth(double ratio) {
  constexpr double kLooseness = 1.3;
  return 1 + kLooseness * std::max(0.0, ratio - 1);
}

}  // namespace

SolidMaterial<double> MakeSolidMaterial(double youngModulus, double poissonRatio, double viscosity) {
  const double shear = youngModulus / (2 * (1 + poissonRatio));  // Lamé's
  const double bulk = 2 * shear * poissonRatio / (1 - 2 * poissonRatio);
  SolidMaterial<double> material;
  material.shear = 4.0 / 3 * shear;
  material.bulk = bulk + 5.0 / 6 * shear;
  material.restRatio = 1 + 0.75 * material.shear / material.bulk;
  material.viscosity = viscosity;
  return material;
}

// The gᵢ are the rows of the inverse of (x₁ − x₀, x₂ − x₀, x₃ − x₀).
Tetrahedron<double> MakeTetrahedron(const std::array<std::uint16_t, 4>& vertices, std::span<const Vector3d> rest) {
  const Vector3d& origin = rest[vertices[0]];
  const Vector3d a = rest[vertices[1]] - origin;
  const Vector3d b = rest[vertices[2]] - origin;
  const Vector3d c = rest[vertices[3]] - origin;
  const double sixVolume = a.dot(b.cross(c));
  assert(sixVolume > 0);
  Tetrahedron<double> element{.vertices = vertices, .volume = sixVolume / 6};
  const Vector3d rows[] = {b.cross(c), c.cross(a), a.cross(b)};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      element.gradients[i][axis] = rows[i][static_cast<int>(axis)] / sixVolume;
    }
  }
  return element;
}

template <class Real>
void AddTetrahedra(std::span<const Tetrahedron<Real>> tetrahedra, const SolidMaterial<Real>& material,
                   Real stiffnessFactor, std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                   std::span<Vector3<Real>> forces) {
  for (const Tetrahedron<Real>& element : tetrahedra) {
    const MatrixColumns<Real> f = FindGradient(element, x);
    MatrixColumns<Real> stress = FindElasticStress(material, f);
    if (material.viscosity > Real(0)) AddViscousStress(material.viscosity, f, FindGradient(element, v), stress);
    const Real scale = stiffnessFactor * element.volume;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& g = element.gradients[i];
      const Vector3<Real> pull = scale * (g[0] * stress[0] + g[1] * stress[1] + g[2] * stress[2]);
      forces[element.vertices[i + 1]] -= pull;
      forces[element.vertices[0]] += pull;
    }
  }
}

double ComputeSolidEnergy(const Coefficients<double>& body, std::span<const Vector3d> x) {
  const SolidMaterial<double>& material = body.solid;
  const double atRest = (1 - material.restRatio) * (1 - material.restRatio);
  double energy = 0;
  for (const Tetrahedron<double>& element : body.tetrahedra) {
    const MatrixColumns<double> f = FindGradient(element, x);
    const double square = FindSquare(f);
    const double beyond = f[0].dot(f[1].cross(f[2])) - material.restRatio;
    energy += element.volume / 2 *
              (material.shear * (square - 3 - std::log((square + 1) / 4)) + material.bulk * (beyond * beyond - atRest));
  }
  return energy;
}

template <class Real>
Stiffening FindStiffening(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  if (body.tetrahedra.empty()) return {};
  const MatrixColumns<Real> rest{Vector3<Real>::UnitX(), Vector3<Real>::UnitY(), Vector3<Real>::UnitZ()};
  const Real atRest = BoundStiffness(body.solid, rest);
  Real stiffest = atRest;
  Real longest = 1;
  for (const Tetrahedron<Real>& element : body.tetrahedra) {
    const MatrixColumns<Real> f = FindGradient(element, x);
    stiffest = std::max(stiffest, BoundStiffness(body.solid, f));
    longest = std::max(longest, BoundSquareStretch(f));
  }
  return {.squareFrequency = FindGrowth(double{stiffest} / double{atRest}), .dampingRate = FindGrowth(double{longest})};
}

template <class Real>
Stiffening FindStiffening(const Blueprint& blueprint, std::span<const Vector3<Real>> x) {
  const Coefficients<Real>& body = blueprint.Read<Real>();
  if (body.tetrahedra.empty()) return {};
  const ElementStrain<Real> strain = FindElementStrain(blueprint.ReadPlan<Real>().Tables(), x.data()->data());
  const MatrixColumns<Real> rest{Vector3<Real>::UnitX(), Vector3<Real>::UnitY(), Vector3<Real>::UnitZ()};
  const double atRest = double{BoundStiffness(body.solid, rest)} / double{body.solid.shear};
  return {.squareFrequency = FindGrowth(double{strain.stiffness} / atRest),
          .dampingRate = FindGrowth(double{strain.squareStretch})};
}

#define WOBBLE_INSTANTIATE(Real)                                                                          \
  template void AddTetrahedra<Real>(std::span<const Tetrahedron<Real>>, const SolidMaterial<Real>&, Real, \
                                    std::span<const Vector3<Real>>, std::span<const Vector3<Real>>,       \
                                    std::span<Vector3<Real>>);                                            \
  template Stiffening FindStiffening<Real>(const Coefficients<Real>&, std::span<const Vector3<Real>>);    \
  template Stiffening FindStiffening<Real>(const Blueprint&, std::span<const Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
