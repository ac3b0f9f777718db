// δ is the difference of two sides, each between neighbours: so single precision resolves it wherever the sheet is.
#include "server/physics/methods/bending.h"

namespace wobble::physics {
namespace {

// δ of positions, δ̇ of velocities.
template <class Real>
Vector3<Real> FindBend(const Hinge<Real>& hinge, std::span<const Vector3<Real>> y) {
  const auto& [a, b, c, d] = hinge.vertices;
  return (y[a] - y[b]) - (y[c] - y[d]);
}

}  // namespace

template <class Real>
void AddHinges(std::span<const Hinge<Real>> hinges, Real floorSquare, Real stiffnessFactor,
               std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  for (const Hinge<Real>& hinge : hinges) {
    const Vector3<Real> bend = FindBend(hinge, x);
    const Real rate = bend.dot(FindBend(hinge, v)) / (bend.dot(bend) + floorSquare);
    const Vector3<Real> pull = stiffnessFactor * (hinge.stiffness + hinge.damping * rate) * bend;
    const auto& [a, b, c, d] = hinge.vertices;
    forces[a] -= pull;
    forces[b] += pull;
    forces[c] += pull;
    forces[d] -= pull;
  }
}

double ComputeBendingEnergy(const Coefficients<double>& body, std::span<const Vector3d> x) {
  double energy = 0;
  for (const Hinge<double>& hinge : body.hinges) energy += 0.5 * hinge.stiffness * FindBend(hinge, x).squaredNorm();
  return energy;
}

#define WOBBLE_INSTANTIATE(Real)                                                                          \
  template void AddHinges<Real>(std::span<const Hinge<Real>>, Real, Real, std::span<const Vector3<Real>>, \
                                std::span<const Vector3<Real>>, std::span<Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
