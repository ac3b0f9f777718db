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

// `count` boxes on a grid, in another order than they stand in.
std::vector<Box> MakeBoxes(std::size_t count) {
  std::vector<Box> boxes;
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t mixed = i * 7919 % count;  // bodies are not created in the order in which they stand
    const Vector3d middle(1.3 * static_cast<double>(mixed % side), 1.3 * static_cast<double>(mixed / side), 0.5);
    boxes.push_back({middle - Vector3d::Constant(0.55), middle + Vector3d::Constant(0.55)});
  }
  return boxes;
}

struct Search {
  std::vector<Box> boxes;
  BroadPhase broadPhase;
  Fastest time;

  // As many rounds for each size as take milliseconds, which the clock tells apart.
  [[nodiscard]] std::size_t CountRounds() const { return std::max<std::size_t>(1, 20000 / boxes.size()); }
  // Time per box, s.
  [[nodiscard]] double ReadTimePerBox() const {
    return time.Read() / static_cast<double>(CountRounds()) / static_cast<double>(boxes.size());
  }
};

// Returns how many pairs it found.
std::size_t TimeOnce(Search& search) {
  std::size_t pairs = 0;
  search.time.Time([&] {
    for (std::size_t round = 0; round < search.CountRounds(); ++round)
      pairs += search.broadPhase.FindOverlaps(search.boxes).size();
  });
  return pairs;
}

}  // namespace

void MeasureApart(Bench& bench) {
  std::vector<Search> searches;
  for (const std::size_t count : {100U, 300U, 1000U, 3000U, 10000U}) searches.push_back({MakeBoxes(count), {}, {}});
  // In turn: other load slows every size alike. One size after another, the growth came out as 1.5 to 3.3.
  std::size_t pairs = 0;
  for (int again = 0; again < kAgain; ++again)
    for (Search& search : searches) pairs += TimeOnce(search);
  for (const Search& search : searches) {
    bench.results.rows.push_back(
        {{"experiment", "apart"}, {"bodies", search.boxes.size()}, {"ns_per_body", search.ReadTimePerBox() * 1e9}});
  }
  const double few = searches.front().ReadTimePerBox();
  const double many = pairs == 0 ? searches.back().ReadTimePerBox() : std::numeric_limits<double>::quiet_NaN();
  bench.results.AddFigure("apart_ns_per_body", many * 1e9);
  bench.results.AddFigureAtMost("apart_growth", many / few, 3);
}

}  // namespace wobble::bench
