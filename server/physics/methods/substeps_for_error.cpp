// Rises at once to what the largest error of the last ticks asks for; falls one rung at a time, and only after some
// ticks.
#include "server/physics/methods/substeps_for_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/physics/methods/stability.h"

namespace wobble::physics {
namespace {

// Share of the allowed error that is aimed at, since the next tick is a little different.
constexpr double kAim = 0.8;
// Ticks in a row for which a lower rung must suffice before the substeps go down by one: the error of a vibration comes
// and goes with it.
constexpr int kPatience = 2;

int FindSubstepsForCoefficient(double coefficient, double allowed) {
  return FindRung(std::sqrt(std::sqrt(coefficient / (kAim * allowed))));
}

double FindCoefficient(double error, int substeps) {
  const double square = double{1} * substeps * substeps;
  return error * square * square;
}

int FindRungBelow(int substeps) {
  const auto* rung = std::lower_bound(std::begin(kSubstepLadder), std::end(kSubstepLadder), substeps);
  return rung == std::begin(kSubstepLadder) ? *rung : *std::prev(rung);
}

}  // namespace

void StepHistory::Record(double error, int substeps, double allowed) {
  auto& [coefficients, next, lastError, chosen, ticksBelow] = m_memory;
  lastError = error;
  coefficients[next] = FindCoefficient(error, substeps);
  next = static_cast<std::uint8_t>((next + 1U) % kTicks);
  const int wanted = FindSubstepsForCoefficient(*std::max_element(coefficients.begin(), coefficients.end()), allowed);
  ticksBelow = wanted < chosen ? ticksBelow + 1 : 0;
  if (wanted > chosen) {
    chosen = wanted;
  } else if (ticksBelow >= kPatience) {
    chosen = FindRungBelow(chosen);
    ticksBelow = 0;
  }
}

int FindSubstepsForError(double error, int substeps, double allowed) {
  return FindSubstepsForCoefficient(FindCoefficient(error, substeps), allowed);
}

}  // namespace wobble::physics
