// More than half of those who are in now decide, so who leaves takes the voice along: nobody votes twice by coming
// back.
#include "server/vote.h"

#include <algorithm>

namespace wobble::server {

void Vote::Enter(Stage stage, double now) {
  m_stage = stage;
  m_since = now;
}

double Vote::SecondsLeft(double now) const {
  switch (m_stage) {
    case Stage::kIdle:
      break;
    case Stage::kOpen:
      return m_since + kVoteSeconds - now;
    case Stage::kResting:
      return m_since + kVotePause - now;
  }
  return 0;
}

Vote::Voice Vote::Cast(ClientId client, double now) {
  if (m_stage == Stage::kResting && SecondsLeft(now) <= 0) Enter(Stage::kIdle, now);
  if (m_stage == Stage::kResting) return Voice::kTooEarly;
  if (m_stage == Stage::kIdle) {
    m_voices.clear();
    Enter(Stage::kOpen, now);
  }
  if (std::ranges::find(m_voices, client) != m_voices.end()) return Voice::kRepeated;
  m_voices.push_back(client);
  return Voice::kTaken;
}

Vote::Outcome Vote::Follow(std::span<const ClientId> entitled, double now) {
  if (m_stage != Stage::kOpen) return Outcome::kNone;
  std::erase_if(m_voices, [&](ClientId voice) { return std::ranges::find(entitled, voice) == entitled.end(); });
  if (m_voices.size() >= FindMajority(entitled.size())) {
    Enter(Stage::kResting, now);
    return Outcome::kPassed;
  }
  if (!m_voices.empty() && SecondsLeft(now) > 0) return Outcome::kNone;
  Enter(Stage::kIdle, now);
  return Outcome::kFailed;
}

}  // namespace wobble::server
