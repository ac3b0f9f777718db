// A world: blueprints, static obstacles, bodies; one fixed tick at a time.
//
// Knows no player, packet, clock or file. Same calls in the same order give the same bits, whatever the threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/physics/contact/obstacle.h"
#include "server/physics/inspect.h"
#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/shapes/tear.h"
#include "server/physics/step/body.h"
#include "server/physics/step/drive.h"

namespace wobble::physics {

enum class Precision { kSingle, kDouble };

struct WorldSettings {
  Vector3d gravity{0, 0, -9.81};   // m/s²
  double tickDuration = 1.0 / 60;  // s
  Precision precision = Precision::kSingle;
  int threads = 1;
  // Of each body, RMS over its vertices, that may build up in a second of motion, m/s.
  double errorTarget = 0.001;
  int maxSubsteps = 64;              // that the error target may ask for; stability takes what it needs
  Vector3d wind = Vector3d::Zero();  // of the medium that drags at faces, m/s
  // At most so many bodies are stepped side by side, in the lanes of a vector; the processor sets a limit too. The
  // result does not depend on it.
  int widestPack = 16;
  double stiffnessFactor = 1;  // SetStiffnessFactor
};

inline constexpr double kLeastStiffnessFactor = 0.25;
inline constexpr double kMostStiffnessFactor = 4;

// What one tick did. Counts of bodies but for substeps, sums over them.
struct StepReport {
  std::uint64_t substeps = 0;     // that the tick was played in
  std::uint64_t allSubsteps = 0;  // with those that were stepped again
  std::uint32_t awake = 0;
  std::uint32_t nonFinite = 0;    // had a coordinate that is no number in one of the tries
  std::uint32_t inverted = 0;     // closed bodies turned inside out, as well
  std::uint32_t quarantined = 0;  // these, and those whose energy ran away: stepped again in more substeps
  std::uint32_t reset = 0;        // of these: no number of substeps has helped, back in the rest shape
  std::uint32_t torn = 0;         // springs
  BodyId firstQuarantined = 0;    // the least id of these; 0: none was
};

class World {
 public:
  explicit World(const WorldSettings& settings);
  // Everything as it stands in `other`, contacts and what they remember as well, but all awake, to go on by other
  // settings: another precision, tick or error target.
  World(const World& other, const WorldSettings& settings);
  ~World();

  // Blueprints and obstacles come before the first body. At most 255 blueprints.
  std::uint8_t AddBlueprint(Blueprint blueprint);
  void AddObstacle(const Obstacle& obstacle);

  BodyId AddBody(std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity = Vector3d::Zero());
  // These take ids that exist.
  void RemoveBody(BodyId id);
  // Rest shape at `position`, not moving.
  void PlaceBody(BodyId id, const Vector3d& position);
  void SetControl(BodyId id, const Control& control, const ControlLimits& limits);
  // Puts every vertex where and as fast as is said, in the world. Any numbers are taken: what cannot be is for Step to
  // find. But nothing could ever stop a fixed vertex, or motion across a planar body's plane: these stay at rest.
  void SetMotion(BodyId id, std::span<const Vector3d> positions, std::span<const Vector3d> velocities);
  // Wakes everything that sleeps: down is elsewhere now.
  void SetGravity(const Vector3d& gravity);
  // Times the stiffness and damping of every spring of every body, on top of what players stiffen, from
  // kLeastStiffnessFactor to kMostStiffnessFactor; 1: as blueprints have them. Bodies follow within a few ticks, as far
  // as substeps suffice for them (FindStiffnessBound); what is stepped by position Verlet, which takes springs for
  // distances, not at all. Wakes everything that sleeps.
  void SetStiffnessFactor(double factor);
  // Puts the body onto a blueprint of its own, in a slot that no body uses any more, but none of AddBlueprint's, or in
  // a new one. kept: which vertex each of the new blueprint's first ones has been, ascending; without it, as many as
  // there are stay what they were. These keep their places, velocities and contacts; what pushes or drives them
  // follows, and so does what has torn between them. Further ones come where the rest shape has them beside these, at
  // rest. False, and nothing done, when all 255 slots are taken.
  bool ReplaceBlueprint(BodyId id, Blueprint blueprint);
  bool ReplaceBlueprint(BodyId id, Blueprint blueprint, std::span<const std::uint16_t> kept);
  // Tears every whole spring of the body that crosses the blade, in the world, for good, and with it the faces that it
  // is a side of, as if it had been overstretched, whether the blueprint can tear or not. Wakes the body and those that
  // touch it. Returns how many; always 0 for a body with gas, which would leak.
  std::size_t CutSprings(BodyId id, const Blade& blade);
  // Forces on single vertices, N, finite, that act through the next Step and no longer, beside all others. Several
  // calls add up. A fixed vertex feels nothing of it, a planar body only what lies in its plane. Wakes the body.
  void PushVertices(BodyId id, std::span<const VertexForce<double>> forces);
  [[nodiscard]] const Body& ReadBody(BodyId id) const;
  // nullptr when there is none of this number: somebody else's, which need not exist.
  [[nodiscard]] const Body* FindBody(BodyId id) const;

