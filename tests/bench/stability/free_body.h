// One body alone, stepped by one method of the engine in equal steps, in double precision: nothing of the choice of
// steps, of sleep or of rescue that a server has besides, so that a step which is too large shows what it does.
#pragma once

#include <span>
#include <vector>

#include "server/physics/methods/forces.h"
#include "server/physics/methods/integrator_step.h"

namespace wobble::bench {

class FreeBody {
 public:
  // At rest.
  FreeBody(const physics::Blueprint& blueprint, physics::Integrator integrator);

  void Step(double h) {
    physics::StepOnce<double>(blueprint.integrator, h, *this, std::span(x), std::span(v), m_scratch);
  }

  // What StepOnce asks of a system.
  void Accelerate(std::span<const physics::Vector3d> atX, std::span<const physics::Vector3d> atV,
                  std::span<physics::Vector3d> a, bool springs) const;
  [[nodiscard]] std::size_t CountBodies() const { return 1; }
  [[nodiscard]] physics::SteppedBody<double> ReadBody(std::size_t) const { return {&blueprint, &load, {}, {}, {}, 0}; }

  physics::Blueprint blueprint;
  physics::Load<double> load;
  std::vector<physics::Vector3d> x;  // m
  std::vector<physics::Vector3d> v;  // m/s

 private:
  physics::IntegratorScratch<double> m_scratch;
};

// RMS over the vertices of how far they are from where they rest, m.
[[nodiscard]] double FindDisplacement(const FreeBody& body);

}  // namespace wobble::bench
