// The bodies of a step as all steps see them, in plain code and in lanes: what is constant for a body through a tick,
// what the tick finds out about it, and pairs of bodies that may touch.
//
// Stands apart from the steps so that contacts, packs and sleep need not include them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/edges/edge_contact.h"
#include "server/physics/edges/self_contact.h"
#include "server/physics/methods/forces.h"
#include "server/physics/methods/health.h"
#include "server/physics/methods/stability.h"
#include "server/physics/model/state.h"
#include "server/physics/model/survey.h"
#include "server/physics/skins/body_contact.h"
#include "server/physics/skins/core_contact.h"
#include "server/physics/skins/skin_gap.h"
#include "server/physics/skins/untangling.h"

namespace wobble::physics {

// Limits that hold for every tick of a world.
struct StepRules {
  double duration = 1.0 / 60;    // of a tick, s
  double allowedError = 1.7e-5;  // of one tick, RMS over a body's vertices, m
  // Most substeps that the error may ask for. Stability may ask for more, and so may a tick that is stepped again
  // because a body came out of it in an impossible state.
  int maxSubsteps = 64;
  int leastSubsteps = 1;  // of the first try
};

// A body in a step. The pointers and spans refer to the world's data, which must outlive the tick.
template <class Real>
struct Member {
  // Read by the step:
  const Blueprint* blueprint = nullptr;
  State<Real>* state = nullptr;  // read when the tick begins, written when it ends; contacts also in between
  Load<Real> load;
  std::vector<VertexForce<Real>> pushes;  // storage of load.pushes
  std::vector<NearRod> rods;              // storage of load.rods
  std::vector<Surface<Real>> surfaces;    // the world's obstacles, in coordinates relative to state->origin
  Survey<Real> survey;                    // at the begin of the tick; of a sleeping body when it fell asleep
  SurfaceDemands demands;                 // of the listed contacts with surfaces
  int substepsForError = 1;               // that the errors of the last ticks ask for
  bool hasLostShape = false;              // as the tick begins (methods/recovery.h)
  // Written by the step:
  double error = 0;               // estimated, of the last try, RMS over vertices, m
  bool insideOut = false;         // at the end of the last try: a closed body with gas encloses no volume
  BulkMotion after;               // at the end of the last try
  double speed = 0;               // at the end of the tick, RMS by mass, m/s
  Health health = Health::kGood;  // the worst of all tries
  bool lost = false;              // every try failed: the state must not be used
};

// What preparing a member overwrites; it only saves allocations.
template <class Real>
struct PrepareScratch {
  std::vector<Contact<Real>> contacts;
  std::vector<ContactRates> rates;
  std::vector<Real> gradient;
};

// Two members near one another, by their places in the step's list of members. sides[0] are contacts of vertices of the
// first with faces of the second, sides[1] those of vertices of the second with faces of the first. The lists and
// the core contact belong to the world and live on from tick to tick.
template <class Real>
struct ContactPair {
  std::array<std::uint32_t, 2> members{};
  ContactParameters<Real> parameters;
  double gap = 0;  // at which the skins begin to push, m
  std::array<std::vector<BodyContact<Real>>*, 2> sides{};
  std::vector<EdgeContact<Real>>* edges = nullptr;  // of the first's edges with the second's; null: none
  CoreContact* core = nullptr;                      // null: none
  Tangle* tangle = nullptr;                         // null: none
};

// From the centre of the first member to that of the second as the tick began, and as the last try ended it, m.
template <class Real>
[[nodiscard]] Vector3d FindApart(const Member<Real>& first, const Member<Real>& second) {
  return second.state->origin - first.state->origin + second.survey.bulk.centre - first.survey.bulk.centre;
}
template <class Real>
[[nodiscard]] Vector3d FindApartAfter(const Member<Real>& first, const Member<Real>& second) {
  return second.state->origin - first.state->origin + second.after.centre - first.after.centre;
}

// One side of a contact pair, for positions x, m, and velocities v, m/s, of the body with the vertices, and skinX and
// skinV of the body with the faces, each in its body's local coordinates. gap: of the pair, m.
template <class Real>
[[nodiscard]] Meeting<Real> MakeMeeting(const Member<Real>& ofVertices, const VectorView<Real>& x,
                                        const VectorView<Real>& v, const Member<Real>& ofFaces,
                                        const VectorView<Real>& skinX, const VectorView<Real>& skinV, double gap) {
  const Vector3d shift = ofVertices.state->origin - ofFaces.state->origin;
  return {.x = x,
          .v = v,
          .shares = ofVertices.blueprint->template Read<Real>().contactShares,
          .skin = {.faces = ofFaces.blueprint->template Read<Real>().faces,
                   .topology = &ofFaces.blueprint->topology,
                   .x = skinX,
                   .offset = static_cast<Real>(ofVertices.blueprint->rodRadius + gap),
                   .fadingGap = static_cast<Real>(FindFadingGap(*ofVertices.blueprint, *ofFaces.blueprint, gap))},
          .skinV = skinV,
          .shift = shift.cast<Real>()};
}

// The edges of a body at positions x, m, and velocities v, m/s, in its own local coordinates.
template <class Real>
[[nodiscard]] typename EdgeMeeting<Real>::Body FindEdges(const Blueprint& blueprint, const Blueprint& other,
                                                         const VectorView<Real>& x, const VectorView<Real>& v) {
  typename EdgeMeeting<Real>::Body body{.edges = FindMeetingEdges(blueprint, other),
                                        .x = x,
                                        .v = v,
                                        .shares = blueprint.template Read<Real>().contactShares};
  if (!MeetByRods(blueprint, other)) body.wings = blueprint.sharpWings;
  return body;
}

// The edges of two bodies with positions and velocities as their states have them; of one body with itself if both are
// the same.
template <class Real>
[[nodiscard]] EdgeMeeting<Real> MakeEdgeMeeting(const Blueprint& first, const State<Real>& state,
                                                const Blueprint& second, const State<Real>& secondState, double gap) {
  if (&state == &secondState) return MakeSelfMeeting<Real>(first, state.positions, state.velocities);
  return {.first = FindEdges<Real>(first, second, state.positions, state.velocities),
          .second = FindEdges<Real>(second, first, secondState.positions, secondState.velocities),
          .shift = (state.origin - secondState.origin).template cast<Real>(),
          .radius = static_cast<Real>(MeetByRods(first, second) ? first.edgeRadius + second.edgeRadius : gap)};
}
template <class Real>
[[nodiscard]] EdgeMeeting<Real> MakeEdgeMeeting(const Member<Real>& first, const Member<Real>& second, double gap) {
  return MakeEdgeMeeting<Real>(*first.blueprint, *first.state, *second.blueprint, *second.state, gap);
}

// The same at other positions, m, and velocities, m/s, each in its body's local coordinates.
template <class Real>
[[nodiscard]] EdgeMeeting<Real> MakeEdgeMeeting(const Member<Real>& first, const VectorView<Real>& x,
                                                const VectorView<Real>& v, const Member<Real>& second,
                                                const VectorView<Real>& secondX, const VectorView<Real>& secondV,
                                                double gap) {
  EdgeMeeting<Real> meeting = MakeEdgeMeeting(first, second, gap);
  meeting.first.x = x;
  meeting.first.v = v;
  meeting.second.x = secondX;
  meeting.second.v = secondV;
  return meeting;
}

// MakeMeeting with positions and velocities as the bodies' states have them.
template <class Real>
[[nodiscard]] Meeting<Real> MakeMeeting(const Member<Real>& ofVertices, const Member<Real>& ofFaces, double gap) {
  return MakeMeeting<Real>(ofVertices, ofVertices.state->positions, ofVertices.state->velocities, ofFaces,
                           ofFaces.state->positions, ofFaces.state->velocities, gap);
}

}  // namespace wobble::physics
