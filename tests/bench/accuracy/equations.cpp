// Springs, gas, repulsion, drag and ground straight from their formulas. The engine distributes the area of a face over
// its corners; here the gas acts along the derivative of the volume by each vertex. The two agree only if both are
// right.
#include "tests/bench/accuracy/equations.h"

#include <algorithm>
#include <cmath>

namespace wobble::bench {
namespace {

using namespace physics;
using BodyNumbers = physics::Coefficients<double>;

void AddSpringForce(const BodyNumbers& body, const Spring<double>& spring, std::span<const Vector3d> x,
                    std::span<const Vector3d> v, std::span<Vector3d> forces) {
  const Vector3d way = x[spring.a] - x[spring.b];
  const double length = std::sqrt(way.x() * way.x() + way.y() * way.y() + way.z() * way.z());
  const Vector3d along = way / length;
  const double stretching = (v[spring.a] - v[spring.b]).dot(along);
  double tension = spring.stiffness * (length - spring.restLength) + spring.damping * stretching;
  if (body.repulsion > 0) {
    tension -= body.repulsion / std::pow(std::max(length, kRepulsionFloorShare * spring.restLength), 4);
  }
  forces[spring.a] -= tension * along;
  forces[spring.b] += tension * along;
}

double FindPressure(const BodyNumbers& body, double volume) {
  const double floor = body.floorVolume;
  const double absolute = volume > floor ? body.gas / volume : body.gas * (2 * floor - volume) / (floor * floor);
  return absolute - body.ambientPressure;
}

// V = ⅙ Σ a·(b × c), ∂V/∂a = ⅙ Σ b × c; on a closed surface both are independent of the origin.
double FindVolume(const BodyNumbers& body, std::span<const Vector3d> x) {
  double volume = 0;
  for (const Face& face : body.faces) volume += (x[face[0]] - x[0]).dot((x[face[1]] - x[0]).cross(x[face[2]] - x[0]));
  return volume / 6;
}

void AddGasOfVolume(const BodyNumbers& body, std::span<const Vector3d> x, std::span<Vector3d> forces) {
  const double pressure = FindPressure(body, FindVolume(body, x));
  for (const Face& face : body.faces) {
    for (int corner = 0; corner < 3; ++corner) {
      const Vector3d next = x[face[(corner + 1) % 3]] - x[0];
      const Vector3d last = x[face[(corner + 2) % 3]] - x[0];
      forces[face[corner]] += pressure / 6 * next.cross(last);
    }
  }
}

// A = ½ Σ (xₐ z_b − x_b zₐ) over the edges a → b.
double FindArea(const BodyNumbers& body, std::span<const Vector3d> x) {
  double area = 0;
  for (const auto& [a, b] : body.outline) area += (x[a].x() * x[b].z() - x[b].x() * x[a].z()) / 2;
  return area;
}

void AddGasOfArea(const BodyNumbers& body, std::span<const Vector3d> x, std::span<Vector3d> forces) {
  const double pressure = FindPressure(body, FindArea(body, x));
  for (const auto& [a, b] : body.outline) {
    forces[a] += pressure / 2 * Vector3d(x[b].z(), 0, -x[b].x());
    forces[b] += pressure / 2 * Vector3d(-x[a].z(), 0, x[a].x());
  }
}

void AddDragOfFaces(const BodyNumbers& body, const Vector3d& wind, std::span<const Vector3d> x,
                    std::span<const Vector3d> v, std::span<Vector3d> forces) {
  for (const Face& face : body.faces) {
    const Vector3d area = (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]) / 2;
    const Vector3d normal = area.normalized();
    const double against = (wind - (v[face[0]] + v[face[1]] + v[face[2]]) / 3).dot(normal);
    for (const auto corner : face)
      forces[corner] += body.drag * area.norm() * std::fabs(against) * against / 3 * normal;
  }
}

// Normal force N = F(d) + c s(d) ḋ at depth d, never negative: F'(d) = k min(d/δ, 1); s is the cubic smoothstep from 0
// to 1 between 0 and δ.
void AddPushOfPlane(const BodyNumbers& body, const Obstacle& plane, std::span<const Vector3d> x,
                    std::span<const Vector3d> v, std::span<Vector3d> forces) {
  const ContactParameters<double>& law = body.contact;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double depth = plane.offset - x[i].dot(plane.normal);
    if (depth <= 0) continue;
    const double grown = std::min(depth, law.fadeDepth);
    const double share = grown / law.fadeDepth;
    const double spring = law.stiffness * (grown * share / 2 + depth - grown);
    const double dashpot = -law.damping * (3 - 2 * share) * share * share * v[i].dot(plane.normal);
    forces[i] += std::max(spring + dashpot, 0.0) * body.contactShares[i] * plane.normal;
  }
}

