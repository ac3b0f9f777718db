// Recomputes the forces on a body, kind by kind, with the plain force terms and in the world's precision, so that the
// kinds add up to what a step computes. An account kept by the step itself would cost as much as the forces, for every
// body and substep, while a viewer looks at one body a few times a second.
//
// These are the forces of the equations of motion. Position Verlet moves the ends of springs to their rest lengths
// instead; for a body that it steps, this shows the forces that its springs would exert.
#include "server/physics/inspect.h"

#include <algorithm>

#include "server/physics/contact/backtracking.h"
#include "server/physics/methods/bending.h"
#include "server/physics/methods/elasticity.h"
#include "server/physics/methods/recovery.h"
#include "server/physics/step/losses.h"
#include "server/physics/world_engine.h"

namespace wobble::physics {
namespace {

// A body as the last step left it.
template <class Real>
struct Subject {
  const Blueprint& blueprint;
  const Coefficients<Real>& body;
  const State<Real>& state;
  Load<Real> load;  // of the last step
  std::vector<Surface<Real>> surfaces;
};

// The forces, one a vertex, that add(forces) adds up.
template <class Real, class Add>
std::vector<Vector3d> Collect(const Subject<Real>& subject, const Add& add) {
  std::vector<Vector3<Real>> forces(subject.state.positions.size(), Vector3<Real>::Zero());
  add(std::span<Vector3<Real>>(forces));
  std::vector<Vector3d> collected;
  collected.reserve(forces.size());
  for (const Vector3<Real>& force : forces) collected.push_back(force.template cast<double>());
  return collected;
}

template <class Real>
std::vector<Vector3d> FindElastic(const Subject<Real>& subject) {
  return Collect(subject, [&](std::span<Vector3<Real>> forces) {
    const std::vector<Vector3<Real>> still(forces.size(), Vector3<Real>::Zero());
    const Coefficients<Real>& body = subject.body;
    AddSprings<Real>(body.springs, subject.load.stiffnessFactor, subject.state.positions, still, forces,
                     subject.load.torn);
    AddTetrahedra<Real>(body.tetrahedra, body.solid, subject.load.stiffnessFactor, subject.state.positions, still,
                        forces);
    AddHinges<Real>(body.hinges, body.hingeFloorSquare, subject.load.stiffnessFactor, subject.state.positions, still,
                    forces);
    if (subject.load.recovery.Act()) {
      AddRecovery<Real>(body, subject.load.recovery, subject.state.positions, still, forces);
    }
    if (!(body.repulsion > Real(0))) return;
    AddRepulsion<Real>(body.springs, body.repulsion, subject.state.positions, forces, subject.load.torn);
  });
}

// The viscous forces of tetrahedra, hinges and folded cells: what their forces are in motion less what they are at
// rest.
template <class Real>
void AddViscosity(const Subject<Real>& subject, std::span<Vector3<Real>> forces) {
  const Coefficients<Real>& body = subject.body;
  const std::vector<Vector3<Real>> still(forces.size(), Vector3<Real>::Zero());
  const State<Real>& state = subject.state;
  const Real factor = subject.load.stiffnessFactor;
  AddTetrahedra<Real>(body.tetrahedra, body.solid, factor, state.positions, state.velocities, forces);
  AddTetrahedra<Real>(body.tetrahedra, body.solid, -factor, state.positions, still, forces);
  AddHinges<Real>(body.hinges, body.hingeFloorSquare, factor, state.positions, state.velocities, forces);
  AddHinges<Real>(body.hinges, body.hingeFloorSquare, -factor, state.positions, still, forces);
  if (!(subject.load.recovery.Act())) return;
  std::vector<Vector3<Real>> elastic(forces.size(), Vector3<Real>::Zero());
  AddRecovery<Real>(body, subject.load.recovery, state.positions, state.velocities, forces);
  AddRecovery<Real>(body, subject.load.recovery, state.positions, still, elastic);
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] -= elastic[i];
}

template <class Real>
std::vector<Vector3d> FindDamping(const Subject<Real>& subject, double tick) {
  return Collect(subject, [&](std::span<Vector3<Real>> forces) {
    std::vector<Spring<Real>> dashpots = subject.body.springs;
    for (Spring<Real>& dashpot : dashpots) dashpot.stiffness = 0;
    AddSprings<Real>(dashpots, subject.load.stiffnessFactor, subject.state.positions, subject.state.velocities, forces,
                     subject.load.torn);
    AddViscosity(subject, forces);
    State<Real> slowed = subject.state;
    std::vector<Real> scratch;
    ApplyLosses<Real>(subject.blueprint, subject.surfaces, tick, scratch, slowed);
    for (std::size_t i = 0; i < forces.size(); ++i) {
      forces[i] +=
          subject.body.masses[i] / static_cast<Real>(tick) * (slowed.velocities[i] - subject.state.velocities[i]);
    }
  });
}

template <class Real>
std::vector<Vector3d> FindGas(const Subject<Real>& subject) {
  return Collect(subject, [&](std::span<Vector3<Real>> forces) {
    if (!(subject.body.gas > Real(0))) return;
    AddGas<Real>(subject.body, subject.load.gasFactor, subject.state.positions, forces);
  });
}

std::vector<Vector3d> FindWeight(const Blueprint& blueprint, const Vector3d& gravity) {
  std::vector<Vector3d> weight;
  for (const double mass : blueprint.full.masses) weight.push_back(mass * gravity);
  return weight;
}

template <class Real>
std::vector<Vector3d> FindOther(const Subject<Real>& subject, const Vector3d& gravity) {
  return Collect(subject, [&](std::span<Vector3<Real>> forces) {
    const Coefficients<Real>& body = subject.body;
    const State<Real>& state = subject.state;
    if (body.drag > Real(0)) {
      AddDrag<Real>(body.faces, body.drag, subject.load.wind, state.positions, state.velocities, forces);
    }
    for (const VertexForce<Real>& push : subject.load.pushes) {
      // The body may have lost vertices since.
      if (push.vertex < forces.size()) forces[push.vertex] += push.force;
    }
    const Vector3<Real> moving = subject.load.acceleration - gravity.template cast<Real>();
    for (std::size_t i = 0; i < forces.size(); ++i) forces[i] += body.masses[i] * moving;
  });
}

template <class Real>
Meeting<Real> Meet(const Subject<Real>& ofVertices, const Subject<Real>& ofFaces, double gap) {
  return {.x = ofVertices.state.positions,
          .v = ofVertices.state.velocities,
          .shares = ofVertices.body.contactShares,
          .skin = {.faces = ofFaces.body.faces,
                   .topology = &ofFaces.blueprint.topology,
                   .x = ofFaces.state.positions,
                   .offset = static_cast<Real>(ofVertices.blueprint.rodRadius + gap),
                   .fadingGap = static_cast<Real>(FindFadingGap(ofVertices.blueprint, ofFaces.blueprint, gap))},
          .skinV = ofFaces.state.velocities,
          .shift = (ofVertices.state.origin - ofFaces.state.origin).template cast<Real>()};
}

template <class Real>
EdgeMeeting<Real> MeetEdges(const Subject<Real>& first, const Subject<Real>& second, double gap) {
  return MakeEdgeMeeting<Real>(first.blueprint, first.state, second.blueprint, second.state, gap);
}

// Of mass, in the world, m.
template <class Real>
Vector3d FindCentre(const Subject<Real>& subject) {
  const State<Real>& state = subject.state;
  return state.origin + FindBulkMotion<Real>(subject.body.masses, state.positions, state.velocities).centre;
}

// Adds the force of the spring between the cores of both.
template <class Real>
void AddCore(const CoreContact& core, const Subject<Real>& subject, const Subject<Real>& other,
             std::span<Vector3<Real>> forces) {
  if (!core.MayAct()) return;
  const Vector3d force = FindCoreForce(core, FindCentre(subject) - FindCentre(other));
  const Vector3d acceleration = force / subject.blueprint.totalMass;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    forces[i] += (subject.blueprint.full.masses[i] * acceleration).template cast<Real>();
  }
}

