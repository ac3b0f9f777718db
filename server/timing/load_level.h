// What a server does when it has more to do than there is time, one measure after the other, and back again. Each says
// what it costs: nothing is left out in silence, and the world's step stays what it is.
#pragma once

#include <cstdint>

namespace wobble::server {

// Each comes on top of those before it.
enum class LoadLevel : std::uint8_t {
  kNormal,
  kCoarser,  // bodies are sent less exactly, those far away least
  kBusy,     // snapshots at kBusySnapshotHz, nobody new is let in
  kSlowed,   // the world goes slower, as fast as it can: at RateLimit
};
[[nodiscard]] const char* Name(LoadLevel level);

inline constexpr int kBusySnapshotHz = 20;
// Seconds of the world a second that it is never slowed below on purpose. What the machine cannot do even then is
// dropped from world time by the tick clock.
inline constexpr double kLeastRate = 0.25;

class LoadController {
 public:
  // tickDuration: s.
  explicit LoadController(double tickDuration) : m_tickDuration(tickDuration) {}

  // A tick took `duration`, s, all phases together. rate: seconds of the world a second that were asked for, above 0:
  // in slow motion a tick may take longer. now: s, as Server::Tick has it.
  void Record(double duration, double rate, double now);

  [[nodiscard]] LoadLevel Level() const { return m_level; }
  // Time that ticks take of the time that there is for them, smoothed over 0.25 s; above 1 when there is too
  // little.
  [[nodiscard]] double Share() const { return m_share; }
  // Seconds of the world a second that there is time for: kLeastRate to 1; 1 unless the world is slowed.
  [[nodiscard]] double RateLimit() const { return m_rateLimit; }

 private:
  void Judge(double now);
  void FollowRateLimit();

  double m_tickDuration;
  double m_share = 0;
  double m_shareOfFull = 0;  // the same at rate 1
  double m_last = -1;        // Record's now; -1: none yet
  LoadLevel m_level = LoadLevel::kNormal;
  double m_rateLimit = 1;
  double m_tooMuchSince = -1;  // for this level; -1: it is not
  double m_easySince = -1;
};

}  // namespace wobble::server
