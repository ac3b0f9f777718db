// Between ticks only K lives on. Within a tick it is constant, so the force has a potential.
#include "server/physics/skins/core_contact.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

// R over the sum of both radii. Bodies in play seldom come so near.
constexpr double kRangeShare = 0.4;
// The energy that the spring can take up over the one that is to be taken up: so the centres come to half of R at
// least.
constexpr double kEnergyShare = 4;

double FindReducedMass(double mass, double otherMass) { return mass * otherMass / (mass + otherMass); }

double FindLength(const Vector3d& vector) { return std::sqrt(vector.dot(vector)); }

}  // namespace

void UpdateCoreContact(const CoreBody& first, const CoreBody& second, const Vector3d& apart, const Vector3d& velocity,
                       double duration, double margin, CoreContact& contact) {
  const double radii = first.radius + second.radius;
  const double range = kRangeShare * radii;
  const double distance = FindLength(apart);
  const double approach = distance > 0 ? std::max(0.0, -velocity.dot(apart) / distance) : 0;
  contact.seenApart = contact.seenApart || distance >= radii;
  if (contact.seenApart && distance >= range) {
    contact.stiffness = kEnergyShare * FindReducedMass(first.mass, second.mass) * approach * approach / (range * range);
  }
  contact.range = distance < range + approach * duration + margin ? range : 0;
}

Vector3d FindCoreForce(const CoreContact& contact, const Vector3d& apart) {
  const double distance = FindLength(apart);
  if (!(distance < contact.range) || !(distance > 0)) return Vector3d::Zero();
  return contact.stiffness * (contact.range - distance) / distance * apart;
}

double FindCoreEnergy(const CoreContact& contact, const Vector3d& apart) {
  const double depth = std::max(0.0, contact.range - FindLength(apart));
  return contact.stiffness * depth * depth / 2;
}

double FindSquareCoreFrequency(const CoreContact& contact, double mass, double otherMass) {
  return contact.MayAct() ? contact.stiffness / FindReducedMass(mass, otherMass) : 0;
}

}  // namespace wobble::physics
