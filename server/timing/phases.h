// The room server/timing tells when ticks are due, how long they take, and what to give up when they take too long.
// This file measures the five phases of a tick.
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

// A clock that never goes backwards, s. It only measures durations: the world depends on the time that Server::Tick is
// given, and on measured time only through the load level (load_level.h).
using TimeSource = std::function<double()>;

// How long each phase of one tick took.
struct PhaseTimes {
  double begin = 0;                          // of the tick, s of the clock
  std::array<double, kPhaseCount> phases{};  // s

  [[nodiscard]] double Of(Phase phase) const { return phases[static_cast<std::size_t>(phase)]; }
  [[nodiscard]] double Sum() const { return std::accumulate(phases.begin(), phases.end(), 0.0); }
};

// Adds all time between Begin and End to one phase or another. SnapshotBudget has bodies captured and encoded as it
// takes them, so phases alternate many times within a tick.
class PhaseWatch {
 public:
  // clock: may be empty; then no time passes.
  explicit PhaseWatch(TimeSource clock) : m_clock(std::move(clock)) {}

  [[nodiscard]] bool HasClock() const { return m_clock != nullptr; }

  // Starts to measure. Time since the last End belongs to no phase.
  void Begin(Phase phase) {
    m_phase = phase;
    m_last = Read();
    m_times.begin = m_last;
  }
  // Adds the time since the last call to the present phase and changes to another; returns the one before.
  Phase Enter(Phase phase) {
    End();
    return std::exchange(m_phase, phase);
  }
  // Adds the time since the last call to the present phase.
  void End() {
    const double now = Read();
    m_times.phases[static_cast<std::size_t>(m_phase)] += now - std::exchange(m_last, now);
  }
  // Returns the times measured since the last call, or since Begin, and starts the next tick's.
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
