// The face of the physics engine: a world of soft bodies, built from blueprints and static obstacles and advanced one
// fixed tick at a time.
//
// A world knows no player, packet, clock, log or file. The same calls in the same order give the same bits, whatever
// the number of threads. Units are SI unless a name says otherwise; positions and directions are in world coordinates.
// A wrong call (an id that does not exist, an argument out of range) is an assertion.
//
// world.cpp holds the bodies and what is asked of them, world_step.cpp the tick, world_topology.cpp changes of springs
// and blueprints, world_state.cpp what a world is stored as, world_twin.cpp the copy of a world in another precision.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/physics/contact/broad_phase.h"
#include "server/physics/contact/obstacle.h"
#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/shapes/recipe.h"
#include "server/physics/shapes/tear.h"
#include "server/physics/step/body.h"
#include "server/physics/step/drive.h"

namespace wobble::physics {

struct InspectedForces;
struct WorldState;
template <class Real>
struct Workspace;

enum class Precision { kSingle, kDouble };

struct WorldSettings {
  Vector3d gravity{0, 0, -9.81};   // m/s²
  double tickDuration = 1.0 / 60;  // s, > 0
  Precision precision = Precision::kSingle;
  int threads = 1;  // >= 1
  // Error of a body's positions, RMS over its vertices, that may build up in one second of motion, m/s.
  double errorTarget = 0.001;
  int maxSubsteps = 64;              // most substeps a tick that the error target may ask for; stability may take more
  int leastSubsteps = 1;             // fewest substeps a tick, any number: for the laboratory's references
  Vector3d wind = Vector3d::Zero();  // velocity of the medium that drags at faces, m/s
  // Most bodies that are stepped side by side, in the lanes of a vector; the processor sets a limit too. The result
  // does not depend on it.
  int widestPack = 16;
  double stiffnessFactor = 1;  // see World::SetStiffnessFactor
};

// Range of WorldSettings::stiffnessFactor.
inline constexpr double kLeastStiffnessFactor = 0.25;
inline constexpr double kMostStiffnessFactor = 4;

// What one tick did. Counts of bodies, unless a field says otherwise.
struct StepReport {
  std::uint64_t substeps = 0;     // substeps of the tries that were kept, summed over the bodies
  std::uint64_t allSubsteps = 0;  // the same, with the tries that were thrown away
  std::uint32_t awake = 0;        // stepped in this tick
  std::uint32_t nonFinite = 0;    // had a non-finite coordinate in one of the tries
  std::uint32_t inverted = 0;     // end the tick inside out: a closed body whose gas has no volume left
  std::uint32_t quarantined = 0;  // stepped again in more substeps: non-finite or runaway energy; or reset
  // Put back into the rest shape: no number of substeps helped, or it has been inside out for kInvertedTime.
  std::uint32_t reset = 0;
  std::uint32_t torn = 0;       // springs that tore
  BodyId firstQuarantined = 0;  // least id of the quarantined bodies; 0: none
};

// A place in the list of blueprints.
struct BlueprintSlot {
  std::uint64_t revision = 0;  // grows whenever the slot is given another blueprint
  bool isKept = false;         // set by AddBlueprint: ReplaceBlueprint never takes this slot
  double stiffnessBound = 1;   // FindStiffnessBound of the blueprint
};

// What a reader that keeps a copy of the world (captures, published blueprints) needs to bring it up to date after a
// step. Valid until the next call that changes the world.
struct WorldChanges {
  std::span<const std::uint32_t> stepped;  // places in Bodies() of all bodies that the last step moved, ascending
  std::span<const Box> boxes;              // by place in Bodies(); for stepped bodies, round the body as the step began
  std::uint64_t removals = 0;              // calls of RemoveBody; each moves the bodies behind the removed one up
  std::uint64_t restores = 0;              // calls of Restore; each may change everything
  std::uint64_t blueprintRevision = 0;     // the largest revision of all slots
  std::span<const BlueprintSlot> slots;    // one for each of Blueprints()

