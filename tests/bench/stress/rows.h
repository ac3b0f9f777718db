// What the parts `stress` and `stacks` report alike.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/bench/stress/bodies.h"

namespace wobble::bench {

// Adds the counts; keeps the larger number of substeps.
void Add(const StressOutcome& from, StressOutcome& sum);

// trials: how many `sum` is of.
[[nodiscard]] nlohmann::ordered_json MakeStressRow(const char* experiment, const char* what, const char* body,
                                                   double trials, const StressOutcome& sum);

}  // namespace wobble::bench
