// Keeps two closed bodies from passing through one another. Contacts of vertices with faces give way by about
// v √(m/k), from some 40 m/s on by more than a body's radius. The near walls have then crossed, every vertex is at a
// face that it never came in through, and nothing says any more on which side it belongs: the bodies stay tangled.
//
// A body has a core: a ball about its centre of mass within its rest shape (Blueprint::coreRadius). Where the centres
// of two bodies are nearer than R, a share of the sum of both radii, a spring pushes them apart along the line between
// them: F = K (R − distance). It accelerates all parts of a body alike, so that it bends nothing, and it keeps momentum
// and angular momentum.
//
// K is chosen as long as the centres are farther apart than R, to take up twice the energy with which the bodies come
// together then. So bodies that press slowly on one another have next to none. Bodies have none at all until their
// cores have been seen apart: they were put into one another, or one lives in the other.
#pragma once

#include "server/physics/model/vector.h"

namespace wobble::physics {

struct CoreContact {
  bool seenApart = false;  // lives on from tick to tick
  double stiffness = 0;    // K, N/m; likewise
  double range = 0;        // R, m; 0: the spring cannot act in this tick

  [[nodiscard]] bool MayAct() const { return stiffness > 0 && range > 0; }
};

// A body as a whole.
struct CoreBody {
  double mass = 0;    // kg
  double radius = 0;  // Blueprint::coreRadius, m
};

// Brings the contact up to date at the beginning of a tick. apart: from the first body's centre to the second's, m.
// velocity: of the second's against the first's, m/s. margin: by which the centres may come nearer within the tick than
// this velocity tells, m.
void UpdateCoreContact(const CoreBody& first, const CoreBody& second, const Vector3d& apart, const Vector3d& velocity,
                       double duration, double margin, CoreContact& contact);

// The force on the second body, N; the opposite acts on the first.
[[nodiscard]] Vector3d FindCoreForce(const CoreContact& contact, const Vector3d& apart);

// The energy that the spring holds, J.
[[nodiscard]] double FindCoreEnergy(const CoreContact& contact, const Vector3d& apart);

// The square of the frequency at which the bodies swing on the spring, 1/s².
[[nodiscard]] double FindSquareCoreFrequency(const CoreContact& contact, double mass, double otherMass);

}  // namespace wobble::physics
