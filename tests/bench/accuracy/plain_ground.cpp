// The friction law as contact.h states it: a spring from the anchor and a dashpot, tangential to the plane, limited to
// μN. Every vertex is checked against every plane at every stage: no lists, no candidates, no single precision.
#include "tests/bench/accuracy/plain_ground.h"

#include <algorithm>
#include <optional>

#include "server/physics/methods/runge_kutta.h"

namespace wobble::bench {
namespace {

using namespace physics;

class Ground {
 public:
  Ground(const Equations& equations, const State<float>& begin)
      : m_equations(equations), m_anchors(equations.obstacles.size() * equations.CountVertices()) {
    for (const Contact<float>& contact : begin.contacts) {
      if (contact.touching) AnchorOf(contact.surface, contact.vertex) = begin.origin + contact.anchor.cast<double>();
    }
  }

  void Accelerate(std::span<const Vector3d> x, std::span<const Vector3d> v, std::span<Vector3d> a) {
    FindAccelerations(m_equations, x, v, a);
    const Coefficients<double>& body = m_equations.blueprint->full;
    for (std::size_t p = 0; p < m_equations.obstacles.size(); ++p) {
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (body.inverseMasses[i] > 0) a[i] += body.contactShares[i] / body.masses[i] * FindFriction(p, i, x[i], v[i]);
      }
    }
  }

  void RenewAnchors(std::span<const Vector3d> x) {
    const ContactParameters<double>& law = m_equations.blueprint->full.contact;
    for (std::size_t p = 0; p < m_equations.obstacles.size(); ++p) {
      const Obstacle& plane = m_equations.obstacles[p];
      for (std::size_t i = 0; i < x.size(); ++i) {
        std::optional<Vector3d>& anchor = AnchorOf(p, i);
        const double depth = FindDepth(plane, x[i]);
        if (depth <= 0) {
          anchor.reset();
        } else if (!anchor) {
          anchor = x[i];
        } else {
          const Vector3d slip = AlongPlane(plane, x[i] - *anchor);
          const double most = law.friction * plane.friction * FindSpring(depth) / law.stickStiffness;
          if (slip.norm() > most) anchor = x[i] - most * slip.normalized();
        }
      }
    }
  }

 private:
  std::optional<Vector3d>& AnchorOf(std::size_t plane, std::size_t vertex) {
    return m_anchors[plane * m_equations.CountVertices() + vertex];
  }
  static double FindDepth(const Obstacle& plane, const Vector3d& x) { return plane.offset - x.dot(plane.normal); }
  static Vector3d AlongPlane(const Obstacle& plane, const Vector3d& way) {
    return way - way.dot(plane.normal) * plane.normal;
  }

  double FindSpring(double depth) const {
    const ContactParameters<double>& law = m_equations.blueprint->full.contact;
    return depth < law.fadeDepth ? law.stiffness * depth * depth / (2 * law.fadeDepth)
                                 : law.stiffness * (depth - law.fadeDepth / 2);
  }

  Vector3d FindFriction(std::size_t p, std::size_t i, const Vector3d& x, const Vector3d& v) {
    const Obstacle& plane = m_equations.obstacles[p];
    const double depth = FindDepth(plane, x);
    if (depth <= 0) return Vector3d::Zero();
    const ContactParameters<double>& law = m_equations.blueprint->full.contact;
    const double share = std::min(depth / law.fadeDepth, 1.0);
    const double dashpot = law.damping * share * share * (3 - 2 * share) * v.dot(plane.normal);
    const double limit = law.friction * plane.friction * std::max(0.0, FindSpring(depth) - dashpot);
    Vector3d pull = law.stickDamping * AlongPlane(plane, v);
    if (AnchorOf(p, i)) pull += law.stickStiffness * AlongPlane(plane, x - *AnchorOf(p, i));
    return pull.norm() > limit ? -limit * pull.normalized() : Vector3d(-pull);
  }

  const Equations& m_equations;
  // In the world, m; of all vertices on the first plane, then on the second, …
  std::vector<std::optional<Vector3d>> m_anchors;
};

}  // namespace

Motion SolveOnGround(const Equations& equations, const State<float>& begin, double duration, int steps) {
  Motion motion;
  for (const auto& x : begin.positions) motion.x.emplace_back(begin.origin + x.cast<double>());
  for (const auto& v : begin.velocities) motion.v.emplace_back(v.cast<double>());
  Ground ground(equations, begin);
  StageBuffers<double, 4> buffers;
  for (int step = 0; step < steps; ++step) {
    StepRungeKutta<double>(
        kClassicRungeKutta, duration / steps, [&](auto x, auto v, auto a) { ground.Accelerate(x, v, a); },
        std::span(motion.x), std::span(motion.v), buffers);
    ground.RenewAnchors(motion.x);
  }
  return motion;
}

}  // namespace wobble::bench