  // Middle of the box round the stepped body at this place, m: its position to within the body's size, without a pass
  // over its vertices.
  [[nodiscard]] Vector3d FindMiddle(std::size_t place) const { return (boxes[place].low + boxes[place].high) / 2; }
};

// A force on one vertex of a body that acts through the next step and no longer.
struct StepForce {
  BodyId body = 0;
  VertexForce<double> force;
};

class World {
 public:
  explicit World(const WorldSettings& settings);
  // A copy of `other` to go on with other settings: another precision, tick or error target. Contacts and what they
  // remember are copied as well; all bodies are awake.
  World(const World& other, const WorldSettings& settings);
  ~World();

  // Returns the number of the blueprint. All blueprints and obstacles come before the first body; at most 255
  // blueprints.
  std::uint8_t AddBlueprint(Blueprint blueprint);
  void AddObstacle(const Obstacle& obstacle);

  // position: of the centre of mass, m. velocity: of every vertex that can move, m/s.
  BodyId AddBody(std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity = Vector3d::Zero());
  // Wakes what the body touched, and drops its drives and forces. O(bodies).
  void RemoveBody(BodyId id);
  // Makes the body what AddBody made, whole again and under its own number, of this blueprint, which the scene has.
  // Drops its drives.
  void RenewBody(BodyId id, std::uint8_t blueprint, const Vector3d& position,
                 const Vector3d& velocity = Vector3d::Zero());
  // Puts the body back into its rest shape at `position`, at rest.
  void PlaceBody(BodyId id, const Vector3d& position);
  // Holds until the next call. The length of the move must be at most 1.
  void SetControl(BodyId id, const Control& control, const ControlLimits& limits);
  // Sets position, m, and velocity, m/s, of every vertex. Any numbers are taken: Step finds and resets an impossible
  // state. But fixed vertices, and velocities across a planar body's plane, are set to rest, since nothing could ever
  // stop them.
  void SetMotion(BodyId id, std::span<const Vector3d> positions, std::span<const Vector3d> velocities);
  // m/s². Wakes every sleeping body when the value changes.
  void SetGravity(const Vector3d& gravity);
  // Multiplies stiffness and damping of every spring of every body, on top of what players stiffen. From
  // kLeastStiffnessFactor to kMostStiffnessFactor; 1: as the blueprints have them. Bodies follow within a few ticks, as
  // far as substeps suffice for them (FindStiffnessBound). Position Verlet takes springs for distances, so bodies that
  // it steps do not follow. Wakes every sleeping body when the value changes.
  void SetStiffnessFactor(double factor);
  // Gives the body a blueprint of its own, in an unused slot that AddBlueprint did not make, or in a new one.
  // kept[i]: the vertex of the old blueprint that vertex i of the new one was, ascending. Kept vertices keep positions,
  // velocities, contacts, forces, drives and torn springs between them. Vertices beyond `kept` begin at rest, placed
  // beside the kept ones as in the rest shape. Returns false, and changes nothing, when all 255 slots are taken.
  bool ReplaceBlueprint(BodyId id, Blueprint blueprint, std::span<const std::uint16_t> kept);
  // Tears, for good, every whole spring of the body that crosses the blade, and the faces that it is a side of, as if
  // it had been overstretched, whether the blueprint can tear or not. Wakes the body and those that touch it. Returns
  // the number of springs; always 0 for a body with gas, which would leak.
  std::size_t CutSprings(BodyId id, const Blade& blade);
  // Adds forces on single vertices, N, finite, that act through the next Step and no longer. Several calls add up. Has
  // no effect on a fixed vertex, nor across the plane of a planar body. Wakes the body.
  void PushVertices(BodyId id, std::span<const VertexForce<double>> forces);
  // Acts on a body that exists, or on all, for as long as the body does.
  void AddDrive(const Drive& drive);

  // Advances the world by one tick.
  StepReport Step();

