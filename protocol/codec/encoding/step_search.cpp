// The numbers are those at which records were shortest on recorded play: with 0.06 and 0.15 squared steps a bit they
// were 1 % longer.
#include "protocol/codec/encoding/step_search.h"

#include <algorithm>
#include <cmath>

namespace wobble::protocol {
namespace {

constexpr float kLeastBitWorth = 0.07F;
constexpr float kMostBitWorth = 0.17F;
// Relative growth of the error when the worth of a bit grows by one squared step.
constexpr double kErrorGrowth = 2;
// Share of the error allowed that must be used; with less, another try is worth its time. The remainder is spent on
// making zeros of ones.
constexpr double kEnough = 0.93;
constexpr int kTries = 4;

}  // namespace

StepSearch::Verdict StepSearch::Judge(double error, Choice& choice) {
  m_keeps = false;
  if (m_descends) {
    if (error <= m_budget || choice.head.stepIndex == 0) return Verdict::kTaken;
    --choice.head.stepIndex;
    return Verdict::kAgain;
  }
  if (error <= m_budget && error > kEnough * m_budget) {
    m_left = m_budget - error;
    return Verdict::kTaken;
  }
  if (error <= m_budget && error > m_bestError) {
    m_best = choice;
    m_bestError = error;
    m_keeps = true;
  }
  if (FindNext(error, choice) && ++m_tries < kTries) return Verdict::kAgain;
  if (m_bestError >= 0) {
    choice = m_best;
    m_left = m_budget - m_bestError;
    return Verdict::kBest;
  }
  choice.bitWorth = kBitWorth;
  m_descends = true;
  return Verdict::kAgain;
}

bool StepSearch::FindNext(double error, Choice& choice) const {
  const double ratio = m_budget / std::max(error, 1e-9 * m_budget);
  const float worth = choice.bitWorth + static_cast<float>((0.995 * ratio - 1) / kErrorGrowth);
  if (worth >= kLeastBitWorth && worth <= kMostBitWorth) {
    choice.bitWorth = worth;
    return true;
  }
  // The error grows somewhat slower than the square of the step.
  const int way = static_cast<int>(std::lround(5 * std::log2(ratio)));
  const int next = static_cast<int>(choice.head.stepIndex) + (ratio < 1 ? std::min(way, -1) : std::max(way, 1));
  if (next < 0 || next >= static_cast<int>(kSteps)) return false;
  choice.head.stepIndex = static_cast<unsigned>(next);
  choice.bitWorth = kBitWorth;
  return true;
}

}  // namespace wobble::protocol
