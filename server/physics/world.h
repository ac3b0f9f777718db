// A world: blueprints, static obstacles, bodies; one fixed tick at a time.
//
// Knows no player, packet, clock or file. Same calls in the same order give the same bits, whatever the threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "server/physics/blueprint.h"
#include "server/physics/forces.h"
#include "server/physics/obstacle.h"
#include "server/physics/state.h"

namespace wobble::physics {

enum class Precision { kSingle, kDouble };

struct WorldSettings {
  Vector3d gravity{0, 0, -9.81};   // m/s²
  double tickDuration = 1.0 / 60;  // s
  Precision precision = Precision::kSingle;
  int threads = 1;
};

// From 1, in order of creation, never reused.
using BodyId = std::uint32_t;

// What a player asks of a body, held until the next SetControl. move: in the horizontal plane, x and y, length <= 1.
struct Control {
  double moveX = 0;
  double moveY = 0;
  bool jump = false;  // acts once, when it turns true while the body touches something
  bool puff = false;
  bool stiffen = false;
};

// What the scene allows a control to do.
struct ControlLimits {
  double acceleration = 25;  // m/s²
  double speed = 6;          // of the body's centre that moving alone reaches, m/s
  double jumpSpeed = 6;      // m/s
  double puffFactor = 1.6;   // times the gas while puffed up
  double stiffenFactor = 2;  // times springs and dashpots while stiffened
};

struct Body {
  BodyId id = 0;
  std::uint8_t blueprint = 0;
  std::variant<State<float>, State<double>> state;
  Control control;
  ControlLimits limits;
  bool jumpHeld = false;
  double gasFactor = 1;  // follows the control within a few ticks
  double stiffnessFactor = 1;
};

// visit(index, position) for every vertex in the world, in double precision, m.
template <class Visit>
void VisitVertices(const Body& body, Visit&& visit) {
  std::visit(
      [&](const auto& state) {
        for (std::size_t i = 0; i < state.positions.size(); ++i) {
          visit(i, Vector3d(state.origin + state.positions[i].template cast<double>()));
        }
      },
      body.state);
}

// What one tick did. Counts of bodies but for `substeps`, their sum.
struct StepReport {
  std::uint64_t substeps = 0;
  std::uint32_t awake = 0;
  std::uint32_t nonFinite = 0;  // had a coordinate that is no number: reset to the rest shape
  std::uint32_t inverted = 0;   // closed bodies turned inside out: reset as well
};

class World {
 public:
  explicit World(const WorldSettings& settings);
  ~World();

  // Blueprints and obstacles come before the first body. At most 255 blueprints.
  std::uint8_t AddBlueprint(Blueprint blueprint);
  void AddObstacle(const Obstacle& obstacle);

  BodyId AddBody(std::uint8_t blueprint, const Vector3d& position, const Vector3d& velocity = Vector3d::Zero());
  // These four take ids that exist.
  void RemoveBody(BodyId id);
  // Rest shape at `position`, not moving.
  void PlaceBody(BodyId id, const Vector3d& position);
  void SetControl(BodyId id, const Control& control, const ControlLimits& limits);
  [[nodiscard]] const Body& ReadBody(BodyId id) const;

  StepReport Step();

  [[nodiscard]] std::uint32_t Tick() const { return m_tick; }  // steps taken
  [[nodiscard]] const WorldSettings& Settings() const { return m_settings; }
  [[nodiscard]] std::span<const Blueprint> Blueprints() const { return m_blueprints; }
  [[nodiscard]] std::span<const Obstacle> Obstacles() const { return m_obstacles; }
  [[nodiscard]] std::span<const Body> Bodies() const { return m_bodies; }  // by ascending id
  [[nodiscard]] const Blueprint& BlueprintOf(const Body& body) const { return m_blueprints[body.blueprint]; }

  [[nodiscard]] Vector3d FindCentre(const Body& body) const;

  // Of every bit of every body's state.
  [[nodiscard]] std::uint64_t Hash() const;

 private:
  struct Scratch;
  struct Threads;
  struct Outcome;

  Body& FindBody(BodyId id);
  Outcome StepBody(Body& body, Scratch& scratch) const;
  template <class Real>
  Outcome StepState(Body& body, State<Real>& state, Scratch& scratch) const;
  void StepAll(std::vector<Outcome>& outcomes);

  WorldSettings m_settings;
  std::vector<Blueprint> m_blueprints;
  std::vector<Obstacle> m_obstacles;
  std::vector<Body> m_bodies;
  std::vector<Outcome> m_outcomes;
  std::unique_ptr<Threads> m_threads;
  BodyId m_nextId = 1;
  std::uint32_t m_tick = 0;
};

}  // namespace wobble::physics
