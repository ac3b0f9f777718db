#include "server/physics/methods/position_verlet.h"

#include <cmath>

namespace wobble::physics {
namespace {

template <class Real>
Real FindKeptLength(const Blueprint& blueprint, const Spring<Real>& spring) {
  if (!(blueprint.full.gas > 0)) return spring.restLength;
  const Vector3d l = blueprint.rest[spring.a] - blueprint.rest[spring.b];
  return static_cast<Real>(std::sqrt(l.dot(l)));
}

}  // namespace

template <class Real>
void RelaxSprings(Real h, const SteppedBody<Real>& body, int sweeps, std::span<Vector3<Real>> x,
                  std::span<Vector3<Real>> v) {
  const Coefficients<Real>& coefficients = body.blueprint->template Read<Real>();
  const std::vector<Spring<Real>>& springs = coefficients.springs;
  const Real rate = Real(1) / h;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t s = 0; s < springs.size(); ++s) {
      const Spring<Real>& spring = springs[s];
      if (!(spring.stiffness > Real(0)) || IsTorn(body, s)) continue;
      const Vector3<Real> l = x[spring.a] - x[spring.b];
      const Real length = std::sqrt(l.dot(l));
      const Real ofA = coefficients.inverseMasses[spring.a];
      const Real ofB = coefficients.inverseMasses[spring.b];
      if (!(length > Real(0)) || !(ofA + ofB > Real(0))) continue;
      const Real stretch = length - FindKeptLength(*body.blueprint, spring);
      const Vector3<Real> correction = l * (stretch / (length * (ofA + ofB)));
      const Vector3<Real> moveA = -ofA * correction;
      const Vector3<Real> moveB = ofB * correction;
      x[spring.a] += moveA;
      x[spring.b] += moveB;
      v[spring.a] += rate * moveA;
      v[spring.b] += rate * moveB;
    }
  }
}

template void RelaxSprings<float>(float, const SteppedBody<float>&, int, std::span<Vector3<float>>,
                                  std::span<Vector3<float>>);
template void RelaxSprings<double>(double, const SteppedBody<double>&, int, std::span<Vector3<double>>,
                                   std::span<Vector3<double>>);

}  // namespace wobble::physics
