// Parts of `wobble_lab stability`: loads and shots that no body is made to bear.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys shots_through, stress_non_finite, stress_reset, stress_inverted_after_2s, stress_quarantined, fallen_through:
// one body of each kind, or a bag of 64.
void MeasureStress(Bench& bench);
// Keys stacks_fallen_through, stacks_non_finite, stacks_reset, stacks_inverted_after_2s: a hundred bodies on one
// another, of each kind but cloth.
void MeasureStressStacks(Bench& bench);
// The same keys with cloth_pile for stacks: a hundred cloths, which takes hours. Nothing in a quick run.
void MeasureClothPile(Bench& bench);

}  // namespace wobble::bench
