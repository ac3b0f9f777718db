#include "tests/bench/report.h"

#include <algorithm>
#include <string_view>

namespace wobble::bench {

void MeasureParts(Bench& bench, std::span<const Part> parts) {
  const auto isChosen = [&](const Part& part) {
    return std::string_view(part.name).find(bench.options.part) != std::string_view::npos;
  };
  if (std::ranges::none_of(parts, isChosen)) {
    std::string names;
    for (const Part& part : parts) names += (names.empty() ? "" : ", ") + std::string(part.name);
    throw UnknownPart("no part with '" + bench.options.part + "' in its name, there are: " + names);
  }
  for (const Part& part : parts) {
    if (bench.progress.IsStopAsked()) return;
    if (!isChosen(part)) continue;
    if (bench.options.trial && !part.hasTrials) continue;
    bench.progress.Begin(part.name, part.share);
    part.measure(bench);
  }
}

}  // namespace wobble::bench
