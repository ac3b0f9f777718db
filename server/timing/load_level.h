// Decides what a server gives up when its ticks take longer than there is time for them: one measure after the other,
// and back again. Each measure is published (log, metrics, snapshots), and none changes the world's step.
#pragma once

#include <cstdint>

namespace wobble::server {

// Each level adds its measure to those before it. Transitions go one level up or down: up after the load has been above
// the level's limit for 0.5 to 1 s, down after it has been below a lower limit for 0.25 s (load_level.cpp).
enum class LoadLevel : std::uint8_t {
  kNormal,
  kCoarser,  // bodies are sent less exactly, distant ones least
  kBusy,     // snapshots at kBusySnapshotHz, no client is let in
  kSlowed,   // world time is slowed to what the machine can do, RateLimit
};
[[nodiscard]] const char* Name(LoadLevel level);

inline constexpr int kBusySnapshotHz = 20;
// The lowest pace to which the world is slowed, world seconds per second. A machine that cannot do even that drops
// ticks (TickClock).
inline constexpr double kLeastRate = 0.25;

class LoadController {
 public:
  // tickDuration: s.
  explicit LoadController(double tickDuration) : m_tickDuration(tickDuration) {}

  // Takes the time that a tick took in all phases, s, and adapts level and rate limit. rate: the pace that players
  // asked for, world seconds per second, above 0; in slow motion a tick may take longer. now: s.
  void Record(double duration, double rate, double now);

  [[nodiscard]] LoadLevel Level() const { return m_level; }
  // The time that ticks take as a share of the time there is for them, smoothed over 0.25 s; above 1: too long.
  [[nodiscard]] double Share() const { return m_share; }
  // The pace that there is time for, world seconds per second: kLeastRate to 1; 1 below LoadLevel::kSlowed.
  [[nodiscard]] double RateLimit() const { return m_rateLimit; }

 private:
  void Judge(double now);
  void FollowRateLimit();

  double m_tickDuration;
  double m_share = 0;
  double m_shareOfFull = 0;  // the share at rate 1
  double m_last = -1;        // s, of the last Record; -1: none yet
  LoadLevel m_level = LoadLevel::kNormal;
  double m_rateLimit = 1;
  double m_tooMuchSince = -1;  // since when the share is above the level's upper limit, s; -1: it is not
  double m_easySince = -1;     // since when it is below the lower limit
};

}  // namespace wobble::server
