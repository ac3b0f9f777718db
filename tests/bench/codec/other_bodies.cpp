// Our codec on other bodies: a hanging cloth of two patches, solids, and balls softer and firmer than those of the
// fixed play.
#include "tests/bench/codec/curve.h"
#include "tests/bench/codec/experiments.h"

namespace wobble::bench {
namespace {

constexpr double kTarget = 0.0025;

double MeasureBody(Bench& bench, const std::string& name, const Recording& recording) {
  const RatePoint point = MeasurePoint(recording, MakeOurs(), kTarget);
  bench.results.rows.push_back({{"experiment", "other_bodies"},
                                {"body", name},
                                {"vertices", recording.CountVertices()},
                                {"speed_median", FindMedian(recording.speeds)},
                                {"deformation_median", 100 * FindMedian(recording.deformations)},
                                {"bits_per_vertex", point.bitsPerVertex},
                                {"error_percent", point.errorPercent},
                                {"error_percent_p999", point.errorPercentP999}});
  return point.bitsPerVertex;
}

}  // namespace

void MeasureOtherBodies(Bench& bench) {
  const double seconds = bench.options.quick ? 5 : 30;
  const std::uint64_t seed = bench.options.seed;
  Results& results = bench.results;
  results.AddFigure("cloth_bits_per_vertex_025", MeasureBody(bench, "cloth", RecordCloth(seed, seconds)));
  results.AddFigure("lattice_bits_per_vertex_025",
                    MeasureBody(bench, "lattice", RecordLattices(Pattern::kChase, seed, seconds)));
  for (const double gas : {1500.0, 3000.0, 6000.0}) {
    (void)MeasureBody(bench, FormatLine("ball, gas %g J", gas), RecordBalls(Pattern::kChase, seed, seconds, gas));
  }
}

}  // namespace wobble::bench
