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
  const auto isPlayed = [&](const Part& part) { return isChosen(part) && (part.hasTrials || !bench.options.trial); };
  double shares = 0;
  for (const Part& part : parts) shares += isPlayed(part) ? part.share : 0;
  for (const Part& part : parts) {
    if (bench.progress.IsStopAsked()) return;
    if (!isPlayed(part)) continue;
    bench.progress.Begin(part.name, part.share / shares);
    part.measure(bench);
  }
}

}  // namespace wobble::bench