// Adds the forces of both sides of a pair, of its edges and of its cores, on the subject. ofSubject: 0 or 1, its side
// of the pair.
template <class Real>
void AddBodyContacts(const BodyPair<Real>& pair, const Subject<Real>& subject, std::size_t ofSubject,
                     const Subject<Real>& other, std::span<Vector3<Real>> forces) {
  const auto add = [forces](std::uint16_t vertex, const Vector3<Real>& force) { forces[vertex] += force; };
  const ContactParameters<Real> both = ofSubject == 0 ? Combine(subject.body.contact, other.body.contact)
                                                      : Combine(other.body.contact, subject.body.contact);
  for (std::size_t side = 0; side < 2; ++side) {
    const bool ofVertices = side == ofSubject;
    std::vector<ContactForce<Real>> computed(pair.sides[side].size());
    const Meeting<Real> meeting = ofVertices ? Meet(subject, other, pair.gap) : Meet(other, subject, pair.gap);
    ComputeBodyContacts<Real>(both, meeting, pair.sides[side], computed);
    if (ofVertices) AddToVertices<Real>(computed, add);
    if (!ofVertices) AddToCorners<Real>(computed, add);
  }
  AddCore(pair.core, subject, other, forces);
  std::vector<EdgeForce<Real>> ofEdges(pair.edges.size());
  ComputeEdgeContacts<Real>(both,
                            ofSubject == 0 ? MeetEdges(subject, other, pair.gap) : MeetEdges(other, subject, pair.gap),
                            pair.edges, ofEdges);
  for (const EdgeForce<Real>& force : ofEdges) {
    if (!force.acts) continue;
    for (const std::size_t end : {0U, 1U}) add(force.vertices[2 * ofSubject + end], force.forces[2 * ofSubject + end]);
  }
}

