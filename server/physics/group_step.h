// One tick of a group of bodies that touch; a body alone is a group of one.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/body_contact.h"
#include "server/physics/forces.h"
#include "server/physics/integrator_step.h"
#include "server/physics/state.h"

namespace wobble::physics {

// A body of the group, and what stays constant for it through the tick.
template <class Real>
struct Member {
  const Blueprint* blueprint = nullptr;
  State<Real>* state = nullptr;
  Load<Real> load;
  std::vector<Surface<Real>> surfaces;
  Bounds<Real> bounds;
};

// Two members near one another. sides[0]: vertices of the first against faces of the second; sides[1] the reverse.
template <class Real>
struct Encounter {
  std::array<std::uint32_t, 2> members{};
  ContactParameters<Real> parameters;
  std::array<std::vector<BodyContact<Real>>*, 2> sides{};
};

template <class Real>
struct GroupScratch {
  IntegratorScratch<Real> integrator;
  std::vector<Vector3<Real>> positions;
  std::vector<Vector3<Real>> velocities;
  std::vector<Vector3<Real>> positionsBefore;  // the substep, where a member's contact law asks for them
  std::vector<Vector3<Real>> velocitiesBefore;
  std::vector<std::size_t> begins;
  std::vector<VertexLoad> loads;  // of every vertex of the group

  // For the largest group there can be, so that one that grows allocates nothing.
  void Reserve(std::size_t vertices, std::size_t bodies) {
    integrator.Reserve(vertices);
    positions.reserve(vertices);
    velocities.reserve(vertices);
    positionsBefore.reserve(vertices);
    velocitiesBefore.reserve(vertices);
    loads.reserve(vertices);
    begins.reserve(bodies + 1);
  }
};

// One side of an encounter between bodies at x and v.
template <class Real>
[[nodiscard]] Meeting<Real> MakeMeeting(const Member<Real>& ofVertices, std::span<const Vector3<Real>> x,
                                        std::span<const Vector3<Real>> v, const Member<Real>& ofFaces,
                                        std::span<const Vector3<Real>> shellX, std::span<const Vector3<Real>> shellV);

// Steps all members through `duration` s in equal substeps and returns their number, the most that any of them needs.
// encounters: between these members only, by their index in `members`.
template <class Real>
int StepGroup(std::span<Member<Real>* const> members, std::span<const Encounter<Real>> encounters, double duration,
              GroupScratch<Real>& scratch);

}  // namespace wobble::physics
