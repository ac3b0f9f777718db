// One step of any integration method, for a system of bodies that stand behind one another in x and v.
//
// A System offers
//   void Accelerate(x, v, a, bool springs)   fills in a, m/s²; without `springs`, from all forces but the springs'
//   std::size_t CountBodies()
//   SteppedBody<Real> ReadBody(std::size_t)  ascending in `begin`
// where x and v are spans of const and a is a span to fill. A new method is one more case in StepOnce, its limits in
// step_limits.cpp, and a name in model/integrator.h.
#pragma once

#include <span>

#include "server/physics/methods/explicit_steps.h"
#include "server/physics/methods/implicit_euler.h"
#include "server/physics/methods/position_verlet.h"
#include "server/physics/methods/runge_kutta.h"
#include "server/physics/model/integrator.h"

namespace wobble::physics {

// Scratch of StepOnce, reused from system to system.
template <class Real>
struct IntegratorScratch {
  StageBuffers<Real, 4> stages;
  ImplicitScratch<Real> implicit;

  void Reserve(std::size_t vertices) { stages.Reserve(vertices); }
};

// Calls visit(body, x, v, a), spans of that body alone, for each body of the system.
template <class Real, class System, class Visit>
void VisitBodies(const System& system, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v,
                 std::span<Vector3<Real>> a, const Visit& visit) {
  for (std::size_t i = 0; i < system.CountBodies(); ++i) {
    const SteppedBody<Real> body = system.ReadBody(i);
    const std::size_t count = body.blueprint->rest.size();
    visit(body, x.subspan(body.begin, count), v.subspan(body.begin, count), a.subspan(body.begin, count));
  }
}

template <class Real, class System>
void StepPositionVerlet(Real h, const System& system, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v,
                        IntegratorScratch<Real>& scratch) {
  StepSemiImplicitEuler<Real>(
      h, [&](auto atX, auto atV, auto a) { system.Accelerate(atX, atV, a, false); }, x, v, scratch.stages);
  VisitBodies<Real>(system, x, v, scratch.stages.accelerations[0],
                    [&](const SteppedBody<Real>& body, auto ownX, auto ownV, auto) {
                      RelaxSprings<Real>(h, body, kRelaxationSweeps, ownX, ownV);
                    });
}

template <class Real, class System>
void StepImplicitEuler(Real h, const System& system, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v,
                       IntegratorScratch<Real>& scratch) {
  scratch.stages.Resize(x.size());
  const std::span<Vector3<Real>> a(scratch.stages.accelerations[0]);
  system.Accelerate(std::span<const Vector3<Real>>(x), std::span<const Vector3<Real>>(v), a, true);
  VisitBodies<Real>(system, x, v, a, [&](const SteppedBody<Real>& body, auto ownX, auto ownV, auto ownA) {
    StepImplicitEuler<Real>(h, body, std::span<const Vector3<Real>>(ownA), ownX, ownV, scratch.implicit);
  });
}

// Steps all bodies of the system by h s with one method.
template <class Real, class System>
void StepOnce(Integrator integrator, Real h, const System& system, std::span<Vector3<Real>> x,
              std::span<Vector3<Real>> v, IntegratorScratch<Real>& scratch) {
  const auto accelerate = [&](std::span<const Vector3<Real>> atX, std::span<const Vector3<Real>> atV,
                              std::span<Vector3<Real>> a) { system.Accelerate(atX, atV, a, true); };
  switch (integrator) {
    case Integrator::kRungeKutta4:
      return StepRungeKutta<Real>(kClassicRungeKutta, h, accelerate, x, v, scratch.stages);
    case Integrator::kExplicitEuler:
      return StepExplicitEuler<Real>(h, accelerate, x, v, scratch.stages);
    case Integrator::kSemiImplicitEuler:
      return StepSemiImplicitEuler<Real>(h, accelerate, x, v, scratch.stages);
    case Integrator::kVelocityVerlet:
      return StepVelocityVerlet<Real>(h, accelerate, x, v, scratch.stages);
    case Integrator::kLeapFrog:
      return StepLeapFrog<Real>(h, accelerate, x, v, scratch.stages);
    case Integrator::kPositionVerlet:
      return StepPositionVerlet<Real>(h, system, x, v, scratch);
    case Integrator::kImplicitEuler:
      return StepImplicitEuler<Real>(h, system, x, v, scratch);
  }
}

}  // namespace wobble::physics