template <class Real>
Subject<Real> MakeSubject(const World& world, const Body& body) {
  const Blueprint& blueprint = world.BlueprintOf(body);
  return {.blueprint = blueprint,
          .body = blueprint.Read<Real>(),
          .state = std::get<State<Real>>(body.state),
          .load = {},
          .surfaces = {}};
}

template <class Real>
std::vector<Vector3d> FindContacts(const World& world, const Workspace<Real>& workspace, const Body& body,
                                   const Subject<Real>& subject) {
  return Collect(subject, [&](std::span<Vector3<Real>> forces) {
    AddContacts<Real>(subject.body.contact, subject.body.contactShares, subject.surfaces, subject.state.contacts,
                      subject.state.positions, subject.state.velocities, forces);
    // The body may have lost vertices since.
    const auto isThere = [&](const NearRod& rod) { return std::max(rod.a, rod.b) < forces.size(); };
    if (std::ranges::all_of(subject.load.rods, isThere)) {
      AddRodContacts<Real>(subject.body, subject.surfaces, subject.load.rods, subject.state.positions,
                           subject.state.velocities, forces);
    }
    VisitPairsOf(body.id, workspace.pairs, [&](const BodyPair<Real>& pair) {
      const Body& other = world.ReadBody(pair.OtherThan(body.id));
      AddBodyContacts(pair, subject, pair.SideOf(body.id), MakeSubject<Real>(world, other), forces);
      if (pair.IsSelf()) AddBodyContacts(pair, subject, 1, MakeSubject<Real>(world, other), forces);
    });
  });
}

// The backtracking law holds a resting vertex by taking from its acceleration: this adds the force that does so.
template <class Real>
void HoldRestingVertices(const Subject<Real>& subject, InspectedForces& found) {
  std::vector<Vector3<Real>> held;
  for (const Vector3d& acceleration : found.accelerations) held.push_back(acceleration.cast<Real>());
  HoldResting<Real>(subject.body, subject.surfaces, subject.state.contacts, subject.state.positions, held);
  for (const Contact<Real>& contact : subject.state.contacts) {
    const std::size_t i = contact.vertex;
    const Vector3d after = held[i].template cast<double>();
    found.contact[i] += double{subject.body.masses[i]} * (after - found.accelerations[i]);
    found.accelerations[i] = after;
  }
}

std::vector<Vector3d> FindAccelerations(const Coefficients<double>& body, const InspectedForces& found) {
  std::vector<Vector3d> accelerations;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const Vector3d sum =
        found.elastic[i] + found.damping[i] + found.gas[i] + found.weight[i] + found.contact[i] + found.other[i];
    accelerations.push_back(body.inverseMasses[i] * sum);
    if (body.planar) accelerations.back().y() = 0;
  }
  return accelerations;
}

}  // namespace

InspectedForces InspectForces(const World& world, BodyId id) {
  const Body& body = world.ReadBody(id);
  const World::Engine& engine = *world.m_engine;
  const auto inspect = [&]<class Real>(const State<Real>& state) {
    const auto& workspace = std::get<Workspace<Real>>(engine.workspace);
    const auto place = static_cast<std::size_t>(&body - world.Bodies().data());
    const bool wasStepped = place < workspace.members.size() && workspace.members[place].blueprint != nullptr;
    Subject<Real> subject = MakeSubject<Real>(world, body);
    const Vector3d& gravity = wasStepped ? engine.gravity : world.Settings().gravity;
    if (wasStepped) {
      subject.load = workspace.members[place].load;
      subject.load.pushes = workspace.members[place].pushes;
      subject.load.rods = workspace.members[place].rods;
    } else {
      subject.load.acceleration = gravity.cast<Real>();
      subject.load.stiffnessFactor = static_cast<Real>(body.stiffnessFactor);
      subject.load.wind = world.Settings().wind.cast<Real>();
    }
    subject.load.torn = state.torn;
    for (const Obstacle& obstacle : world.Obstacles()) {
      subject.surfaces.push_back(MakeSurface<Real>(obstacle, state.origin, subject.blueprint.rodRadius));
    }
    InspectedForces found{.elastic = FindElastic(subject),
                          .damping = FindDamping(subject, world.Settings().tickDuration),
                          .gas = FindGas(subject),
                          .weight = FindWeight(subject.blueprint, gravity),
                          .contact = FindContacts(world, workspace, body, subject),
                          .other = FindOther(subject, gravity),
                          .accelerations = {}};
    found.accelerations = FindAccelerations(subject.blueprint.full, found);
    if (subject.body.contact.law == ContactLaw::kBacktracking) HoldRestingVertices(subject, found);
    return found;
  };
  return std::visit(inspect, body.state);
}

}  // namespace wobble::physics
