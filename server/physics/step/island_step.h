// One tick of a island of bodies that touch, in plain code: the reference for batch_step.h, and what steps those that
// it cannot. A body alone is a island of one.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/contact/body_contact.h"
#include "server/physics/methods/forces.h"
#include "server/physics/methods/health.h"
#include "server/physics/methods/integrator_step.h"
#include "server/physics/methods/stability.h"
#include "server/physics/model/parallel.h"
#include "server/physics/model/state.h"
#include "server/physics/model/survey.h"
#include "server/physics/step/island_contacts.h"

namespace wobble::physics {

// What a tick has to keep to.
struct StepRules {
  double duration = 1.0 / 60;    // s
  double allowedError = 1.7e-5;  // of one tick, RMS over a body's vertices, m
  int maxSubsteps = 64;          // of a tick that nothing went wrong in
};

// A body of the island, and what stays constant for it through the tick.
template <class Real>
struct Member {
  const Blueprint* blueprint = nullptr;
  State<Real>* state = nullptr;
  Load<Real> load;
  std::vector<VertexForce<Real>> pushes;  // the load's
  std::vector<Surface<Real>> surfaces;
  Survey<Real> survey;       // as the tick began; of a sleeper as it fell asleep
  SurfaceDemands demands;    // of its listed contacts
  int substepsForError = 1;  // that its last ticks ask for
  // What the tick did:
  double error = 0;               // as it is estimated, RMS over vertices, m
  bool insideOut = false;         // at its end: no volume is left to its gas
  BulkMotion after;               // at its end
  double speed = 0;               // then, RMS by mass, m/s
  double acceleration = 0;        // mean through it, RMS over vertices, m/s²; of a fast body, nobody asks: infinite
  Health health = Health::kGood;  // the worst that any try found
  bool lost = false;              // no try has helped: the state is not to be used
};

// Two members near one another. sides[0]: vertices of the first against faces of the second; sides[1] the reverse.
template <class Real>
struct ContactPair {
  std::array<std::uint32_t, 2> members{};
  ContactParameters<Real> parameters;
  std::array<std::vector<BodyContact<Real>>*, 2> sides{};
};

template <class Real>
struct IslandScratch {
  IntegratorScratch<Real> integrator;
  std::vector<Vector3<Real>> positions;
  std::vector<Vector3<Real>> velocities;
  std::vector<Vector3<Real>> positionsBefore;  // the substep, where a member's contact law asks for them
  std::vector<Vector3<Real>> velocitiesBefore;
  std::vector<std::size_t> begins;
  IslandContacts<Real> islandContacts;
  std::vector<Motion<Real>> motions;  // of each member
  // Contacts as the tick found them, one list behind the other, for a tick that is stepped again.
  std::vector<Contact<Real>> contacts;
  std::vector<std::size_t> contactBegins;  // of each member's
  std::vector<BodyContact<Real>> bodyContacts;
  std::vector<Vector3d> places;  // of one body

  // For the largest island there can be, so that one that grows allocates nothing.
  void Reserve(std::size_t vertices, std::size_t bodies) {
    integrator.Reserve(vertices);
    positions.reserve(vertices);
    velocities.reserve(vertices);
    positionsBefore.reserve(vertices);
    velocitiesBefore.reserve(vertices);
    contacts.reserve(vertices);
    bodyContacts.reserve(vertices);
    places.reserve(vertices);
    begins.reserve(bodies + 1);
    contactBegins.reserve(bodies);
    islandContacts.Reserve(vertices, bodies);
    motions.reserve(bodies);
  }
};

// One side of an contact pair between bodies at x and v, or where their own states have them.
template <class Real>
[[nodiscard]] Meeting<Real> MakeMeeting(const Member<Real>& ofVertices, std::span<const Vector3<Real>> x,
                                        std::span<const Vector3<Real>> v, const Member<Real>& ofFaces,
                                        std::span<const Vector3<Real>> shellX, std::span<const Vector3<Real>> shellV);
template <class Real>
[[nodiscard]] Meeting<Real> MakeMeeting(const Member<Real>& ofVertices, const Member<Real>& ofFaces) {
  return MakeMeeting<Real>(ofVertices, ofVertices.state->positions, ofVertices.state->velocities, ofFaces,
                           ofFaces.state->positions, ofFaces.state->velocities);
}

struct IslandOutcome {
  int substeps = 0;     // that the tick was played in, equal for all members
  int allSubsteps = 0;  // with those of the tries that were thrown away
};

// Steps all members through a tick in equal substeps, the first try in as many as are given. A tick that missed its
// error by far is stepped again in more; one that left a member in a state that cannot be is stepped again in 2, 4, 8
// and 16 times as many, and what is bad still after that is `lost`. contact pairs: between these members only, by their
// index in `members`. threads: works on several members at a time; null: one after the other. The result does not
// depend on it.
template <class Real>
IslandOutcome StepIsland(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
                         int substeps, const StepRules& rules, Threads* threads, IslandScratch<Real>& scratch);

}  // namespace wobble::physics