  // Of a body that exists, or of all; for as long as it does.
  void AddDrive(const Drive& drive);

  StepReport Step();

  [[nodiscard]] std::uint32_t Tick() const { return m_tick; }  // steps taken
  [[nodiscard]] const WorldSettings& Settings() const { return m_settings; }
  [[nodiscard]] std::span<const Blueprint> Blueprints() const { return m_blueprints; }
  // Grow whenever a slot, or this one, is given another blueprint.
  [[nodiscard]] std::uint64_t BlueprintRevision() const { return m_blueprintRevision; }
  [[nodiscard]] std::uint64_t SlotRevision(std::uint8_t slot) const { return m_slots[slot].revision; }
  [[nodiscard]] std::span<const Obstacle> Obstacles() const { return m_obstacles; }
  [[nodiscard]] std::span<const Body> Bodies() const { return m_bodies; }  // by ascending id
  // Places in Bodies() of those that the last step has stepped, ascending: nobody else has moved in it.
  [[nodiscard]] std::span<const std::uint32_t> Stepped() const;
  // Of the box round the body at this place that the last step began with, m: where it is, within a body's size.
  [[nodiscard]] Vector3d FindMiddle(std::size_t place) const;
  // Grows whenever a body is removed, and those behind it move up.
  [[nodiscard]] std::uint64_t CountRemovals() const { return m_removals; }
  [[nodiscard]] const Blueprint& BlueprintOf(const Body& body) const { return m_blueprints[body.blueprint]; }

  [[nodiscard]] Vector3d FindCentre(const Body& body) const;
  // Fills in which bodies this one touched at the end of the last step, or as both fell asleep, ascending. Takes a look
  // at every pair of bodies near one another.
  void ListTouching(BodyId id, std::vector<BodyId>& touching) const;
  // As the body stands after the last step, under what was asked of it in that step; before its first step under
  // gravity and the world's wind alone.
  [[nodiscard]] InspectedForces InspectForces(BodyId id) const;

  // Of every bit of every body's state.
  [[nodiscard]] std::uint64_t Hash() const;

 private:
  struct Engine;
  template <class Real>
  class Stepper;

  struct Slot {
    std::uint64_t revision = 0;
    bool isKept = false;        // AddBlueprint's
    double stiffnessBound = 1;  // FindStiffnessBound
  };
  struct Push {
    BodyId body = 0;
    VertexForce<double> force;
  };

  Body& Write(BodyId id);
  [[nodiscard]] StiffnessRule FindStiffnessRule(const Body& body) const;
  void WakeUp(Body& body);
  // Of those that may be given another blueprint, the one that has had its own for longest, or one more than there are.
  [[nodiscard]] std::size_t FindFreeSlot() const;
  void PutOntoSlot(Body& body, std::size_t slot, Blueprint blueprint, std::span<const std::uint16_t> kept);
  // Those of the next step.
  [[nodiscard]] std::span<const Push> PushesOn(BodyId id) const;
  // Gives bodies whose springs have torn blueprints without them, a few times a second.
  void RebuildTorn();
  void WakeTheDriven();
  // Forgets whom it touched, for one that is gone or elsewhere, and wakes them.
  void DropPairsOf(BodyId id);
  void WakeNeighboursOf(BodyId id);
  // Pushes and drives on its vertices go to these new places.
  void FollowPushes(BodyId id, std::span<const std::uint16_t> places);

  WorldSettings m_settings;
  std::vector<Blueprint> m_blueprints;
  std::vector<Slot> m_slots;  // of m_blueprints
  std::uint64_t m_blueprintRevision = 0;
  std::vector<Obstacle> m_obstacles;
  std::vector<Body> m_bodies;
  std::vector<BodyId> m_tearing;  // those with tornTicks, ascending
  std::vector<Drive> m_drives;
  std::vector<Push> m_pushes;  // of the next step, by ascending body
  std::unique_ptr<Engine> m_engine;
  BodyId m_nextId = 1;
  std::uint64_t m_removals = 0;
  std::uint32_t m_tick = 0;
};

}  // namespace wobble::physics
