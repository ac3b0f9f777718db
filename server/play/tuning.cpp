// Ranges are checked here and not in session.cpp, because a player who passes one is to be told the range.
#include "server/play/tuning.h"

#include <spdlog/fmt/fmt.h>

namespace wobble::server {
namespace {

using TuneKind = TuneCommand::Kind;
using physics::Vector3d;

std::string CheckRange(const char* what, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return "";
  return fmt::format("{} {:g}{}: must be {:g} to {:g}{}", what, value, unit, low, high, unit);
}

}  // namespace

bool Tuning::MayTune(TuneKind kind, bool isHost) const {
  const scenes::Who who = kind == TuneKind::kGravity     ? m_rules.gravity
                          : kind == TuneKind::kStiffness ? m_rules.stiffness
                                                         : m_rules.time;
  return who == scenes::Who::kEveryone || (who == scenes::Who::kHost && isHost);
}

std::string Tuning::Tune(const TuneCommand& command, bool isHost, physics::World& world) {
  if (IsOfTime(command.kind) || !MayTune(command.kind, isHost)) return kMayNotTune;
  std::string error;
  if (command.kind == TuneKind::kGravity) {
    error = CheckRange("gravity", command.value.norm(), 0, kMaxGravity, " m/s²");
    if (error.empty()) world.SetGravity(m_gravity = command.value);
  } else {
    error = CheckRange("stiffness", command.value.x(), kMinTunedStiffness, kMaxTunedStiffness, " times");
    if (error.empty()) world.SetStiffnessFactor(m_stiffness = command.value.x());
  }
  return error;
}

void Tuning::Reset(physics::World& world) {
  world.SetGravity(m_gravity = m_usualGravity);
  world.SetStiffnessFactor(m_stiffness = 1);
}

std::string Pace::Tune(const TuneCommand& command, bool isHost, double now, TickClock& clock) {
  const double value = command.value.x();
  std::string error;
  if (command.kind == TuneKind::kTimeRate) {
    error = CheckRange("pace of time", value, kLeastTimeRate, 1, " s a second");
    if (error.empty()) clock.SetRate(value);
    return error;
  }
  error = CheckRange("jump in time", value, 0, kLongestJump, " s");
  if (error.empty() && !isHost && now < m_nextJump) {
    error = fmt::format("the next jump in time is possible in {:.0f} s", m_nextJump - now);
  }
  if (!error.empty()) return error;
  m_nextJump = now + kWaitPerJump * value;
  clock.Jump(value);
  return error;
}

}  // namespace wobble::server
