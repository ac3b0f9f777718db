// For each coefficient the encoder chooses among the nearest value, the next smaller one and 0: the one with the least
// error plus the worth of its bits. A trellis over contexts was not worth its time, nor were values reconstructed
// nearer to zero.
#include "protocol/codec/encoding/rounding.h"

#include <algorithm>
#include <cmath>

#include "protocol/codec/shape_layout.h"

namespace wobble::protocol {
namespace {

Costs MakeCosts() {
  Costs costs{};
  for (std::size_t context = 0; context < kContexts; ++context) {
    for (std::size_t i = 0; i < kMagnitudes; ++i) {
      const double share = static_cast<double>(FindFrequencies(context)[i].size) / kFrequencyTotal;
      costs[context][i] = static_cast<float>(FindLowBits(context) - std::log2(share));
    }
  }
  return costs;
}

const Costs kCosts = MakeCosts();

// The cost of a coefficient of this magnitude, in bits, its sign included.
float FindCost(std::size_t context, std::uint32_t magnitude) {
  const std::uint32_t high = magnitude >> FindLowBits(context);
  const float sign = magnitude > 0 ? 1.0F : 0.0F;
  if (high < kEscapeMagnitude) return kCosts[context][high] + sign;
  const int length = std::bit_width(high - kEscapeMagnitude + 1) - 1;
  return kCosts[context][kEscapeMagnitude] + sign + static_cast<float>(2 * length + 1);
}

std::uint32_t ChooseMagnitude(std::size_t context, float wanted, float bitWorth) {
  const auto nearest = static_cast<std::uint32_t>(std::min(wanted + 0.5F, static_cast<float>(kMaxMagnitude)));
  if (nearest == 0) return 0;
  const auto price = [&](std::uint32_t magnitude) {
    const float error = wanted - static_cast<float>(magnitude);
    return error * error + bitWorth * FindCost(context, magnitude);
  };
  std::uint32_t best = nearest;
  float least = price(nearest);
  for (const std::uint32_t other : {nearest - 1, std::uint32_t{0}}) {
    const float each = price(other);
    if (each < least) best = other, least = each;
  }
  return best;
}

// Ones that want to be less than the first limit are made zeros first, then those below the second …
constexpr std::size_t kMostLimits = 16;
struct Limits {
  Limits() {
    for (float most = 0.6F; most < 1.3F; most += 0.05F) each[count++] = most;
  }
  std::array<float, kMostLimits> each{};
  std::size_t count = 0;
};
const Limits kLimits;

// Lists the ones that want to be less than the last limit, in order. Returns whether none of them wants to be less than
// a half.
bool ListOnes(const RoundingTask& task, std::span<const std::int32_t> chosen, std::vector<RoundedUp>& ones) {
  ones.resize(chosen.size());
  std::size_t count = 0;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    ones[count].at = static_cast<std::uint32_t>(k);
    count += chosen[k] == 1 || chosen[k] == -1 ? 1 : 0;
  }
  ones.resize(count);
  float least = 1;
  for (RoundedUp& one : ones) {
    one.wanted = std::fabs(FindWanted(task, one.at));
    least = std::min(least, one.wanted);
  }
  return least >= 0.5F;
}

// The number of limits that are not above it.
std::uint32_t FindLimit(float wanted) {
  const float guess = std::clamp((wanted - 0.55F) * 20.0F, 0.0F, static_cast<float>(kLimits.count));
  auto limit = static_cast<std::uint32_t>(guess);
  while (limit < kLimits.count && wanted >= kLimits.each[limit]) ++limit;
  while (limit > 0 && wanted < kLimits.each[limit - 1]) --limit;
  return limit;
}

double FindZeroCost(float wanted) { return 2 * double{wanted} - 1; }  // w² − (1 − w)²

// As SpendRest, in steps², one pass over all ones for each limit.
void SpendInPasses(std::span<const RoundedUp> ones, double steps, std::span<std::int32_t> chosen) {
  for (std::size_t i = 0; i < kLimits.count && steps > 2 * double{kLimits.each[i]} - 1.1; ++i) {
    for (const RoundedUp& one : ones) {
      if (one.wanted >= kLimits.each[i] || chosen[one.at] == 0) continue;
      const double cost = FindZeroCost(one.wanted);
      if (cost > steps) continue;
      steps -= cost;
      chosen[one.at] = 0;
    }
  }
}

}  // namespace

const Costs& FindCosts() { return kCosts; }

RoundingTask MakeRoundingTask(const PatchModel& model, const Choice& choice, std::span<const float> coefficients,
                              std::span<const std::int32_t> along, std::span<const ExpectedContext> expected) {
  const float step = FindStep(choice.StepLevel());
  RoundingTask task;
  task.coefficients = coefficients;
  task.expected = expected;
  task.step = step;
  task.perStep = 1.0F / step;
  task.contactScale = FindContactScale(model.size, step);
  task.bitWorth = choice.bitWorth;
  if (choice.head.mode.followsContact) task.along = along, task.gains = model.basis->gains;
  return task;
}

float FindWanted(const RoundingTask& task, std::size_t k) {
  const float wanted = task.coefficients[k] * task.perStep;
  if (task.along.empty()) return wanted;
  return wanted - static_cast<float>(FindSuggestion(task.along[k], task.gains[k], task.contactScale)) / 16.0F;
}

double RoundCoefficients(const RoundingTask& task, std::span<std::int32_t> chosen) {
  Contexts contexts;
  double sum = 0;
  for (std::size_t k = 0; k < task.coefficients.size(); ++k) {
    const float wanted = FindWanted(task, k);
    const std::size_t context = contexts.Find(task.expected[k]);
    const std::uint32_t magnitude = ChooseMagnitude(context, std::fabs(wanted), task.bitWorth);
    contexts.Add(magnitude);
    const float error = std::fabs(wanted) - static_cast<float>(magnitude);
    sum += double{error * error};
    chosen[k] = wanted < 0 ? -static_cast<std::int32_t>(magnitude) : static_cast<std::int32_t>(magnitude);
  }
  return sum * double{task.step} * double{task.step};
}

// Where nothing is gained by a zero, `left` only shrinks: who was passed over once is passed over always, so each limit
// needs to look only at those that the one before it did not let in.
void SpendRest(const RoundingTask& task, double left, std::span<std::int32_t> chosen, SpendScratch& scratch) {
  double steps = left / (double{task.step} * double{task.step});
  if (!(steps > 2 * double{kLimits.each[0]} - 1.1)) return;
  if (!ListOnes(task, chosen, scratch.ones)) return SpendInPasses(scratch.ones, steps, chosen);
  std::array<std::uint32_t, kMostLimits + 2> begins{};
  for (RoundedUp& one : scratch.ones) {
    one.limit = FindLimit(one.wanted);
    ++begins[one.limit + 1];
  }
  for (std::size_t i = 1; i < begins.size(); ++i) begins[i] += begins[i - 1];
  auto ends = begins;
  scratch.sorted.resize(scratch.ones.size());
  for (const RoundedUp& one : scratch.ones) scratch.sorted[ends[one.limit]++] = one;
  for (std::size_t i = 0; i < kLimits.count && steps > 2 * double{kLimits.each[i]} - 1.1; ++i) {
    for (std::size_t at = begins[i]; at < begins[i + 1]; ++at) {
      const double cost = FindZeroCost(scratch.sorted[at].wanted);
      if (cost > steps) continue;
      steps -= cost;
      chosen[scratch.sorted[at].at] = 0;
    }
  }
}

}  // namespace wobble::protocol
