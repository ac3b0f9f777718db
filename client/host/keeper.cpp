#include "client/host/keeper.h"

#include <algorithm>
#include <cassert>

namespace wobble::host {

void Keeper::NoteStart(double now) {
  assert(m_state == State::kWaiting);
  m_state = State::kStarting;
  m_startedAt = now;
}

void Keeper::NoteReady(double now) {
  assert(m_state == State::kStarting);
  m_state = State::kRunning;
  m_readyAt = now;
  m_hasBeenReady = true;
  if (!m_isDown) return;
  m_secondsDown += DownFor(now);
  m_isDown = false;
  ++m_restarts;
}

void Keeper::NoteEnd(double now, int exitCode) {
  if (m_state != State::kStarting && m_state != State::kRunning && m_state != State::kEnding) return;
  const State before = m_state;
  if (before == State::kEnding || exitCode == 0) {
    m_state = State::kEnded;
    return;
  }
  ++m_deaths;
  if (before == State::kRunning) {
    m_isDown = true;
    m_downSince = now;
    if (now >= m_readyAt + m_rules.settled) m_wait = 0;
  }
  if (IsFinal(exitCode)) {
    m_state = State::kGivenUp;
    return;
  }
  m_wait = m_wait == 0 ? m_rules.leastWait : std::min(2 * m_wait, m_rules.mostWait);
  m_due = now + m_wait;
  m_state = State::kWaiting;
}

void Keeper::AskToEnd() {
  if (m_state == State::kWaiting) m_state = State::kEnded;
  if (m_state == State::kStarting || m_state == State::kRunning) m_state = State::kEnding;
}

double Keeper::SecondsDown(double now) const { return m_secondsDown + DownFor(now); }

}  // namespace wobble::host
