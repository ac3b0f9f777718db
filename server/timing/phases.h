// Where a tick's time goes: the five stages that Server::Tick is made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>

namespace wobble::server {

enum class Phase : std::uint8_t { kReceive, kStep, kCapture, kEncode, kSend };
inline constexpr std::size_t kPhaseCount = 5;
[[nodiscard]] constexpr const char* Name(Phase phase) {
  constexpr const char* kNames[kPhaseCount] = {"receive", "step", "capture", "encode", "send"};
  return kNames[static_cast<std::size_t>(phase)];
}

// Seconds, as a clock that never goes backwards has them. Read only to tell how long something took: what the world
// does hangs on the time that Server::Tick is told alone, and on nothing that is measured but for the load
// (load_level.h).
using TimeSource = std::function<double()>;

// Of one tick, s.
struct PhaseTimes {
  double begin = 0;  // as the clock had it
  std::array<double, kPhaseCount> phases{};

  [[nodiscard]] double Of(Phase phase) const { return phases[static_cast<std::size_t>(phase)]; }
  [[nodiscard]] double Sum() const { return std::accumulate(phases.begin(), phases.end(), 0.0); }
};

// All time between Begin and End goes to one phase or another. Capturing and encoding are called from within sending,
// so phases alternate many times a tick.
class PhaseWatch {
 public:
  explicit PhaseWatch(TimeSource clock) : m_clock(std::move(clock)) {}

  void Begin(Phase phase) {
    m_phase = phase;
    m_last = Read();
    m_times.begin = m_last;
  }
  // From now on time goes to this phase; returns the one before.
  Phase Enter(Phase phase) {
    End();
    return std::exchange(m_phase, phase);
  }
  void End() {
    const double now = Read();
    m_times.phases[static_cast<std::size_t>(m_phase)] += now - std::exchange(m_last, now);
  }
  // What has been measured since the last call.
  PhaseTimes Take() {
    End();
    return std::exchange(m_times, {m_last, {}});
  }

 private:
  [[nodiscard]] double Read() const { return m_clock ? m_clock() : 0; }

  TimeSource m_clock;
  Phase m_phase = Phase::kReceive;
  double m_last = 0;
  PhaseTimes m_times;
};

}  // namespace wobble::server
