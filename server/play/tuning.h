// The quantities that players tune for everybody: gravity, stiffness and the pace of time.
#pragma once

#include <string>

#include "server/physics/world.h"
#include "server/play/command.h"
#include "server/scenes/play_rules.h"
#include "server/timing/tick_clock.h"

namespace wobble::server {

// Factors on all stiffnesses. At less than 0.5, heaps are squashed so flat that the search for their contacts takes the
// time of several ticks.
inline constexpr double kMinTunedStiffness = 0.5;
inline constexpr double kMaxTunedStiffness = physics::kMostStiffnessFactor;
inline constexpr double kMaxGravity = 30;      // m/s²
inline constexpr double kLeastTimeRate = 0.1;  // world seconds per second; the most is 1
inline constexpr double kLongestJump = 10;     // world seconds
// A jump is played as fast as the machine can. Players, all together, wait so many seconds for each second of the last
// one; the host does not.
inline constexpr double kWaitPerJump = 3;

inline constexpr const char* kSpectatorsCannotTune = "spectators cannot tune";
inline constexpr const char* kMayNotTune = "you may not tune that in this scene";

// Whether the command is of the pace of time (Pace) and not of the world (Tuning).
[[nodiscard]] inline bool IsOfTime(TuneCommand::Kind kind) {
  return kind == TuneCommand::Kind::kTimeRate || kind == TuneCommand::Kind::kJump;
}

// Gravity and stiffness. They are the world's: a recording plays them again.
class Tuning {
 public:
  // gravity: of the scene, m/s².
  Tuning(const scenes::TuningRules& rules, const physics::Vector3d& gravity)
      : m_rules(rules), m_usualGravity(gravity), m_gravity(gravity) {}

  // Whether the scene lets the player tune this, which may be of time. A jump follows the rule of the time rate.
  [[nodiscard]] bool MayTune(TuneCommand::Kind kind, bool isHost) const;
  // Tunes the world. Returns an empty text, or the reason of a refusal with the range, to be shown to the player.
  // isHost: whether the player who asks owns the server. A command of time is refused.
  [[nodiscard]] std::string Tune(const TuneCommand& command, bool isHost, physics::World& world);
  // Restores the scene's values.
  void Reset(physics::World& world);
  // Takes values for those in force; the world has them.
  void Write(const physics::Vector3d& gravity, double stiffness) {
    m_gravity = gravity;
    m_stiffness = stiffness;
  }
  // Whether the scene's values are in force.
  [[nodiscard]] bool IsUsual() const { return m_gravity == m_usualGravity && m_stiffness == 1; }

  [[nodiscard]] const physics::Vector3d& Gravity() const { return m_gravity; }
  [[nodiscard]] double Stiffness() const { return m_stiffness; }

 private:
  scenes::TuningRules m_rules;
  physics::Vector3d m_usualGravity;
  physics::Vector3d m_gravity;
  double m_stiffness = 1;
};

// The pace of time: slow motion and jumps. They change when ticks are played, not what is in them.
class Pace {
 public:
  // As Tuning::Tune, for commands of time; whether the player may was asked of Tuning::MayTune. now: s.
  [[nodiscard]] std::string Tune(const TuneCommand& command, bool isHost, double now, TickClock& clock);

 private:
  double m_nextJump = 0;  // of players, s
};

}  // namespace wobble::server
