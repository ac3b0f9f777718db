#include "server/snapshots/coarseness.h"

#include <algorithm>

#include "server/snapshots/encoder.h"

namespace wobble::server {
namespace {

// Apparent distances, m, from which on the allowed error is twice as large, and four times. A ball of 1 m, seen at an
// angle of 60° on a thousand pixels, is 50 pixels high at the first distance and 20 at the second, and an error of 1 %
// a fraction of one.
constexpr float kCoarseDistances[] = {16, 40};
constexpr std::size_t kLevelsOfDouble = 2;  // of kSnapshotErrorShares, for twice the error
// The coarsest qualities of near bodies and of others, 1 % and 2 %; distance adds to the latter, and a budget that
// starves them, because then each byte less is a sample more. Beyond 1 % a ball that one looks at looks angular.
constexpr std::size_t kCoarsestNear = 4;
constexpr std::size_t kCoarsestFar = 5;
static_assert(kSnapshotErrorShares[kCoarsestNear] == 0.01F && kSnapshotErrorShares[kCoarsestFar] == 0.02F);

// Turns in a row that are too dear before a quality falls, and that leave room before it rises. A quality costs up
// to 1.4 times the bytes of the next coarser one, of those that only far bodies get up to 1.65; these leave a margin.
constexpr int kCrowdedPatience = 3;
constexpr int kEasyPatience = 30;
constexpr double kFinerCost = 1.45;
constexpr double kFinerCostFar = 1.7;
// A budget is short that leaves out more than kFewLeft of the bodies; so few wait a turn.
constexpr double kFewLeft = 0.05;
// A budget that nearly holds all bodies: all get coarser together, far ones by kLevelsBehind more. While near ones take
// less than kSmallNearShare of it they are spared, because that would help the others little. A budget that leaves out
// kStarving of all though they are as coarse as they get is for the near ones, up to kNearShare.
constexpr double kSmallNearShare = 0.3;
constexpr std::size_t kLevelsBehind = 1;
constexpr double kStarving = 0.3;

// While the machine is short of time: the distance, m, up to which a body is sent at kCoarserNear, and beyond which at
// kCoarserFar.
constexpr float kCoarserDistance = 8;
constexpr std::size_t kCoarserNear = 2;
constexpr std::size_t kCoarserFar = 4;

}  // namespace

void Coarseness::Level::Note(bool isCrowded, bool isEasy, std::size_t most) {
  crowded = isCrowded ? crowded + 1 : 0;
  easy = isEasy ? easy + 1 : 0;
  if (crowded >= kCrowdedPatience && value < most) {
    ++value;
    crowded = 0;
  }
  if (easy >= kEasyPatience && value > 0) {
    --value;
    easy = 0;
  }
}

void Coarseness::Adapt(const Turn& turn) {
  const auto leftOut = static_cast<double>(turn.leftOut), due = static_cast<double>(turn.due);
  const bool isShort = leftOut > kFewLeft * due;
  const double factor = m_far.value > kCoarsestNear ? kFinerCostFar : kFinerCost;
  const bool fitsFiner = !isShort && factor * (turn.near + turn.far) < turn.credit;
  const bool isFarCoarsest = m_far.value >= kCoarsestFar;
  const bool isFarBehind = m_far.value >= m_near.value + kLevelsBehind;
  const bool isStarving = isFarCoarsest && leftOut > kStarving * due;
  const double share = turn.near / turn.credit;
  m_near.Note(isShort && (turn.nearLeft > 0 || (share > kSmallNearShare && isFarBehind && !isFarCoarsest)),
              fitsFiner || kFinerCost * share < (isStarving ? kNearShare : kSmallNearShare), kCoarsestNear);
  m_far.Note(isShort && (!isFarBehind || share < kSmallNearShare || m_near.value == kCoarsestNear), fitsFiner,
             isStarving ? kQualities - 1 : kCoarsestFar);
}

std::size_t Coarseness::FindQuality(bool isNear, float apparentDistance) const {
  if (isNear) return m_near.value;
  std::size_t quality = std::max(m_near.value, m_far.value);
  for (const float limit : kCoarseDistances) quality += apparentDistance > limit ? kLevelsOfDouble : 0;
  return std::min(quality, kQualities - 1);
}

std::size_t FindCoarserQuality(std::size_t quality, float distance) {
  const std::size_t least = distance > kCoarserDistance ? kCoarserFar : kCoarserNear;
  for (const std::size_t level : {kCoarserNear, kCoarserFar}) {
    if (level >= least && quality <= level) return level;
  }
  return kQualities - 1;
}

}  // namespace wobble::server
