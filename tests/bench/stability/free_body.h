// One body stepped by one method of the engine in equal steps, in double precision. The step choice, sleep and rescue
// of a server are left out, so that the effect of too large a step is visible.
#pragma once

#include <span>
#include <vector>

#include "server/physics/methods/forces.h"
#include "server/physics/methods/integrator_step.h"

namespace wobble::bench {

class FreeBody {
 public:
  // Starts at rest.
  FreeBody(const physics::Blueprint& blueprint, physics::Integrator integrator);

  void Step(double h) {
    physics::StepOnce<double>(blueprint.integrator, h, *this, std::span(x), std::span(v), m_scratch);
  }

  // The interface that StepOnce requires of a system.
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

// RMS over the vertices of the distance from their rest positions, m.
[[nodiscard]] double FindDisplacement(const FreeBody& body);

}  // namespace wobble::bench
