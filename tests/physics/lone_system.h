// One body alone, stepped by one method: what the tests of the integration methods measure.
#pragma once

#include <span>
#include <vector>

#include "server/physics/methods/integrator_step.h"
#include "server/physics/shapes/finish_blueprint.h"

namespace wobble::physics {

template <class Real>
struct LoneSystem {
  LoneSystem(const Blueprint& made, Integrator chosen) : blueprint(made) { SetIntegrator(blueprint, chosen); }

  void Accelerate(std::span<const Vector3<Real>> atX, std::span<const Vector3<Real>> atV, std::span<Vector3<Real>> a,
                  bool springs) const {
    Load<Real> own = load;
    if (!springs) own.stiffnessFactor = 0;
    ComputeAccelerations<Real>(blueprint.Read<Real>(), own, surfaces, contacts, atX, atV, a);
  }
  [[nodiscard]] std::size_t CountBodies() const { return 1; }
  [[nodiscard]] SteppedBody<Real> ReadBody(std::size_t) const {
    return {&blueprint, &load, surfaces, contacts, torn, 0};
  }

  void Start(const std::vector<Vector3d>& positions, const std::vector<Vector3d>& velocities) {
    x.clear();
    v.clear();
    for (const Vector3d& p : positions) x.push_back(p.cast<Real>());
    for (const Vector3d& p : velocities) v.push_back(p.cast<Real>());
  }
  void Run(int steps, double h) {
    for (int i = 0; i < steps; ++i) {
      StepOnce<Real>(blueprint.integrator, static_cast<Real>(h), *this, std::span(x), std::span(v), scratch);
    }
  }
  [[nodiscard]] Vector3d FindMomentum() const {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < v.size(); ++i) sum += blueprint.full.masses[i] * v[i].template cast<double>();
    return sum;
  }

  Blueprint blueprint;
  Load<Real> load;
  std::vector<Surface<Real>> surfaces;
  std::vector<Contact<Real>> contacts;
  std::vector<std::uint8_t> torn;
  std::vector<Vector3<Real>> x;
  std::vector<Vector3<Real>> v;
  IntegratorScratch<Real> scratch;
};

// Two masses of 2 kg on a spring of 1 m along x. Their distance swings as x'' = −w² x − g x'.
inline Blueprint MakeOscillator(double omega, double damping) {
  Blueprint pair;
  pair.rest = {Vector3d(0, 0, 0), Vector3d(1, 0, 0)};
  pair.full.masses = {2, 2};
  pair.full.springs = {{0, 1, 1.0, omega * omega, damping}};
  FinishBlueprint(pair);
  return pair;
}

}  // namespace wobble::physics