  [[nodiscard]] std::uint32_t Tick() const { return m_tick; }  // steps taken
  [[nodiscard]] const WorldSettings& Settings() const { return m_settings; }
  [[nodiscard]] std::span<const Blueprint> Blueprints() const { return m_blueprints; }
  [[nodiscard]] std::span<const Obstacle> Obstacles() const { return m_obstacles; }
  [[nodiscard]] std::span<const Body> Bodies() const { return m_bodies; }  // by ascending id
  [[nodiscard]] WorldChanges Changes() const;

  // The body with this id, which must exist. O(log bodies).
  [[nodiscard]] const Body& ReadBody(BodyId id) const;
  // The same for an id from outside; nullptr when there is no such body.
  [[nodiscard]] const Body* FindBody(BodyId id) const;
  [[nodiscard]] const Blueprint& BlueprintOf(const Body& body) const { return m_blueprints[body.blueprint]; }
  // Centre of mass, m. O(vertices).
  [[nodiscard]] Vector3d FindCentre(const Body& body) const;
  // Fills in the ids of the bodies that this one touched at the end of the last step, or when both fell asleep,
  // ascending. O(pairs of bodies near one another).
  void ListTouching(BodyId id, std::vector<BodyId>& touching) const;

  // A copy of all that the next ticks depend on, beside the scene and the settings. O(state); world_state.h says more.
  [[nodiscard]] WorldState Capture() const;
  // Makes the world what the state holds: the next ticks are those of the captured world, to the bit. The world has the
  // scene's obstacles and blueprints and the precision and tick duration of the captured one. Any state is safe.
  // Returns an empty text, or what the state cannot be; the world is then as it was.
  [[nodiscard]] std::string Restore(const WorldState& state);

  // Hash of every bit of every body's state.
  [[nodiscard]] std::uint64_t Hash() const;

 private:
  struct Engine;
  friend InspectedForces InspectForces(const World& world, BodyId id);

  template <class Real>
  StepReport StepIn(Workspace<Real>& work);
  [[nodiscard]] Body MakeBody(BodyId id, std::uint8_t blueprint, const Vector3d& position,
                              const Vector3d& velocity) const;
  // Drops the body's drives, its forces of the next step, and that it tears.
  void DropForcesOn(BodyId id);
  Body& Write(BodyId id);
  void WakeUp(Body& body);
  void WakeAll();
  // Of the slots whose blueprint may be replaced, the one with the oldest blueprint; the number of slots when none may.
  [[nodiscard]] std::size_t FindFreeSlot() const;
  void PutOntoSlot(Body& body, std::size_t slot, Blueprint blueprint, BlueprintRecipe recipe,
                   std::span<const std::uint16_t> kept);
  void PutIntoSlot(std::size_t slot, Blueprint blueprint, BlueprintRecipe recipe);
  // Gives bodies whose springs have torn blueprints without these springs, a few times a second.
  void RebuildTorn();
  // Wakes the bodies whose drives go on or off with this tick.
  void WakeTheDriven();
  // Drops all contact pairs of a body that is removed or placed elsewhere, and wakes the other bodies of the pairs.
  void DropPairsOf(BodyId id);
  void WakeNeighboursOf(BodyId id);
  // Renumbers the vertices that step forces and drives act on, after the body's vertices have moved to new places.
  void RenumberForces(BodyId id, std::span<const std::uint16_t> places);

  WorldSettings m_settings;
  std::vector<Blueprint> m_blueprints;
  std::vector<BlueprintSlot> m_slots;      // of m_blueprints
  std::vector<BlueprintRecipe> m_recipes;  // of m_blueprints
  std::uint64_t m_blueprintRevision = 0;
  std::vector<Obstacle> m_obstacles;
  std::vector<Body> m_bodies;
  std::vector<BodyId> m_tearing;  // bodies with tornTicks > 0, ascending
  std::vector<Drive> m_drives;
  std::vector<StepForce> m_stepForces;  // of the next step, by ascending body
  std::unique_ptr<Engine> m_engine;
  BodyId m_nextId = 1;
  std::uint64_t m_removals = 0;
  std::uint64_t m_restores = 0;
  std::uint32_t m_tick = 0;
};

}  // namespace wobble::physics
