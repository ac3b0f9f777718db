// The share of the tick's budget is smoothed over the rhythm of snapshots (in a small world every second tick sends,
// the others do not). It is smoothed in wall time, so that a slowed world notices as fast as any other that the load is
// gone. A level lasts a while before the next one begins, so that a measure that suffices is not followed by another. A
// level is left only with room to spare, because leaving it brings back the load that it saved.
//
// From the last level back to none it takes about 1.5 s, of which smoothing takes 0.6 s after a fourfold load: within
// the 2 s that players are promised.
#include "server/timing/load_level.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace wobble::server {
namespace {

constexpr double kSmoothing = 0.25;  // s

// By level: above the share `tooMuch` for `patience` seconds the next level begins; below `easy` for kEasyPatience
// seconds the level before returns.
struct Limits {
  double tooMuch;
  double patience;
  double easy;
};
constexpr std::array<Limits, 4> kLimits{{{0.80, 1.0, 0}, {0.95, 0.5, 0.65}, {0.95, 0.5, 0.75}, {HUGE_VAL, 0, 0.80}}};
constexpr double kEasyPatience = 0.25;

// The share of the available time that a slowed world uses; the rest absorbs differences between ticks.
constexpr double kSlowedShare = 0.9;
// The pace falls at once when there is less time and rises in steps of 10 % when there is more: clients follow a steady
// pace more easily than one that fluctuates.
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
