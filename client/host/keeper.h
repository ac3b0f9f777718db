// When a program that is to run is started, and when it is started again after it died. Only decides; knows no process.
#pragma once

#include <cstdint>

namespace wobble::host {

// Seconds.
struct KeeperRules {
  double leastWait = 0.25;    // from a death to the next start; doubled with each death that follows
  double mostWait = 30;       // however often it has died
  double settled = 10;        // after it was ready for so long, the next death counts as a first one
  double startPatience = 60;  // for a start that does not become ready: a large scene trains its bases for a while
};

// The exit codes with which a program says that no other start will do: bad options, and what a shell and Child::Start
// say of a program that cannot be executed.
[[nodiscard]] constexpr bool IsFinal(int exitCode) { return exitCode == 2 || exitCode == 126 || exitCode == 127; }

// kWaiting:  NoteStart leads to kStarting, AskToEnd to kEnded.
// kStarting: NoteReady leads to kRunning; else as kRunning.
// kRunning:  NoteEnd leads to kWaiting, with exit code 0 to kEnded, with a final one to kGivenUp; AskToEnd to kEnding.
// kEnding:   NoteEnd leads to kEnded.
// kGivenUp and kEnded are the last ones.
//
// A world whose match is over, and a program that an operator sends SIGTERM, end with exit code 0: that is no death.
class Keeper {
 public:
  enum class State : std::uint8_t { kWaiting, kStarting, kRunning, kGivenUp, kEnding, kEnded };

  explicit Keeper(const KeeperRules& rules = {}) : m_rules(rules) {}

  [[nodiscard]] State ReadState() const { return m_state; }
  // now: seconds, never backwards, as in all of these. In kWaiting: whether it is to be started.
  [[nodiscard]] bool IsDue(double now) const { return m_state == State::kWaiting && now >= m_due; }
  // In kStarting: whether it has had its time and is to be killed.
  [[nodiscard]] bool IsLate(double now) const {
    return m_state == State::kStarting && now >= m_startedAt + m_rules.startPatience;
  }

  // In kWaiting.
  void NoteStart(double now);
  // In kStarting; afterwards it runs.
  void NoteReady(double now);
  // Of a process; afterwards kWaiting, kGivenUp or kEnded. Without effect in states that have no process.
  void NoteEnd(double now, int exitCode);
  // It is not to run any more.
  void AskToEnd();

  // Whether it has ever been ready.
  [[nodiscard]] bool HasBeenReady() const { return m_hasBeenReady; }
  // How often it was ready again after a death.
  [[nodiscard]] unsigned Restarts() const { return m_restarts; }
  // How often it died.
  [[nodiscard]] unsigned Deaths() const { return m_deaths; }
  // Seconds from now to the next start; 0: it is due.
  [[nodiscard]] double WaitLeft(double now) const { return m_due > now ? m_due - now : 0; }
  // Seconds since it died, while it was ready before and is not again; else 0.
  [[nodiscard]] double DownFor(double now) const { return m_isDown ? now - m_downSince : 0; }
  // Seconds from deaths to when it was ready again, in all, that which is under way included.
  [[nodiscard]] double SecondsDown(double now) const;

 private:
  KeeperRules m_rules;
  State m_state = State::kWaiting;
  double m_wait = 0;  // the last one, seconds; 0: it is settled
  double m_due = 0;   // of the next start
  double m_startedAt = 0;
  double m_readyAt = 0;
  double m_downSince = 0;  // while m_isDown
  double m_secondsDown = 0;
  unsigned m_restarts = 0;
  unsigned m_deaths = 0;
  bool m_isDown = false;  // it was ready, died, and is not ready again
  bool m_hasBeenReady = false;
};

}  // namespace wobble::host
