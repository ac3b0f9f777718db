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

class Tuning {
 public:
  // gravity: of the scene, m/s².
  Tuning(const scenes::TuningRules& rules, const physics::Vector3d& gravity)
      : m_rules(rules), m_usualGravity(gravity), m_gravity(gravity) {}

  // Whether the scene lets the player tune this. A jump follows the rule of the time rate.
  [[nodiscard]] bool MayTune(TuneCommand::Kind kind, bool isHost) const;
  // Tunes world or clock. Returns an empty text, or the reason of a refusal with the range, to be shown to the player.
  // isHost: whether the player who asks owns the server. now: s.
  [[nodiscard]] std::string Tune(const TuneCommand& command, bool isHost, double now, physics::World& world,
                                 TickClock& clock);
  // Restores the scene's values. Returns false when they were in force already.
  bool Reset(physics::World& world, TickClock& clock);

  [[nodiscard]] const physics::Vector3d& Gravity() const { return m_gravity; }
  [[nodiscard]] double Stiffness() const { return m_stiffness; }

 private:
  scenes::TuningRules m_rules;
  physics::Vector3d m_usualGravity;
  physics::Vector3d m_gravity;
  double m_stiffness = 1;
  double m_nextJump = 0;  // of players, s
};

}  // namespace wobble::server