// ∫ F dd.
double FindPushEnergy(const BodyNumbers& body, const Obstacle& plane, const Vector3d& x) {
  const ContactParameters<double>& law = body.contact;
  const double depth = std::max(plane.offset - x.dot(plane.normal), 0.0);
  const double grown = std::min(depth, law.fadeDepth);
  const double beyond = depth - grown;
  return law.stiffness * (grown * grown * grown / (6 * law.fadeDepth) + beyond * (grown + beyond) / 2);
}

// ∫ K/d⁴ dd from the distance of the ends to infinity.
double FindRepulsionEnergy(const BodyNumbers& body, const Spring<double>& spring, double length) {
  const double floor = kRepulsionFloorShare * spring.restLength;
  const double outside = std::max(length, floor);
  return body.repulsion * (1 / (3 * std::pow(outside, 3)) + (outside - length) / std::pow(outside, 4));
}

// ∫ (P₀ − P) dV; below the volume floor the integrand is linear.
double FindGasEnergy(const BodyNumbers& body, double volume) {
  const double outside = std::max(volume, body.floorVolume);
  const double below = outside - volume;
  return body.ambientPressure * volume - body.gas * std::log(outside) +
         body.gas / outside * below * (1 + below / (2 * outside));
}

}  // namespace

void AddOwnForces(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v,
                  std::span<Vector3d> forces) {
  const BodyNumbers& body = equations.blueprint->full;
  for (const Spring<double>& spring : body.springs) AddSpringForce(body, spring, x, v, forces);
  if (body.gas > 0 && body.planar) AddGasOfArea(body, x, forces);
  if (body.gas > 0 && !body.planar) AddGasOfVolume(body, x, forces);
  if (body.drag > 0) AddDragOfFaces(body, equations.wind, x, v, forces);
}

void FindAccelerations(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v,
                       std::span<Vector3d> accelerations) {
  const BodyNumbers& body = equations.blueprint->full;
  std::fill(accelerations.begin(), accelerations.end(), Vector3d::Zero());
  AddOwnForces(equations, x, v, accelerations);
  for (const auto& [vertex, force] : equations.pulls) accelerations[vertex] += force;
  for (const Obstacle& plane : equations.obstacles) AddPushOfPlane(body, plane, x, v, accelerations);
  for (std::size_t i = 0; i < accelerations.size(); ++i) {
    accelerations[i] = accelerations[i] / body.masses[i] + equations.gravity;
    if (body.planar) accelerations[i].y() = 0;
  }
  for (const auto vertex : body.fixed) accelerations[vertex] = Vector3d::Zero();
}

double FindEnergy(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v) {
  const BodyNumbers& body = equations.blueprint->full;
  double energy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    energy += body.masses[i] * (v[i].squaredNorm() / 2 - equations.gravity.dot(x[i]));
  }
  for (const Spring<double>& spring : body.springs) {
    const double length = (x[spring.a] - x[spring.b]).norm();
    energy += spring.stiffness * (length - spring.restLength) * (length - spring.restLength) / 2;
    if (body.repulsion > 0) energy += FindRepulsionEnergy(body, spring, length);
  }
  if (body.gas > 0) energy += FindGasEnergy(body, body.planar ? FindArea(body, x) : FindVolume(body, x));
  for (const Obstacle& plane : equations.obstacles) {
    for (std::size_t i = 0; i < x.size(); ++i) energy += body.contactShares[i] * FindPushEnergy(body, plane, x[i]);
  }
  return energy;
}

}  // namespace wobble::bench
