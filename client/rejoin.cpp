// Patience is spent by time without play alone: what was played between two losses close to each other is added to the
// moment of giving up.
#include "client/rejoin.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace wobble::client {

void RejoinPlan::NotePlaying(double now) {
  assert(m_state == State::kNew || m_state == State::kTrying);
  m_state = State::kPlaying;
  m_playingSince = now;
}

void RejoinPlan::NoteEnd(double now, bool mayRejoin) {
  assert(m_state != State::kOver && m_state != State::kWaiting);
  const State before = m_state;
  m_state = State::kOver;
  if (!mayRejoin || before == State::kNew || m_options.patience <= 0) return;
  if (before == State::kPlaying) {
    const double played = now - m_playingSince;
    const bool isFirstLoss = m_wait == 0;
    if (isFirstLoss || played >= kSettled) {
      m_wait = 0;
      m_giveUpAt = now + m_options.patience;
    } else {
      m_giveUpAt += played;
    }
  }
  if (now >= m_giveUpAt) return;
  PlanTry(now);
}

void RejoinPlan::PlanTry(double now) {
  m_state = State::kWaiting;
  m_wait = m_wait == 0 ? m_options.firstWait : std::min(2 * m_wait, m_options.longestWait);
  m_due = now + m_wait * (1 - 0.5 * m_random.NextShare());
}

bool RejoinPlan::TakeDue(double now) {
  if (m_state != State::kWaiting && m_state != State::kTrying) return false;
  if (now >= m_giveUpAt) {
    m_state = State::kOver;
    return false;
  }
  if (m_state == State::kTrying || now < m_due) return false;
  m_state = State::kTrying;
  return true;
}

std::string DescribeGivingUp(const std::string& lost, const std::string& failure, const RejoinOptions& options) {
  const double tenths = std::round(10 * options.patience);
  std::string seconds = std::to_string(static_cast<std::int64_t>(tenths / 10));
  if (const int rest = static_cast<int>(std::fmod(tenths, 10)); rest != 0) seconds += "." + std::to_string(rest);
  return lost + "; gave up joining again after " + seconds + " s" + (failure.empty() ? "" : ": " + failure);
}

}  // namespace wobble::client
