// Rate-distortion optimised rounding of one record's coefficients.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/contexts.h"
#include "protocol/codec/encoding/step_search.h"

namespace wobble::protocol {

// What each magnitude without its low bits costs in each context, in bits, low bits included and the sign not.
using Costs = std::array<std::array<float, kMagnitudes>, kContexts>;
[[nodiscard]] const Costs& FindCosts();

struct RoundingTask {
  std::span<const float> coefficients;        // m
  std::span<const std::int32_t> along;        // of ContactScratch; empty when the record does not follow contact
  std::span<const std::int8_t> gains;         // of the basis
  std::span<const ExpectedContext> expected;  // at the step
  float step = 1, perStep = 1;                // m; 1 / step
  float contactScale = 1;                     // FindContactScale at the step
  float bitWorth = 0;                         // squared steps of error that a bit is worth
};

// along: read when the choice follows contact. expected: at its step.
[[nodiscard]] RoundingTask MakeRoundingTask(const PatchModel& model, const Choice& choice,
                                            std::span<const float> coefficients, std::span<const std::int32_t> along,
                                            std::span<const ExpectedContext> expected);

// The coefficient that is rounded, in steps, less the contact prediction.
[[nodiscard]] float FindWanted(const RoundingTask& task, std::size_t k);

// Chooses all coefficients, in steps. Returns the sum of squared errors, m².
[[nodiscard]] double RoundCoefficients(const RoundingTask& task, std::span<std::int32_t> chosen);

// A coefficient of magnitude 1 that could be 0.
struct RoundedUp {
  std::uint32_t at = 0;
  float wanted = 0;  // its magnitude before the rounding, in steps
  std::uint32_t limit = 0;
};

struct SpendScratch {
  std::vector<RoundedUp> ones;
  std::vector<RoundedUp> sorted;
};

// Makes zeros of ones while the error that is left, m², allows it; those that cost the least error go first. chosen: as
// RoundCoefficients chose them for this task.
void SpendRest(const RoundingTask& task, double left, std::span<std::int32_t> chosen, SpendScratch& scratch);

}  // namespace wobble::protocol
