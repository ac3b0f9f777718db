// The share of the tick's budget is smoothed over the snapshots' own rhythm (in a small world every second tick sends,
// the others do not), in wall time, so that a slowed world notices as fast as any other that the load has gone. From
// one measure to the next it takes a while, so that one that is enough is not followed by another, and each is given up
// only with room to spare, since giving it up costs again what it had saved.
//
// All that is slow together is a second and a half from the last measure to none, of which smoothing takes 0.6 s when
// the load was four times too much: within the 2 s that players are promised.
#include "server/timing/load_level.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wobble::server {
namespace {

constexpr double kSmoothing = 0.25;  // s

// By level. Above `tooMuch` for `patience`, s, the next one begins; below `easy` for kEasyPatience, the last one
// returns.
struct Limits {
  double tooMuch;
  double patience;
  double easy;
};
constexpr std::array<Limits, 4> kLimits{{{0.80, 1.0, 0}, {0.95, 0.5, 0.65}, {0.95, 0.5, 0.75}, {HUGE_VAL, 0, 0.80}}};
constexpr double kEasyPatience = 0.25;

// Of the time that there is, used by a world that is slowed: the rest is for what differs from tick to tick.
constexpr double kSlowedShare = 0.9;
// The pace follows at once when there is less time and by leaps when there is more: clients stay with a steady pace
// more easily than with one that trembles.
constexpr double kSlower = 0.99;
constexpr double kFaster = 1.1;

}  // namespace

void LoadController::Record(double duration, double rate, double now) {
  const double full = duration / m_tickDuration;
  const double weight = m_last < 0 ? 1 : 1 - std::exp(-(now - m_last) / kSmoothing);
  m_last = now;
  m_shareOfFull += weight * (full - m_shareOfFull);
  m_share = m_shareOfFull * rate;
  Judge(now);
  FollowRateLimit();
}

void LoadController::Judge(double now) {
  const Limits& limits = kLimits[static_cast<std::size_t>(m_level)];
  const auto note = [now](bool holds, double& since) { since = !holds ? -1 : since < 0 ? now : since; };
  note(m_share > limits.tooMuch, m_tooMuchSince);
  note(m_share < limits.easy, m_easySince);
  const bool isWorse = m_tooMuchSince >= 0 && now - m_tooMuchSince >= limits.patience;
  const bool isBetter = m_easySince >= 0 && now - m_easySince >= kEasyPatience;
  if (!isWorse && !isBetter) return;
  m_level = static_cast<LoadLevel>(static_cast<int>(m_level) + (isWorse ? 1 : -1));
  m_tooMuchSince = m_easySince = -1;
}

void LoadController::FollowRateLimit() {
  const double wanted = std::clamp(kSlowedShare / std::max(m_shareOfFull, kSlowedShare), kLeastRate, 1.0);
  if (m_level != LoadLevel::kSlowed) {
    m_rateLimit = 1;
  } else if (wanted < kSlower * m_rateLimit || wanted > kFaster * m_rateLimit || wanted == 1) {
    m_rateLimit = wanted;
  }
}

const char* Name(LoadLevel level) {
  switch (level) {
    case LoadLevel::kNormal:
      return "normal";
    case LoadLevel::kCoarser:
      return "coarser";
    case LoadLevel::kBusy:
      return "busy";
    case LoadLevel::kSlowed:
      return "slowed";
  }
  return "unknown";
}

}  // namespace wobble::server
