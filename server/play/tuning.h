// What players tune for everybody: gravity, stiffness, the pace of time.
#pragma once

#include <string>

#include "server/physics/world.h"
#include "server/play/command.h"
#include "server/scenes/play_rules.h"
#include "server/timing/tick_clock.h"

namespace wobble::server {

// Softer by more, heaps are squashed so flat that looking for their contacts takes several ticks' time.
inline constexpr double kMinTunedStiffness = 0.5;  // times
inline constexpr double kMaxTunedStiffness = physics::kMostStiffnessFactor;
inline constexpr double kMaxGravity = 30;      // m/s²
inline constexpr double kLeastTimeRate = 0.1;  // seconds of the world a second
inline constexpr double kLongestJump = 10;     // s

class Tuning {
 public:
  Tuning(const scenes::TuningRules& rules, const physics::Vector3d& gravity)
      : m_rules(rules), m_usualGravity(gravity), m_gravity(gravity) {}

  [[nodiscard]] bool MayTune(TuneCommand::Kind kind, bool isHost) const;
  // Does it; or says why not, for people. isHost: whoever asks is.
  [[nodiscard]] std::string Tune(const TuneCommand& command, bool isHost, physics::World& world, TickClock& clock);
  // As the scene has it. False when it was so already.
  bool Reset(physics::World& world, TickClock& clock);

  [[nodiscard]] const physics::Vector3d& Gravity() const { return m_gravity; }
  [[nodiscard]] double Stiffness() const { return m_stiffness; }

 private:
  scenes::TuningRules m_rules;
  physics::Vector3d m_usualGravity;
  physics::Vector3d m_gravity;
  double m_stiffness = 1;
};

}  // namespace wobble::server
