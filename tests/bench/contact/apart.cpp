// The cost of the search for contact pairs where nothing touches. Boxes of a body's size stand apart on a grid, as
// dense as a crowd; the time per box must not grow with their number. Sorting makes it grow by the logarithm, and
// caches slightly more.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/contact/broad_phase.h"
#include "tests/bench/contact/experiments.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr int kAgain = 60;  // the fastest counts: other programs can only slow it down

// Time per box among `count` boxes, s.
double TimeSearch(std::size_t count) {
  std::vector<Box> boxes;
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t mixed = i * 7919 % count;  // bodies are not created in the order in which they stand
    const Vector3d middle(1.3 * static_cast<double>(mixed % side), 1.3 * static_cast<double>(mixed / side), 0.5);
    boxes.push_back({middle - Vector3d::Constant(0.55), middle + Vector3d::Constant(0.55)});
  }
  BroadPhase broadPhase;
  std::size_t pairs = 0;
  double least = std::numeric_limits<double>::max();
  const int rounds = static_cast<int>(std::max<std::size_t>(1, 20000 / count));
  for (int again = 0; again < kAgain; ++again) {
    const double began = ReadThreadTime();
    for (int round = 0; round < rounds; ++round) pairs += broadPhase.FindOverlaps(boxes).size();
    least = std::min(least, (ReadThreadTime() - began) / rounds / static_cast<double>(count));
  }
  return pairs == 0 ? least : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void MeasureApart(Bench& bench) {
  double few = 0;
  double many = 0;
  for (const std::size_t count : {100U, 300U, 1000U, 3000U, 10000U}) {
    const double time = TimeSearch(count);
    if (count == 100) few = time;
    many = time;
    bench.results.rows.push_back({{"experiment", "apart"}, {"bodies", count}, {"ns_per_body", time * 1e9}});
  }
  bench.results.AddFigure("apart_ns_per_body", many * 1e9);
  bench.results.AddFigureAtMost("apart_growth", many / few, 3);
}

}  // namespace wobble::bench
